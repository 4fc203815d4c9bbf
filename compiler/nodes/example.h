// SPDX-License-Identifier: Apache-2.0
// Generated documents that use rows of the node table, for tests, measurements and the manual.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compiler/nodes/table.h"

namespace isoshade::nodes {

/// A row with one choice of types for its type variables.
struct Example {
  const Row* row = nullptr;
  Type t = Type::floating;
  Type u = Type::floating;

  Type type_of(PortType type) const;
  /// Whether the row's condition accepts these types.
  bool accepted() const;
};

/// The types of a set, in declaration order.
std::vector<Type> types_in(TypeSet set);

/// A row with all combinations of types that it accepts.
std::vector<Example> examples_of(const Row& row);

/// A function document with one node per example, "n0", "n1", ... The k-th value port of a type reads the input named
/// after type and k: "float_0", "vector3_1". Outputs have the names of the nodes, or "n0_outx" for nodes with several
/// outputs. The rows must be available in function documents.
std::string function_document(std::span<const Example> examples);

}  // namespace isoshade::nodes
