// SPDX-License-Identifier: Apache-2.0
// The range rules of functions.def: what is known of a function's result without looking into its body.
#pragma once

#include <span>
#include <string_view>

#include "compiler/prove/bound.h"
#include "compiler/functions/tier.h"

namespace isoshade::prove {

/// What a row errs by.
struct Accuracy {
  double error;   ///< relative to its result
  bool promised;  ///< the arguments lie within the domain that its table states
};

struct Rule {
  std::string_view row;
  /// The bound of one component of the result. Where the row works componentwise, `arguments` are those of the
  /// component, else all words of all arguments.
  Outcome (*bound)(std::span<const Bound> arguments, uint32_t component, const Accuracy& accuracy);
};

/// The same, with what the tables say of the row's body in a tier. Where a fast body promises nothing, it is a breach.
Outcome bound_of(const Rule& rule, std::span<const Bound> arguments, uint32_t component,
                 functions::Tier tier);

/// Null where the body tells all that there is to know.
const Rule* find_rule(std::string_view row);

/// Whether a row's vectors are worked on component by component.
bool is_componentwise(std::string_view row);

}  // namespace isoshade::prove
