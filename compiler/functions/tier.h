// SPDX-License-Identifier: Apache-2.0
// The accuracy tier, which selects function bodies. In every tier, all backends compute the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace isoshade::functions {

enum class Tier : uint8_t {
  fast,      ///< fewer operations, larger errors, narrower domains
  standard,  ///< "default": the bodies of functions.def
  precise,   ///< errors near half a unit in the last place
};

inline constexpr std::array tiers{Tier::fast, Tier::standard, Tier::precise};

/// Its name on the command line and in recorded hashes: "fast", "default", "precise".
constexpr std::string_view tier_name(Tier tier) {
  constexpr std::array<std::string_view, tiers.size()> names{"fast", "default", "precise"};
  return names[static_cast<size_t>(tier)];
}

constexpr std::optional<Tier> find_tier(std::string_view name) {
  for (const Tier tier : tiers)
    if (tier_name(tier) == name) return tier;
  return std::nullopt;
}

}  // namespace isoshade::functions
