// SPDX-License-Identifier: Apache-2.0
// How many lanes generated code computes at once, and what a compiler has to be told about it.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::cpu {

struct LaneCount {
  std::string_view name;  ///< "8x2": two registers of eight lanes
  int lanes;              ///< of a register
  int registers;          ///< of a value

  /// Whether this machine has such registers.
  bool available() const;
  /// The compiler options for the instruction set.
  std::vector<std::string_view> flags() const;
};

/// 1 4 8 16 8x2 16x2
std::span<const LaneCount> lane_counts();
std::optional<LaneCount> lane_count(std::string_view name);
/// The fastest that this machine has.
LaneCount widest_lane_count();

}  // namespace isoshade::cpu
