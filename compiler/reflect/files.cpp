// SPDX-License-Identifier: Apache-2.0
#include "compiler/reflect/files.h"

#include <algorithm>
#include <map>
#include <set>

#include "compiler/graph/image_document.h"
#include "compiler/lower/image_slots.h"
#include "compiler/support/read_file.h"
#include "compiler/support/sha256.h"

namespace isoshade::reflect {

namespace {

constexpr size_t most_image_bytes = size_t{1} << 30;

/// The documents of all functions that a graph uses, by canonical path.
void add_functions(const check::TypedGraph& graph, std::map<std::string, const check::TypedGraph*>& found,
                   std::set<const check::TypedGraph*>& seen) {
  for (const check::Node& node : graph.nodes) {
    const check::TypedGraph* callee = node.callee.get();
    if (callee == nullptr || !seen.insert(callee).second) continue;
    found.emplace(graph::canonical_path(callee->graph.source->path()), callee);
    add_functions(*callee, found, seen);
  }
}

/// The files that an image document names; none if it cannot be read, which `isoshade render` reports.
std::vector<graph::ImageFile> files_of_image(const std::string& path, const support::Span& where,
                                             const graph::FileRule& rule) {
  std::vector<graph::ImageFile> files;
  support::Diagnostics unseen;
  if (!graph::may_read(path, where, rule, unseen)) return files;
  const auto image = graph::read_image_document(path, rule, unseen, where);
  if (!image) return files;
  for (const graph::ImageLayers& layers : image->layers)
    files.insert(files.end(), layers.levels.begin(), layers.levels.end());
  return files;
}

}  // namespace

std::string file_name(const check::TypedGraph& graph, const std::string& path, const graph::FileRule& rule) {
  if (path.empty()) return "";
  return graph::name_in_collection(graph::canonical_path(path),
                                   graph::home_of(graph.graph.source->path(), rule), rule);
}

std::vector<ReadFile> files_of(const check::TypedGraph& graph, const graph::FileRule& rule) {
  std::vector<ReadFile> files;
  const auto add_document = [&](const support::SourceFile& source, FileRole role) {
    const std::string name = file_name(graph, source.path(), rule);
    files.push_back({source.path(), {name, role, support::sha256(source.text())}, {}});
  };
  add_document(*graph.graph.source, FileRole::document);
  for (const support::Source& base : graph.graph.bases) add_document(*base, FileRole::base);
  std::map<std::string, const check::TypedGraph*> functions;
  std::set<const check::TypedGraph*> seen;
  add_functions(graph, functions, seen);
  for (const auto& [path, function] : functions) add_document(*function->graph.source, FileRole::function);
  struct Image {
    std::string path;     ///< to open it
    support::Span where;  ///< a document names it
  };
  std::map<std::string, Image> images;  // by canonical path
  for (const lower::ImageSlot& slot : lower::image_slots(graph).slots) {
    if (slot.path.empty()) continue;
    const std::string& document = slot.place.file->path();
    const std::string path = graph::path_beside(document, slot.path);
    images.emplace(graph::canonical_path(path), Image{path, slot.place});
    if (!graph::is_image_document(path)) continue;
    for (const graph::ImageFile& file : files_of_image(path, slot.place, rule))
      images.emplace(graph::canonical_path(file.path), Image{file.path, file.where});
  }
  for (const auto& [canonical, image] : images) {
    const auto& [path, where] = image;
    ReadFile& read = files.emplace_back(ReadFile{path, {file_name(graph, path, rule), FileRole::image, {}}, where});
    if (!rule.permits(canonical, graph::home_of(where.file->path(), rule))) continue;
    if (const auto text = support::read_file(path, most_image_bytes); text.bytes)
      read.file.sha256 = support::sha256(*text.bytes);
  }
  std::ranges::stable_sort(files, {}, [](const ReadFile& file) {
    return std::pair(file.file.role, std::string_view(file.file.path));
  });
  return files;
}

}  // namespace isoshade::reflect
