// SPDX-License-Identifier: Apache-2.0
// The dots of a link, once the type of what it names is known.
#pragma once

#include "compiler/check/work.h"

namespace isoshade::check {

/// Settles the output, the swizzle and the type of an operand that `resolve` found. False if it has none:
/// then that was reported, here or where it is defined.
bool select(Work& work, const graph::Link& link, Operand& operand);

/// "float, vector2 or color3"
std::string described(nodes::TypeSet types);

}  // namespace isoshade::check
