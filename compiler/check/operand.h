// SPDX-License-Identifier: Apache-2.0
// Fills in operands: selects what a link refers to, and stores literals.
#pragma once

#include "compiler/check/work.h"

namespace isoshade::check {

/// Sets the output, swizzle and type of a resolved operand from the selectors of its link. Returns false if it has no
/// type; the error is already reported.
bool select(Work& work, const graph::Link& link, Operand& operand);

/// Whether a value of type `from` converts implicitly to `to`: a float fills vectors and colours, and an integer
/// converts to float. Other conversions need a convert node.
bool converts(Type from, Type to);

/// Whether a literal can be a value of `type`: a number also fits every vector and colour type.
bool fits(const graph::Literal& literal, Type type);
/// Makes `operand` a literal of `type`; a number fills every component of a vector or colour.
void place(TypedGraph& typed, const graph::Literal& literal, Type type, Operand& operand);
/// The same for the default of a port; a surface attribute becomes a read of it.
void place(TypedGraph& typed, const nodes::Default& value, Type type, Operand& operand);
void place_file(TypedGraph& typed, File file, Operand& operand);

/// "float, vector2 or color3"
std::string described(nodes::TypeSet types);
/// "a string", "an array of 3 numbers"
std::string described(const graph::Literal& literal);

}  // namespace isoshade::check
