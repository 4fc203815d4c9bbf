// SPDX-License-Identifier: Apache-2.0
// The inputs of a document as parameters of functions: their names, their ranges, and what they are bound to.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/interface/binding.h"

namespace isoshade::lower {

/// The names of values that stand side by side: of each its own, or one a column of a matrix, "m_0", "m_1". No two are
/// equal: a column's name gives way to a value of that name.
std::vector<std::vector<std::string>> names_of_columns(const std::vector<std::pair<std::string, graph::Type>>& values);

/// One binding of an input, or one for each column of a matrix.
std::vector<interface::Binding> bind_input(const check::TypedGraph& graph, uint32_t index,
                                           const std::vector<std::string>& columns, const std::string& group,
                                           bool is_parameter);

}  // namespace isoshade::lower
