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

}  // namespace isoshade::cli
