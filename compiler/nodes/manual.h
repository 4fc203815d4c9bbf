// SPDX-License-Identifier: Apache-2.0
// The node table for readers.
#pragma once

#include <span>
#include <string>

#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// "float, vector2 or color3"; types of one variable agree and say so: "float or vector3 (T)".
std::string type_text(const PortType& type);
/// "0.5", "true", "[0.2126, 0.7152, 0.0722]", "\"world\"", "the surface's normal"; empty if it must be given.
std::string default_text(const Port& port);

/// Every node, and every function of the library, with the first sentence about it, by group.
std::string table_text(std::span<const Row> library);
/// What a row does, its ports and outputs.
std::string row_text(const Row& row);
/// The same of the nodes that hold a formula, which are no rows.
std::string expression_text();

/// The tables of graphs/README.md, one a group: node, ports with defaults, what it does; then the functions of the
/// library; and one of all nodes and functions of expressions, of what they take and give beyond it.
std::string table_markdown(std::span<const Row> library);

}  // namespace isoshade::nodes
