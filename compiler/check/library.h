// SPDX-License-Identifier: Apache-2.0
// Finds, loads and checks the function documents that graphs use as nodes, each once.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/graph/files.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::check {

/// A document being checked; its references are resolved relative to it.
struct Scope {
  std::string path;             ///< canonical
  std::string folder;           ///< as spelled by the user
  std::string home;             ///< canonical; relative references must stay in this folder tree
  std::string document;         ///< TypedGraph::document
  const Scope* user = nullptr;  ///< the document that uses this one
  int depth = 0;
};

/// A node type that is not in the node table: a library name, or a path relative to the document that ends in ".json".
struct Reference {
  std::string_view name;
  const std::vector<nodes::Row>& rows;  ///< the table that does not contain it; for suggestions
};

/// The folder of the library functions that were installed with this program or shared library; without them, that of the
/// source tree that it was built from.
std::string shipped_library();

class Library {
 public:
  /// `root`: the folder of the shipped functions ("brdf/ggx_d" is brdf/ggx_d.json in it); empty for none.
  explicit Library(std::string root = {});

  /// Lets documents refer to files anywhere.
  void allow_outside(bool on) { files_.allow_outside = on; }
  const graph::FileRule& files() const { return files_; }

  /// Adds an in-memory document that is found under `path` like a file.
  void add(const std::string& path, std::string text);

  /// The scope of a document that the user named. A Library caches documents: create a new one after files
  /// change.
  Scope scope_of(const std::string& path) const;

  /// The function that `reference` names; its generic inputs ("any") have type float. Reports a failure and
  /// returns null.
  std::shared_ptr<const TypedGraph> function(const Reference& reference, const Scope& from,
                                             const support::Span& where, support::Diagnostics& diagnostics);

  /// The instance of a generic function whose "any" inputs have type `type`. Reports type errors in it and
  /// returns null.
  std::shared_ptr<const TypedGraph> instance(const std::shared_ptr<const TypedGraph>& function, Type type,
                                             const support::Span& where, support::Diagnostics& diagnostics);

  /// The paths of the documents that were loaded, each once; in what they make, a change of any may show.
  std::vector<std::string> loaded() const;

  /// All library names, sorted.
  std::vector<std::string> names() const;

 private:
  struct Location {
    std::string path;  ///< for reading and for messages
    std::string canonical;
    bool in_library = false;
  };
  struct Generic {
    Scope scope;  ///< of the function; `user` is null
    std::map<Type, std::shared_ptr<const TypedGraph>> instances;
  };
  Location locate(std::string_view reference, const Scope& from) const;
  bool exists(const Location& location) const;
  std::shared_ptr<const TypedGraph> load(const Location& location, const Scope& from,
                                         const support::Span& where, support::Diagnostics& diagnostics);

  std::string root_;
  graph::FileRule files_;
  /// By canonical path and by home, because home limits what the document may refer to; null if it has errors.
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const TypedGraph>> functions_;
  /// The instances of generic functions, by their float instance, which is the one in functions_.
  std::map<const TypedGraph*, Generic> generics_;
};

}  // namespace isoshade::check
