// SPDX-License-Identifier: Apache-2.0
// Documents that change another one: "extends".
#pragma once

#include <optional>

#include "compiler/graph/document.h"
#include "compiler/graph/files.h"

namespace isoshade::graph {

/// The key whose value is the path of the document that this one changes, relative to this one. For effects and scenes.
inline constexpr std::string_view extends_key = "extends";

/// How many documents may extend each other, the first and the last included.
inline constexpr size_t max_chain = 16;

/// Parses a document. An effect or a scene that extends another one is merged into it (merge), and that into the one
/// that it extends. Reports a base of another kind, a cycle, and a chain that is too long.
std::optional<Document> load_document(const support::Source& source, const FileRule& files,
                                      support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
