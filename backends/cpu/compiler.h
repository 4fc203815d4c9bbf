// SPDX-License-Identifier: Apache-2.0
// The C++ compiler of the machine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/cpu/lane_count.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/process.h"

namespace isoshade::cpu {

class Compiler {
 public:
  /// `wanted` is a path or a name on PATH; empty: $ISOSHADE_CXX, else the first of c++, g++ and clang++ on
  /// PATH. Reports if there is none. `limit` is how long one program may take to compile.
  static std::optional<Compiler> find(const std::string& wanted, support::Diagnostics& diagnostics,
                                      support::Seconds limit = support::default_time_limit);

  const std::string& path() const { return path_; }
  /// As it says itself: "g++ (Debian 12.2.0-14) 12.2.0".
  std::string version() const { return version_.substr(0, version_.find('\n')); }
  /// Changes when another compiler stands at the path.
  const std::string& identity() const { return identity_; }

  /// The options that every shared object is compiled with.
  std::vector<std::string> flags(const LaneCount& lanes) const;

  /// Compiles program.cpp to program.so, both in `folder`, where the headers are too. Messages say `what` it is: "the
  /// pixel program of \"a.json\"".
  bool compile(const std::string& folder, const std::string& what, const LaneCount& lanes,
               support::Diagnostics& diagnostics) const;

 private:
  std::string path_;
  std::string version_;  ///< all that it says
  std::string identity_;
  support::Seconds limit_{};
};

}  // namespace isoshade::cpu
