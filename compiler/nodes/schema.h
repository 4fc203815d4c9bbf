// SPDX-License-Identifier: Apache-2.0
// The JSON Schema (draft-07) of all documents: editors complete and check by it.
#pragma once

#include <span>
#include <string>

#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// The nodes come from the table and from `library`, the functions that documents use by name; the rest says what the readers of graph/ and of scenes accept. What they
/// refuse beyond it (links to nothing, types that do not fit) no schema can tell.
std::string json_schema(std::span<const Row> library);

}  // namespace isoshade::nodes
