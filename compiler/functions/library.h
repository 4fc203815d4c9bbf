// SPDX-License-Identifier: Apache-2.0
// The function library as IR: what variants there are, declaring them in a module, giving them their bodies.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/ir/builder.h"

namespace isoshade::functions {

/// How far a result may be off.
struct Accuracy {
  double ulp = 0;
  std::string_view unit = "result";  ///< what the ulps are of, as the tables have it
};

/// One row of functions.def at one set of argument types.
struct Variant {
  std::string_view row;  ///< "dot"
  std::string name;      ///< unique: "dot_v3", "mix_v3v3f"; on floats the row's own
  std::vector<ir::Type> parameters;
  std::vector<ir::Type> results;
  using Build = void (*)(ir::Builder&);
  std::array<Build, tiers.size()> bodies{};     ///< by tier: what makes the body
  std::array<Accuracy, tiers.size()> accuracy;  ///< by tier

  Build body(Tier tier) const { return bodies[static_cast<size_t>(tier)]; }
  /// Whether the tier has a body for this that is not the default one. Without one its calls may still differ.
  bool has_own_body(Tier tier) const { return body(tier) != body(Tier::standard); }
};

const std::vector<Variant>& variants();
/// The row's variant for these argument types, or null.
const Variant* find(std::string_view row, std::span<const ir::Type> arguments);

/// The index of the variant's declaration in the module, added if it is not there.
uint32_t declare(ir::Module& module, const Variant& variant);

/// Declares and calls; a row or argument types that do not exist are a bug.
std::vector<ir::ValueId> call_library(ir::Builder& builder, std::string_view row,
                                      std::span<const ir::ValueId> arguments);

/// The variant that a declaration stands for.
const Variant& variant_of(const ir::Function& declaration);

/// Gives every declaration in the module its body of the tier, and those that the bodies call.
/// Leaves: no declaration in the module.
void expand(ir::Module& module, Tier tier = Tier::standard);

}  // namespace isoshade::functions
