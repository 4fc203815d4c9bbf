// SPDX-License-Identifier: Apache-2.0
// The node library.
#pragma once

#include "compiler/functions/tier.h"
#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// All nodes, by group, in the order of the manual.
const std::vector<Row>& table();

/// The row with this name, or null.
const Row* find(std::string_view name);

/// The domain of a row in a tier and its results outside of it, from domains.def or the docstring of the function.
/// Empty for nodes without value ports.
std::string_view domain_of(const Row& row, functions::Tier tier = functions::Tier::standard);

/// The operators (named by their text) and functions of expressions: rows of functions.def, abs, floor and sqrt. Sorted
/// by name.
const std::vector<Row>& function_table();
const Row* find_function(std::string_view name);

/// The row of `rows` (nodes or expression functions) that corresponds to `word`, a name from the other table or from
/// another shading language; empty if there is none.
std::string_view find_synonym(std::string_view word, const std::vector<Row>& rows);

// The groups, one source file each.
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
