// SPDX-License-Identifier: Apache-2.0
// The canonical layout of documents.
#pragma once

#include <string>

#include "compiler/graph/document.h"

namespace isoshade::graph {

/// The document in canonical layout: two blanks an indent, a value on one line where it fits into 120 columns,
/// else one member a line; of the root's members those that hold objects are always so. Keys stay in their
/// order, strings and numbers as they are written, and one blank line where there were some between members.
/// Formatting twice changes nothing more.
std::string format(const Document& document);

}  // namespace isoshade::graph
