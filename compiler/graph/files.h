// SPDX-License-Identifier: Apache-2.0
// Which files a document may name: those of its own collection, and the library.
#pragma once

#include <string>
#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade::graph {

/// A file of this name, whatever is in it, marks the top folder of a collection of documents.
inline constexpr std::string_view collection_marker = "isoshade.root";

/// Absolute, without links and dots, whether or not it exists.
std::string canonical_path(const std::string& path);

/// Whether a canonical path is the canonical folder or lies below it. Nothing lies in the folder "".
bool is_within(const std::string& path, const std::string& folder);

/// The canonical folder that a document's references stay in: the nearest one, from its own upwards, that has
/// the marker; its own if there is none.
std::string home_of(const std::string& document_path);

/// A path that a document has, which counts from its folder.
std::string path_beside(const std::string& document_path, const std::string& path);

struct FileRule {
  std::string library;         ///< canonical; open to every document; empty: there is none
  bool allow_outside = false;  ///< the user trusts the documents

  bool permits(const std::string& canonical, const std::string& home) const {
    return allow_outside || is_within(canonical, home) || is_within(canonical, library);
  }
};

/// Whether what is written at `where` may name the file; reports it if not. What the user names may lie anywhere: it
/// stands nowhere, or in an argument of the command line.
bool may_read(const std::string& path, const support::Span& where, const FileRule& rule,
              support::Diagnostics& diagnostics);

/// How a refusal ends: what to do about it.
inline constexpr std::string_view way_inside =
    "documents refer to files in their own folder and below, or in the library; a file isoshade.root at the "
    "top of a collection widens that to all of it, and --allow-outside lifts it";

}  // namespace isoshade::graph
