// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/library.h"

#include <algorithm>
#include <filesystem>

#include "compiler/check/work.h"
#include "compiler/graph/document.h"
#include "compiler/graph/files.h"
#include "compiler/nodes/table.h"

namespace isoshade::check {

namespace fs = std::filesystem;
using graph::canonical_path;
using graph::is_within;
using support::Diagnostics;
using support::Id;
using support::quote;
using support::Span;

namespace {

constexpr std::string_view extension = ".json";
constexpr size_t longest_path = 1024;

std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

std::string joined(const std::string& folder, std::string_view name) {
  return (fs::path(folder) / name).lexically_normal().string();
}

/// Ids separated by slashes ("brdf/ggx_d"), so that a library name cannot point outside of the library.
bool is_library_name(std::string_view name) {
  while (true) {
    const size_t slash = name.find('/');
    if (!graph::is_id(name.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    name.remove_prefix(slash + 1);
  }
}

/// "a.json -> b.json -> a.json"
std::string cycle_from(const Scope& last, const std::string& path) {
  std::vector<const Scope*> users;
  for (const Scope* scope = &last;; scope = scope->user) {
    users.push_back(scope);
    if (scope->path == path) break;
  }
  std::string text;
  for (auto it = users.rbegin(); it != users.rend(); ++it) text += support::visible((*it)->document) + " -> ";
  return text + support::visible(users.back()->document);
}

}  // namespace

Library::Library(std::string root) : root_(std::move(root)) {
  if (!root_.empty()) files_.library = canonical_path(root_);
}

void Library::add(const std::string& path, std::string text) {
  files_.memory[canonical_path(path)] = std::make_shared<support::SourceFile>(path, std::move(text));
}

Scope Library::scope_of(const std::string& path) const {
  Scope scope;
  scope.path = canonical_path(path);
  scope.folder = folder_of(path);
  const bool in_library = is_within(scope.path, files_.library);
  scope.home = in_library ? files_.library : graph::home_of(path, files_);
  scope.document = graph::name_in_collection(scope.path, scope.home, files_);
  return scope;
}

Library::Location Library::locate(std::string_view reference, const Scope& from) const {
  Location location;
  if (reference.ends_with(extension)) {
    location.path = joined(from.folder, reference);
    location.canonical = canonical_path(location.path);
    location.in_library = is_within(location.canonical, files_.library);
  } else if (!root_.empty()) {
    const std::string file = std::string(reference) + std::string(extension);
    location.path = joined(root_, file);
    location.canonical = files_.library + "/" + file;
    location.in_library = true;
  }
  return location;
}

bool Library::exists(const Location& location) const {
  std::error_code error;
  return files_.memory.contains(location.canonical) || fs::is_regular_file(location.path, error);
}

std::shared_ptr<const TypedGraph> Library::function(const Reference& referred, const Scope& from,
                                                    const Span& where, Diagnostics& diagnostics) {
  const std::string_view reference = referred.name;
  const bool is_path = reference.ends_with(extension) && reference.size() <= longest_path &&
                       reference.find('\0') == std::string_view::npos;
  const Location location = is_path || is_library_name(reference) ? locate(reference, from) : Location{};
  if (is_path && !files_.permits(location.canonical, from.home)) {
    diagnostics.report(Id::outside_reference, where, quote(reference) + " is outside of the folder tree")
        .note(std::string(graph::reference_rule));
    return nullptr;
  }
  if (!is_path && (location.path.empty() || !exists(location))) {
    support::Diagnostic& report = diagnostics.report(Id::unknown_node_type, where,
                                                     "there is no node type or library function " + quote(reference));
    if (diagnostics.full()) return nullptr;
    if (const auto other = nodes::find_synonym(reference, referred.rows); !other.empty()) {
      report.suggest("its name here is " + quote(other));
      return nullptr;
    }
    const std::vector<std::string> functions = names();
    std::vector<std::string_view> candidates(functions.begin(), functions.end());
    for (const nodes::Row& row : referred.rows) candidates.push_back(row.name);
    suggest_nearest(diagnostics, report, reference, candidates);
    return nullptr;
  }
  for (const Scope* user = &from; user != nullptr; user = user->user) {
    if (user->path != location.canonical) continue;
    diagnostics.report(Id::recursion, where,
                       "the function is recursive: " + cycle_from(from, location.canonical));
    return nullptr;
  }
  const std::pair key(location.canonical, location.in_library ? files_.library : from.home);
  const auto found = functions_.find(key);
  if (found == functions_.end()) return functions_[key] = load(location, from, where, diagnostics);
  // Its errors were reported when it was loaded, but possibly to another Diagnostics.
  if (found->second == nullptr && !diagnostics.has_errors())
    diagnostics.report(Id::broken_function, where, quote(location.path) + " has errors");
  return found->second;
}

std::shared_ptr<const TypedGraph> Library::load(const Location& location, const Scope& from,
                                                const Span& where, Diagnostics& diagnostics) {
  Scope scope;
  scope.path = location.canonical;
  scope.folder = folder_of(location.path);
  scope.home = location.in_library ? files_.library : from.home;
  scope.document = graph::name_in_collection(scope.path, scope.home, files_);
  scope.user = &from;
  scope.depth = from.depth + 1;
  if (scope.depth > max_document_depth) {
    diagnostics.report(
        Id::too_deep, where,
        "function documents are nested more than " + std::to_string(max_document_depth) + " deep");
    return nullptr;
  }
  const support::Source source = graph::read_document(location.path, files_, diagnostics, where);
  if (source == nullptr) return nullptr;
  const std::optional<graph::Document> document = graph::parse_document(source, diagnostics);
  if (!document) return nullptr;
  std::optional<graph::Graph> graph = graph::build_graph(*document, diagnostics);
  if (!graph) return nullptr;
  if (graph->kind != graph::DocumentKind::function) {
    diagnostics.report(Id::wrong_kind, where,
                       "a node type must be a function document, but " + quote(location.path) + " is of kind " +
                           std::string(graph::kind_name(graph->kind)));
    return nullptr;
  }
  const bool generic = graph->is_generic();
  std::shared_ptr<const TypedGraph> typed = check_in(std::move(*graph), scope, *this, diagnostics);
  scope.user = nullptr;  // the user's scope ends with this call
  if (typed != nullptr && generic) generics_[typed.get()] = {scope, {{Type::floating, typed}}};
  return typed;
}

std::shared_ptr<const TypedGraph> Library::instance(const std::shared_ptr<const TypedGraph>& function,
                                                    Type type, const Span& where, Diagnostics& diagnostics) {
  Generic& generic = generics_.at(function.get());
  if (const auto found = generic.instances.find(type); found != generic.instances.end()) {
    if (found->second == nullptr && !diagnostics.has_errors())
      diagnostics.report(Id::broken_function, where, quote(function->document) + " has errors");
    return found->second;
  }
  graph::Graph graph = function->graph;
  const std::string type_name(graph::type_name(type));
  graph.name += "_" + type_name;
  for (graph::Input& input : graph.inputs)
    if (input.any) input.type = type;
  const size_t reports_before = diagnostics.all().size();
  auto typed = check_in(std::move(graph), generic.scope, *this, diagnostics);
  if (typed == nullptr && diagnostics.all().size() > reports_before)
    diagnostics.all()[reports_before].note(where, "in the instance of the function used here, with type " + type_name);
  return generic.instances[type] = std::move(typed);
}

std::vector<std::string> Library::loaded() const {
  std::map<std::string, std::string> by_canonical_path;
  for (const auto& [key, function] : functions_)
    if (function != nullptr) by_canonical_path.emplace(key.first, function->graph.source->path());
  std::vector<std::string> paths;
  for (const auto& [canonical, path] : by_canonical_path) paths.push_back(path);
  return paths;
}

std::vector<std::string> Library::names() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& canonical_path) {
    if (!is_within(canonical_path, files_.library) || !canonical_path.ends_with(extension)) return;
    const size_t first = files_.library.size() + 1;
    names.push_back(canonical_path.substr(first, canonical_path.size() - first - extension.size()));
  };
  std::error_code error;
  if (!root_.empty()) {
    fs::recursive_directory_iterator entry(files_.library, error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
      add(entry->path().string());
  }
  for (const auto& [path, source] : files_.memory) add(path);
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace isoshade::check
