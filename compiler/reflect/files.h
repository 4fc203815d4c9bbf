// SPDX-License-Identifier: Apache-2.0
// The files that the result of compiling a document depends on.
#pragma once

#include <string>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/graph/files.h"
#include "compiler/reflect/reflection.h"

namespace isoshade::reflect {

struct ReadFile {
  std::string path;  ///< to open it; of a document as it was opened
  File file;         ///< as the reflection tells of it
  support::Span where = {};  ///< of an image: where the document names it
};

/// The document, then those that it extends, the functions that it uses, and the images that nodes and parameters name,
/// each by path. Reads the images, but only those that `rule` lets the document read that names them.
std::vector<ReadFile> files_of(const check::TypedGraph& graph, const graph::FileRule& rule);

/// The name of a file that a document names: the path from the top of the collection, or of the document's own folder where
/// there is none; "library/..." in the library. The same in every working directory. "" for "".
std::string file_name(const check::TypedGraph& graph, const std::string& path, const graph::FileRule& rule);

}  // namespace isoshade::reflect
