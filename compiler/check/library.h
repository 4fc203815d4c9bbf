// SPDX-License-Identifier: Apache-2.0
// The function documents that graphs use as nodes: found, loaded and checked, each once.
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

/// A document being checked, as the place that references start from.
struct Scope {
  std::string path;             ///< canonical
  std::string folder;           ///< as the user spelled it
  std::string home;             ///< canonical; the folder tree that relative references stay in
  std::string document;         ///< TypedGraph::document
  const Scope* user = nullptr;  ///< the document that uses this one
  int depth = 0;
};

/// What a node's type says: a library name, or a path relative to the document that ends in ".json".
struct Reference {
  std::string_view name;
  const std::vector<nodes::Row>& rows;  ///< among which the name was looked for before
};

class Library {
 public:
  /// `root`: the folder of the shipped functions; "brdf/ggx_d" is brdf/ggx_d.json in it. Empty: there are
  /// none.
  explicit Library(std::string root = {});

  /// Lets documents name files anywhere.
  void allow_outside(bool on) { files_.allow_outside = on; }
  const graph::FileRule& files() const { return files_; }

  /// A document that is not read from a file but found under `path` all the same.
  void add(const std::string& path, std::string text);

  /// The scope of a document that the user named. A library for many compilations sees each document once:
  /// make a new one after files changed.
  Scope scope_of(const std::string& path) const;

  /// The function that is referred to; where its inputs are of any type, with floats. Reports why there is
  /// none.
  std::shared_ptr<const TypedGraph> function(const Reference& reference, const Scope& from,
                                             const support::Span& where, support::Diagnostics& diagnostics);

  /// A function with inputs of any type, with these of type `type`. Reports what in it has no such type.
  std::shared_ptr<const TypedGraph> instance(const std::shared_ptr<const TypedGraph>& function, Type type,
                                             const support::Span& where, support::Diagnostics& diagnostics);

  /// All library names, sorted.
  std::vector<std::string> names() const;

 private:
  struct Location {
    std::string path;  ///< to read and to show
    std::string canonical;
    bool in_library = false;
  };
  struct Generic {
    Scope scope;  ///< its own, without a user
    std::map<Type, std::shared_ptr<const TypedGraph>> instances;
  };
  Location locate(std::string_view reference, const Scope& from) const;
  bool exists(const Location& location) const;
  support::Source read(const Location& location, const support::Span& where,
                       support::Diagnostics& diagnostics) const;
  std::shared_ptr<const TypedGraph> load(const Location& location, const Scope& from,
                                         const support::Span& where, support::Diagnostics& diagnostics);

  std::string root_;
  graph::FileRule files_;
  std::map<std::string, support::Source> memory_;  ///< by canonical path
  /// By canonical path and home, which decides what the document may refer to; null: it has errors.
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const TypedGraph>> functions_;
  /// Of functions with inputs of any type; these are float in what functions_ has.
  std::map<const TypedGraph*, Generic> generics_;
};

}  // namespace isoshade::check
