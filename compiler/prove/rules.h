// SPDX-License-Identifier: Apache-2.0
// The range rules of functions.def: what is known of a function's result without looking into its body.
#pragma once

#include <span>
#include <string_view>

#include "compiler/prove/bound.h"
#include "compiler/functions/tier.h"

namespace isoshade::prove {

/// The error of a row.
struct Accuracy {
  double error;   ///< relative to its result
  bool promised;  ///< the arguments lie within the domain that functions.def states
};

struct Rule {
  std::string_view row;
  /// The bound of one component of the result. Where the row works componentwise, `arguments` are those of the
  /// component, else all words of all arguments.
  Outcome (*bound)(std::span<const Bound> arguments, uint32_t component, const Accuracy& accuracy);
};

/// The same, with the error of the row's body in a tier. Arguments for which a fast body promises nothing are a breach.
Outcome bound_of(const Rule& rule, std::span<const Bound> arguments, uint32_t component,
                 functions::Tier tier);

/// Null if the function's body is followed instead.
const Rule* find_rule(std::string_view row);

/// Whether a row works on vectors component by component.
bool is_componentwise(std::string_view row);

}  // namespace isoshade::prove
