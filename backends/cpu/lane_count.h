// SPDX-License-Identifier: Apache-2.0
// How many lanes generated code computes at once, and the compiler options for it.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::cpu {

struct LaneCount {
  std::string_view name;  ///< "8x2": two registers of eight lanes
  int lanes;              ///< in a register
  int registers;          ///< in a value

  /// Whether this machine has registers of this size.
  bool available() const;
  /// The compiler options for the instruction set.
  std::vector<std::string_view> flags() const;
};

/// 1 4 8 16 8x2 16x2
std::span<const LaneCount> lane_counts();
std::optional<LaneCount> lane_count(std::string_view name);
/// The fastest one on this machine.
LaneCount widest_lane_count();

}  // namespace isoshade::cpu
