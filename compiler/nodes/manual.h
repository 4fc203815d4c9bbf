// SPDX-License-Identifier: Apache-2.0
// The node table as text.
#pragma once

#include <span>
#include <string>

#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// "float, vector2 or color3"; types that must agree carry a variable: "float or vector3 (T)".
std::string type_text(const PortType& type);
/// "0.5", "true", "[0.2126, 0.7152, 0.0722]", "\"world\"", "the surface's normal"; empty if the port is required.
std::string default_text(const Port& port);

/// Every node and every function of the library with the first sentence of its documentation, by group; functions with
/// their ports.
std::string table_text(std::span<const Row> library);
/// The documentation of a row, its ports and outputs.
std::string row_text(const Row& row);
/// The same for expression nodes, which have no row.
std::string expression_text();

/// The tables of graphs/README.md, one per group: node, ports with defaults, documentation; then the functions of the
/// library; then the domains of nodes and functions, and their results outside of these.
std::string table_markdown(std::span<const Row> library);

}  // namespace isoshade::nodes
