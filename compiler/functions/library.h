// SPDX-License-Identifier: Apache-2.0
// The function library as IR: its variants, their declarations in a module, their bodies and derivatives.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/ir/builder.h"

namespace isoshade::functions {

/// The maximum error of a result.
struct Accuracy {
  double ulp = 0;
  std::string_view unit = "result";  ///< the column `unit` of functions.def
};

/// One row of functions.def for one list of argument types.
struct Variant {
  std::string_view row;  ///< "dot"
  std::string name;      ///< unique: "dot_v3", "mix_v3v3f"; for floats the name of the row
  std::vector<ir::Type> parameters;
  std::vector<ir::Type> results;
  using Build = void (*)(ir::Builder&);
  std::array<Build, tiers.size()> bodies{};     ///< by tier: builds the body
  std::array<Accuracy, tiers.size()> accuracy;  ///< by tier

  Build body(Tier tier) const { return bodies[static_cast<size_t>(tier)]; }
  /// Whether the tier has a body other than the default one. Even without one, the functions that it calls may differ.
  bool has_own_body(Tier tier) const { return body(tier) != body(Tier::standard); }
};

const std::vector<Variant>& variants();
/// The row's variant for these argument types, or null.
const Variant* find(std::string_view row, std::span<const ir::Type> arguments);

/// The index of the variant's declaration in the module, which is added if missing.
uint32_t declare(ir::Module& module, const Variant& variant);

/// Declares the function if necessary and calls it; aborts if there is no such row or variant.
std::vector<ir::ValueId> call_library(ir::Builder& builder, std::string_view row,
                                      std::span<const ir::ValueId> arguments);

/// The variant of a declaration.
const Variant& variant_of(const ir::Function& declaration);

/// Gives every declaration in the module, and those that the bodies add, its body in the tier.
/// Leaves: no declaration in the module.
void expand(ir::Module& module, Tier tier = Tier::standard);

/// Builds the change of a result when one argument changes by `change`.
using Contribution = ir::ValueId (*)(ir::Builder&, std::span<const ir::ValueId> arguments, ir::ValueId change);

/// By argument; null if the derivative with respect to it is 0.
using DerivativeRule = std::array<Contribution, 2>;

/// The rule of a variant from the DERIVATIVE and FLAT rows of functions.def (the variant then has one result), or null:
/// differentiate its body.
const DerivativeRule* find_derivative(const Variant& variant);

/// The text after "Domain:" in the docstring of a row's body in a tier, or of its default body if the tier has none;
/// empty if there is no such row.
std::string_view domain_of(std::string_view row, Tier tier = Tier::standard);

}  // namespace isoshade::functions
