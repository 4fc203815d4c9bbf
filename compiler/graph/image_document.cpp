// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/image_document.h"

#include "compiler/graph/graph.h"
#include "compiler/graph/reader.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {
namespace {

using support::Diagnostics;
using support::Id;
using support::quote;
using Need = ObjectReader::Need;

ImageFile file_of(const Document& document, const Json& path) {
  return {path_beside(document.source_of(path)->path(), path.string), document.span(path)};
}

bool check_path(const Document& document, const Json& json, Diagnostics& diagnostics) {
  if (json.kind == Json::Kind::string && !json.string.empty() && !is_image_document(json.string)) return true;
  const bool is_path = json.kind == Json::Kind::string && !json.string.empty();
  diagnostics
      .report(is_path ? Id::wrong_kind : Id::wrong_type, document.span(json),
              is_path ? "an image document names image files, not other documents"
                      : "the path of an image file is needed here, not " + std::string(kind_name(json.kind)))
      .suggest("name a .png, .jpg, .hdr or .exr file");
  return false;
}

ImageLayers read_layers(const Document& document, const Json& json, Diagnostics& diagnostics) {
  ImageLayers made;
  ObjectReader reader(document, json, "an image layer", diagnostics);
  const bool has_file = json.find("file") != nullptr, has_levels = json.find("levels") != nullptr;
  if (has_file && has_levels) {
    diagnostics.report(Id::unknown_key, document.span(*json.find("levels")), "the layer has both a \"file\" and \"levels\"")
        .suggest("remove one of them: \"file\" is the largest level alone");
  }
  const Json* file = has_levels ? (reader.ignore("file"), nullptr) : reader.value("file");
  if (file != nullptr && check_path(document, *file, diagnostics)) made.levels.push_back(file_of(document, *file));
  const Json* levels = reader.array("levels", Need::optional);
  if (levels != nullptr && (levels->items.empty() || levels->items.size() > max_image_levels)) {
    diagnostics.report(Id::out_of_range, document.span(*levels),
                       "\"levels\" lists " + std::to_string(levels->items.size()) + " files; 1 to " +
                           std::to_string(max_image_levels) + " are possible");
  } else if (levels != nullptr) {
    for (const Json& level : levels->items)
      if (check_path(document, level, diagnostics)) made.levels.push_back(file_of(document, level));
  }
  made.count = static_cast<int>(reader.integer("count", {1, max_image_layers}, 1));
  reader.finish();
  return made;
}

}  // namespace

bool is_image_document(std::string_view path) { return path.ends_with(".json"); }

std::optional<ImageDocument> read_image_document(const std::string& path, const FileRule& files,
                                                 Diagnostics& diagnostics, const support::Span& where) {
  const size_t errors_before = diagnostics.error_count();
  const support::Source source = read_document(path, files, diagnostics, where);
  const auto document = source != nullptr ? parse_document(source, diagnostics) : std::nullopt;
  const auto kind = document ? document_kind(*document, diagnostics) : std::nullopt;
  if (!kind) return std::nullopt;
  if (*kind != DocumentKind::image) {
    diagnostics.report(Id::wrong_kind, where,
                       quote(path) + " is not an image, but a document of the kind " + std::string(kind_name(*kind)));
    return std::nullopt;
  }
  ImageDocument made{source, {}};
  ObjectReader reader(*document, document->root, with_article(*kind) + " document", diagnostics);
  for (const std::string_view key : {"$schema", "isoshade", "doc"}) reader.ignore(key);
  reader.string(kind_name(*kind));
  const Json* layers = reader.array("layers");
  int count = 0;
  if (layers != nullptr) {
    for (const Json& layer : layers->items) {
      made.layers.push_back(read_layers(*document, layer, diagnostics));
      count += made.layers.back().count;
      if (count > max_image_layers) break;
    }
    if (count == 0 || count > max_image_layers)
      diagnostics.report(Id::out_of_range, document->span(*layers),
                         "an image has 1 to " + std::to_string(max_image_layers) + " layers");
  }
  reader.finish();
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return made;
}

}  // namespace isoshade::graph
