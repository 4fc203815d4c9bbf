// SPDX-License-Identifier: Apache-2.0
// THE node library.
#pragma once

#include "compiler/functions/tier.h"
#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// Every node, group by group, in the order that the manual lists them.
const std::vector<Row>& table();

/// The row of a name, or null.
const Row* find(std::string_view name);

/// What a row takes, and what it gives beyond it, in a tier: domains.def, or the docstring of the function that it is.
/// Empty for nodes that take no values.
std::string_view domain_of(const Row& row, functions::Tier tier = functions::Tier::standard);

/// What stands in expressions: operators by their text, the rows of functions.def, abs, floor and sqrt; sorted
/// by name.
const std::vector<Row>& function_table();
const Row* find_function(std::string_view name);

/// What `word`, a name in other shading languages or on the other side (nodes, expressions), is called in `rows`; empty
/// if nothing is known of it.
std::string_view called_elsewhere(std::string_view word, const std::vector<Row>& rows);

// The groups, one file each.
std::vector<Row> structure_rows();
std::vector<Row> math_rows();
std::vector<Row> vector_rows();
std::vector<Row> logic_rows();
std::vector<Row> color_rows();
std::vector<Row> procedural_rows();
std::vector<Row> texture_rows();
std::vector<Row> geometry_rows();
std::vector<Row> light_rows();
std::vector<Row> screen_rows();

}  // namespace isoshade::nodes
