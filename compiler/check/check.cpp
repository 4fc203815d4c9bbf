// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/check.h"

#include "compiler/check/work.h"

namespace isoshade::check {

using support::Id;

namespace {

/// Reports input types that are valid but not supported yet.
void check_supported(Work& work) {
  const graph::Graph& graph = work.graph();
  for (const graph::Input& input : graph.inputs) {
    const bool is_function = graph.kind == graph::DocumentKind::function;
    if (input.type == graph::Type::filename && graph.kind != graph::DocumentKind::post) continue;
    if (nodes::value_types.has(input.type) && (is_function || !nodes::matrix_types.has(input.type))) continue;
    work.report(Id::unsupported, input.place,
                std::string(is_function ? "an input" : "a parameter") + " of type " +
                    std::string(graph::type_name(input.type)) + " is not supported yet");
  }
}

}  // namespace

std::shared_ptr<const TypedGraph> check_in(graph::Graph graph, const Scope& scope, Library& library,
                                           support::Diagnostics& diagnostics) {
  const size_t errors_before = diagnostics.error_count();
  const auto typed = std::make_shared<TypedGraph>();
  typed->graph = std::move(graph);
  typed->document = scope.document;
  Work work{*typed, scope, library, diagnostics};
  check_supported(work);
  resolve(work);
  order(work);
  infer(work);
  // While links are broken, reports about usage would be misleading.
  if (diagnostics.error_count() == errors_before) check_usage(work);
  return diagnostics.error_count() == errors_before ? typed : nullptr;
}

std::shared_ptr<const TypedGraph> check(graph::Graph graph, Library& library,
                                        support::Diagnostics& diagnostics) {
  const Scope scope = library.scope_of(graph.source->path());
  return check_in(std::move(graph), scope, library, diagnostics);
}

void suggest_nearest(support::Diagnostics& diagnostics, support::Diagnostic& report, std::string_view word,
                     const std::vector<std::string_view>& candidates) {
  if (diagnostics.full()) return;
  const std::string_view near = support::nearest(word, candidates);
  if (!near.empty()) report.suggest("did you mean " + support::quote(near) + "?");
}

std::string listed(const std::vector<std::string_view>& words, std::string_view last) {
  std::string text;
  constexpr size_t most = 12;
  for (size_t i = 0; i < words.size() && i < most; ++i) {
    if (i > 0) text += i + 1 == words.size() ? " " + std::string(last) + " " : ", ";
    text += support::quote(words[i]);
  }
  return words.size() > most ? text + ", ..." : text;
}

}  // namespace isoshade::check
