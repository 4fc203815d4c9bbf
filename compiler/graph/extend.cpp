// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/extend.h"

#include <algorithm>
#include <utility>

#include "compiler/graph/graph.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {
namespace {

using support::Id;
using support::quote;

size_t count_values(const Json& json) {
  size_t count = 1;
  for (const Json& item : json.items) count += count_values(item);
  for (const Member& member : json.members) count += count_values(member.value);
  return count;
}

class Loader {
 public:
  Loader(const FileRule& files, support::Diagnostics& diagnostics) : files_(files), diagnostics_(diagnostics) {}

  /// `where` is the text that names the document, if a document does.
  std::optional<Document> load(const support::Source& source, const support::Span& where) {
    auto document = parse_document(source, diagnostics_);
    if (!document) return std::nullopt;
    values_ += count_values(document->root);
    if (values_ > max_values) {
      diagnostics_.report(Id::too_large, where,
                          "with " + quote(source->path()) + " the document has more than " +
                              std::to_string(max_values) + " JSON values");
      return std::nullopt;
    }
    const Json* extends = document->root.find(extends_key);
    if (extends == nullptr) return document;
    // Checked before merging, because the base would supply missing keys.
    const auto kind = document_kind(*document, diagnostics_);
    if (!kind) return std::nullopt;
    const bool may_extend = *kind == DocumentKind::effect || *kind == DocumentKind::scene;
    if (!may_extend) return document;  // whoever reads its keys reports this one
    chain_.push_back(canonical_path(source->path()));
    const support::Span named_where = document->span(*extends);
    if (extends->kind != Json::Kind::string) {
      diagnostics_
          .report(Id::wrong_type, named_where,
                  "\"extends\" must be the path of " + with_article(*kind) + ", not " + std::string(kind_name(extends->kind)))
          .suggest("write the path of the base, or remove this key");
      return std::nullopt;
    }
    if (extends->string.empty()) {
      diagnostics_
          .report(Id::missing_file, named_where, "\"extends\" must be the path of " + with_article(*kind) + ", but is empty")
          .suggest("write the path of the base, or remove this key");
      return std::nullopt;
    }
    auto base = load_base(path_beside(source->path(), extends->string), *kind, named_where);
    if (!base) return std::nullopt;
    std::erase_if(document->root.members, [](const Member& member) { return member.key == extends_key; });
    const size_t errors_before = diagnostics_.error_count();
    Document merged = merge(*std::move(base), *std::move(document), diagnostics_);
    if (diagnostics_.error_count() != errors_before) return std::nullopt;
    return merged;
  }

 private:
  std::optional<Document> load_base(const std::string& path, DocumentKind wanted, const support::Span& where) {
    const std::string name(kind_name(wanted));
    if (std::ranges::find(chain_, canonical_path(path)) != chain_.end()) {
      diagnostics_.report(Id::recursion, where, "the " + name + " extends itself through " + quote(path));
      return std::nullopt;
    }
    // The chain lacks the base.
    if (chain_.size() + 1 > max_chain) {
      diagnostics_.report(Id::too_large, where,
                          "more than " + std::to_string(max_chain) + " " + name + "s extend each other");
      return std::nullopt;
    }
    if (!may_read(path, where, files_, diagnostics_)) return std::nullopt;
    const support::Source source = read_document(path, files_, diagnostics_, where);
    auto base = source != nullptr ? load(source, where) : std::nullopt;
    if (!base) return std::nullopt;
    const auto kind = document_kind(*base, diagnostics_);
    if (kind && *kind != wanted) {
      diagnostics_.report(Id::wrong_kind, where,
                          quote(path) + " is not " + with_article(wanted) + ", but a document of the kind " +
                              std::string(kind_name(*kind)));
    }
    return kind == wanted ? std::move(base) : std::nullopt;
  }

  const FileRule& files_;
  support::Diagnostics& diagnostics_;
  std::vector<std::string> chain_;  ///< canonical paths of the documents that extend
  size_t values_ = 0;
};

}  // namespace

std::optional<Document> load_document(const support::Source& source, const FileRule& files,
                                      support::Diagnostics& diagnostics) {
  return Loader(files, diagnostics).load(source, {});
}

}  // namespace isoshade::graph
