// SPDX-License-Identifier: Apache-2.0
// How fast the processor's execution ports let the hot loop of a compiled program be, by llvm-mca.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "backends/cpu/compiler.h"
#include "compiler/support/temporary.h"

namespace isoshade::bench {

/// Cycles for one evaluation in the innermost loop of a compute program.
struct PortBound {
  double cycles = 0;     ///< by the busiest port, or by how many operations start in a cycle
  double simulated = 0;  ///< with what instructions wait for each other and the sizes of the queues, too
  std::string resource;  ///< what is busiest: "Zn3FPP1"; "dispatch"
  double spills = 0;     ///< accesses to the stack
};

/// Compiles texts to assembly and asks llvm-mca. A branch in the loop counts with both of its sides.
class PortAnalyser {
 public:
  /// Null if there is no llvm-mca (Debian: package llvm) or no compiler.
  static std::unique_ptr<PortAnalyser> find(const std::string& compiler, support::Seconds limit);

  /// Nothing if a tool fails, or the text has no loop.
  std::optional<PortBound> analyse(const std::string& cpp, const cpu::LaneCount& lanes) const;

 private:
  PortAnalyser(std::string mca, cpu::Compiler compiler, support::TemporaryFolder folder, support::Seconds limit)
      : mca_(std::move(mca)), compiler_(std::move(compiler)), folder_(std::move(folder)), limit_(limit) {}

  std::string mca_;
  cpu::Compiler compiler_;
  support::TemporaryFolder folder_;
  support::Seconds limit_;
};

/// Writes the headers of runtime/lanes where `-I folder` finds them. `free_compiler`: without the pragma that repeats the
/// flags of the contract, for code outside of it.
bool write_lanes_headers(const std::string& folder, bool free_compiler);

/// Cycles a nanosecond, from a chain of multiplications that takes three cycles each on the x86-64 processors of the last
/// ten years; 0 on other processors.
double clock_frequency();

}  // namespace isoshade::bench
