// SPDX-License-Identifier: Apache-2.0
// The C++ compiler of the machine, and the headers that it needs for generated code.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/cpu/lane_count.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/process.h"

namespace isoshade::cpu {

class Compiler {
 public:
  /// `wanted`: a path or a name on PATH; empty: $ISOSHADE_CXX, or the first of c++, g++ and clang++ on PATH. Reports an
  /// error if there is none. `limit`: the time that one program may take to compile.
  static std::optional<Compiler> find(const std::string& wanted, support::Diagnostics& diagnostics,
                                      support::Seconds limit = support::default_time_limit);

  const std::string& path() const { return path_; }
  /// Its own description: "g++ (Debian 12.2.0-14) 12.2.0".
  std::string version() const { return version_.substr(0, version_.find('\n')); }
  /// Changes when another compiler is installed at the path.
  const std::string& identity() const { return identity_; }

  /// The time that a program may take.
  support::Seconds limit() const { return limit_; }

  /// The options that every shared object is compiled with.
  std::vector<std::string> flags(const LaneCount& lanes) const;

  /// Compiles program.cpp to program.so, both in `folder`, which also holds the headers. `what` names the program in
  /// messages: "the pixel program of \"a.json\"".
  bool compile(const std::string& folder, const std::string& what, const LaneCount& lanes,
               support::Diagnostics& diagnostics) const;
  /// A shell script that compiles program.cpp to made.so, both in the working directory, which also holds the headers.
  std::string script(const LaneCount& lanes) const;
  /// Reports that the compiler did not compile `what`. `how`: " failed with status 1"; `words`: what it said.
  void report_failure(const std::string& what, const std::string& how, const std::string& words,
                      support::Diagnostics& diagnostics) const;

 private:
  std::string path_;
  std::string version_;  ///< the whole output of --version
  std::string identity_;
  support::Seconds limit_{};
};

/// A header of runtime/lanes. They are embedded in the program, so that an installed isoshade needs no source tree.
struct Header {
  std::string_view path;  ///< as generated code includes it: "isoshade/lanes/lanes.h"
  std::string_view text;
};
std::span<const Header> lanes_headers();

/// Writes what a compiler needs to a folder: program.cpp and the headers.
bool write_sources(const std::string& folder, const std::string& text, support::Diagnostics& diagnostics);

}  // namespace isoshade::cpu
