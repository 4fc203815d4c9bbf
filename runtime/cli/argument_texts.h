// SPDX-License-Identifier: Apache-2.0
// Values that options of the command line write as text.
#pragma once

#include <optional>
#include <string>

#include "runtime/cli/arguments.h"

namespace isoshade::cli {

/// "640x360", each side from 1 to 8192.
std::optional<Size> parse_size(const std::string& text);
/// "NAME=MIN:MAX"
std::optional<NamedRange> parse_range(const std::string& text);
/// "NAME=FROM:TO:COUNT", numbers or lists of as many numbers with commas; or "NAME=VALUE;VALUE;...".
std::optional<VariedParameter> parse_varied(const std::string& text);

/// "0:2:48" or "48", at most 999,999 frames.
std::optional<FrameTimes> parse_frames(const std::string& text);

/// A name of files with one field for a number: "frame_%04d.png". "%%" stands for a percent sign.
class NumberedPath {
 public:
  /// Nothing if the text has no field, or more than one, or another one than %d, %4d or %04d.
  static std::optional<NumberedPath> parse(const std::string& text);
  std::string of(int number) const;

 private:
  std::string before_, after_;
  size_t width_ = 0;
  char fill_ = ' ';
};

}  // namespace isoshade::cli
