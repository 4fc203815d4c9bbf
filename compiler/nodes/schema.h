// SPDX-License-Identifier: Apache-2.0
// The JSON Schema (draft-07) of all documents, with which editors complete and check them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// The schema of a kind of document that another folder reads.
struct DocumentSchema {
  std::string_view kind;  ///< the key that tells the kind
  std::string_view doc;
  std::string definitions;  ///< a JSON object: that of the kind, under its name, and those that it refers to
};

/// The schemas of nodes come from the table and from `library`, the functions that documents use by name; the rest
/// describes what the readers in graph/ accept. What no schema can express (a link must have a target, types must
/// fit) is checked by the readers alone.
std::string json_schema(std::span<const Row> library, const DocumentSchema& scene);

}  // namespace isoshade::nodes
