// SPDX-License-Identifier: Apache-2.0
// Which files a document may refer to: those of its own collection, and the library. Documents in memory take the place
// of files.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade::graph {

/// A file of this name, with any content, marks the top folder of a collection of documents.
inline constexpr std::string_view collection_marker = "isoshade.root";

/// The absolute path without symbolic links and dots; the file need not exist.
std::string canonical_path(const std::string& path);

/// Whether a canonical path is the canonical folder or below it; false for the folder "".
bool is_within(const std::string& path, const std::string& folder);

/// Resolves a path in a document relative to the document's folder.
std::string path_beside(const std::string& document_path, const std::string& path);

struct FileRule {
  std::string library;         ///< canonical; readable by every document; empty if there is none
  bool allow_outside = false;  ///< the user trusts the documents
  std::map<std::string, support::Source> memory = {};  ///< read in place of files, by canonical path

  bool permits(const std::string& canonical, const std::string& home) const {
    return allow_outside || is_within(canonical, home) || is_within(canonical, library);
  }
};

/// The canonical folder that a document's references must stay in: the nearest folder with the marker, from the
/// document's own upwards, or its own if there is none.
std::string home_of(const std::string& document_path, const FileRule& rule = {});

/// The document in memory, or else the file, that has this path. Reports a failure and returns null.
support::Source read_document(const std::string& path, const FileRule& rule,
                              support::Diagnostics& diagnostics, const support::Span& where = {});

/// The name of a file that a document refers to, the same in every working directory: "library/..." in the library, else the
/// path from the folder `home` of the document.
std::string name_in_collection(const std::string& canonical, const std::string& home, const FileRule& rule);

/// Whether the text at `where` may refer to the file; reports it if not. The user may name any file: `where` is then
/// empty or in a command line argument.
bool may_read(const std::string& path, const support::Span& where, const FileRule& rule,
              support::Diagnostics& diagnostics);

/// The note of an outside-reference error.
inline constexpr std::string_view reference_rule =
    "documents may refer to files in their own folder and below, and in the library; a file isoshade.root at the "
    "top of a collection extends this to the whole collection, and --allow-outside lifts the restriction";

}  // namespace isoshade::graph
