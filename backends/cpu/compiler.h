// SPDX-License-Identifier: Apache-2.0
// The C++ compiler of the machine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/cpu/lane_count.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::cpu {

class Compiler {
 public:
  /// `wanted` is a path or a name on PATH; empty: $ISOSHADE_CXX, else the first of c++, g++ and clang++ on
  /// PATH. Reports if there is none.
  static std::optional<Compiler> find(const std::string& wanted, support::Diagnostics& diagnostics);

  const std::string& path() const { return path_; }
  /// As it says itself: "g++ (Debian 12.2.0-14) 12.2.0".
  std::string version() const { return version_.substr(0, version_.find('\n')); }
  /// Changes when another compiler stands at the path.
  const std::string& identity() const { return identity_; }

  /// The options that every shared object is compiled with.
  std::vector<std::string> flags(const LaneCount& lanes) const;

  /// Compiles program.cpp to program.so, both in `folder`, where the headers are too.
  bool compile(const std::string& folder, const LaneCount& lanes, support::Diagnostics& diagnostics) const;

 private:
  std::string path_;
  std::string version_;  ///< all that it says
  std::string identity_;
};

}  // namespace isoshade::cpu
