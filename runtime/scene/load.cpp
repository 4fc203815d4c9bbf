// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/load.h"

#include <algorithm>
#include <utility>

#include "compiler/graph/document.h"
#include "compiler/support/visible.h"
#include "runtime/scene/format.h"

namespace isoshade::scene {
namespace {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Id;
using support::quote;

constexpr std::string_view extends_key = format::scene::extends.name;

size_t count_values(const Json& json) {
  size_t count = 1;
  for (const Json& item : json.items) count += count_values(item);
  for (const Member& member : json.members) count += count_values(member.value);
  return count;
}

class Loader {
 public:
  Loader(const graph::FileRule& files, support::Diagnostics& diagnostics)
      : files_(files), diagnostics_(diagnostics) {}

  /// The document merged into the one that it extends. `where` is the text that names it, if a document does.
  std::optional<Document> load(const support::Source& source, const support::Span& where) {
    auto document = graph::parse_document(source, diagnostics_);
    if (!document) return std::nullopt;
    values_ += count_values(document->root);
    if (values_ > graph::max_values) {
      diagnostics_.report(Id::too_large, where,
                          "with " + quote(source->path()) + " the scene has more than " +
                              std::to_string(graph::max_values) + " JSON values");
      return std::nullopt;
    }
    const Json* extends = document->root.find(extends_key);
    if (extends == nullptr) return document;
    // Checked before merging, because the base would supply missing keys.
    const auto kind = graph::document_kind(*document, diagnostics_);
    if (!kind) return std::nullopt;
    if (*kind != graph::DocumentKind::scene) return document;  // reported by the caller
    chain_.push_back(graph::canonical_path(source->path()));
    const support::Span named_where = document->span(*extends);
    if (extends->kind != Json::Kind::string) {
      diagnostics_.report(Id::wrong_type, named_where, "\"extends\" is the path of a scene");
      return std::nullopt;
    }
    auto base = load_base(graph::path_beside(source->path(), extends->string), named_where);
    if (!base) return std::nullopt;
    std::erase_if(document->root.members, [](const Member& member) { return member.key == extends_key; });
    const size_t errors_before = diagnostics_.error_count();
    Document merged = graph::merge(*std::move(base), *std::move(document), diagnostics_);
    if (diagnostics_.error_count() != errors_before) return std::nullopt;
    return merged;
  }

 private:
  std::optional<Document> load_base(const std::string& path, const support::Span& where) {
    if (std::ranges::find(chain_, graph::canonical_path(path)) != chain_.end()) {
      diagnostics_.report(Id::recursion, where, "the scene extends itself through " + quote(path));
      return std::nullopt;
    }
    if (chain_.size() > max_bases) {
      diagnostics_.report(Id::too_large, where,
                          "more than " + std::to_string(max_bases) + " scenes extend each other");
      return std::nullopt;
    }
    if (!graph::may_read(path, where, files_, diagnostics_)) return std::nullopt;
    const support::Source source = graph::read_document(path, files_, diagnostics_, where);
    auto base = source != nullptr ? load(source, where) : std::nullopt;
    if (!base) return std::nullopt;
    const auto kind = graph::document_kind(*base, diagnostics_);
    if (kind && *kind != graph::DocumentKind::scene) {
      diagnostics_.report(
          Id::wrong_kind, where,
          quote(path) + " is not a scene, but a document of the kind " + std::string(graph::kind_name(*kind)));
    }
    return kind == graph::DocumentKind::scene ? std::move(base) : std::nullopt;
  }

  const graph::FileRule& files_;
  support::Diagnostics& diagnostics_;
  std::vector<std::string> chain_;  ///< canonical paths of the scenes that extend
  size_t values_ = 0;
};

}  // namespace

std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics) {
  auto document = Loader(files, diagnostics).load(source, {});
  if (!document || !apply_settings(*document, settings, files, diagnostics)) return std::nullopt;
  return parse_scene(*document, diagnostics);
}

}  // namespace isoshade::scene
