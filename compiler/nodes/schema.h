// SPDX-License-Identifier: Apache-2.0
// The JSON Schema (draft-07) of all documents: editors complete and check by it.
#pragma once

#include <string>

namespace isoshade::nodes {

/// The nodes come from the table; the rest says what the readers of graph/ and of scenes accept. What they
/// refuse beyond it (links to nothing, types that do not fit) no schema can tell.
std::string json_schema();

}  // namespace isoshade::nodes
