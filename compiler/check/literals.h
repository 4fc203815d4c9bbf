// SPDX-License-Identifier: Apache-2.0
// Values written in the document, as words of the type that is needed.
#pragma once

#include "compiler/check/typed_graph.h"

namespace isoshade::check {

/// Whether a value of `from` is taken where `to` is needed: a float fills vectors and colours, an integer is
/// a float. All else asks for a convert node.
bool converts(Type from, Type to);

/// Whether a literal can be a value of the type, and where `operand` is given, makes it one: a number fills
/// every component of a vector or colour, and is an integer where it is whole.
bool fits(const graph::Literal& literal, Type type);
void place(TypedGraph& typed, const graph::Literal& literal, Type type, Operand& operand);
/// A literal that is a path.
void place_file(TypedGraph& typed, File file, Operand& operand);
/// The same as place() for the default of a row. Attributes of the surface are read instead.
void place(TypedGraph& typed, const nodes::Default& value, Type type, Operand& operand);

/// "a string", "an array of 3 numbers"
std::string described(const graph::Literal& literal);

}  // namespace isoshade::check
