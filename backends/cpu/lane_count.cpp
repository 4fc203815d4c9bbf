// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/lane_count.h"

#include <algorithm>

namespace isoshade::cpu {
namespace {

// Ordered by speed; "1", which is for tests, comes first.
constexpr LaneCount all[] = {{"1", 1, 1},   {"4", 4, 1},   {"8", 8, 1},
                             {"8x2", 8, 2}, {"16", 16, 1}, {"16x2", 16, 2}};

}  // namespace

bool LaneCount::available() const {
  if (lanes == 16)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  return lanes < 8 || __builtin_cpu_supports("avx2");
}

std::vector<std::string_view> LaneCount::flags() const {
  if (lanes == 16) return {"-mavx512f", "-mavx512vl", "-mavx512dq", "-mavx512bw"};
  if (lanes == 8) return {"-mavx2"};
  if (__builtin_cpu_supports("sse4.1")) return {"-msse4.1"};
  return {};
}

std::span<const LaneCount> lane_counts() { return all; }

std::optional<LaneCount> lane_count(std::string_view name) {
  const auto found =
      std::find_if(std::begin(all), std::end(all), [&](const LaneCount& l) { return l.name == name; });
  if (found == std::end(all)) return std::nullopt;
  return *found;
}

LaneCount widest_lane_count() {
  return *std::find_if(std::rbegin(all), std::rend(all), [](const LaneCount& l) { return l.available(); });
}

}  // namespace isoshade::cpu
