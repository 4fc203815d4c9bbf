// SPDX-License-Identifier: Apache-2.0
// Programs that measure computation apart from reading and writing: they make their inputs in registers, evaluate the
// subject many times for each row of a table, and fold the results into one word.
#pragma once

#include <optional>
#include <vector>

#include "runtime/bench/subject.h"

namespace isoshade::bench {

/// How often the subject is evaluated for a row. A row reads one word, its number, and writes one.
inline constexpr int evaluations = 64;

/// Evaluates the subject. A row makes inputs from its number by a hash; each evaluation changes them by an operation a
/// component: scalars and components of general vectors are scaled within their range, unit vectors are mirrored.
/// `function`: the index of the subject's function in the module, which is not yet optimised.
driver::Program compute_program(const Subject& subject, const std::vector<driver::Field>& inputs, ir::Module module,
                                uint32_t function, functions::Tier tier);

/// Makes the same inputs and folds them: the part of the above that is not the subject.
driver::Program making_program(const Subject& subject, const std::vector<driver::Field>& inputs);

}  // namespace isoshade::bench
