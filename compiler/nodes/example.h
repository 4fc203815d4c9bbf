// SPDX-License-Identifier: Apache-2.0
// Documents that use the node table: what is tested, measured and told of a row is done by them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compiler/nodes/table.h"

namespace isoshade::nodes {

/// A row at one choice of types for its variables.
struct Example {
  const Row* row = nullptr;
  Type t = Type::floating;
  Type u = Type::floating;

  Type type_of(PortType type) const;
  /// Whether the row's condition accepts these types.
  bool accepted() const;
};

/// The types of a set, in the order of their declaration.
std::vector<Type> types_in(TypeSet set);

/// A row at all types that its ports accept.
std::vector<Example> examples_of(const Row& row);

/// A function document with a node for each example, "n0", "n1", ... The k-th value port of a type reads the
/// input of that type and number: "float_0", "vector3_1". Outputs are called as the nodes, or "n0_outx" where
/// there are several. The rows must not belong to effects.
std::string function_document(std::span<const Example> examples);

}  // namespace isoshade::nodes
