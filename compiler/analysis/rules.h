// SPDX-License-Identifier: Apache-2.0
// The rules of ranges.def: what is known of a function's result without looking into its body.
#pragma once

#include <span>
#include <string_view>

#include "compiler/analysis/bound.h"

namespace isoshade::analysis {

struct Rule {
  std::string_view row;
  /// The bound of one component of the result. Where the row works componentwise, `arguments` are those of the
  /// component, else all words of all arguments.
  Outcome (*bound)(std::span<const Bound> arguments, uint32_t component);
};

/// Null where the body tells all that there is to know.
const Rule* find_rule(std::string_view row);

/// Whether a row's vectors are worked on component by component.
bool is_componentwise(std::string_view row);

/// The error of a row that functions.def states, in units in the last place.
double ulp_of(std::string_view row);

}  // namespace isoshade::analysis
