// SPDX-License-Identifier: Apache-2.0
// The state of checking one document, and the steps in the order in which check.cpp runs them.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/check/check.h"
#include "compiler/support/visible.h"

namespace isoshade::check {

/// What the author wrote for an operand; both are null if nothing.
struct Given {
  const graph::Port* port = nullptr;
  const graph::Link* link = nullptr;
};

struct Work {
  TypedGraph& typed;
  const Scope& scope;
  Library& library;
  support::Diagnostics& diagnostics;
  std::vector<Given> given = {};               ///< parallel to TypedGraph::operands
  std::vector<const graph::Link*> roots = {};  ///< parallel to TypedGraph::outputs; null for a cutoff that is not given
  std::deque<graph::Link> links = {};          ///< parsed from strings in ports
  /// The function documents that the graph uses, by the source that names them (TextRange) and the node type.
  std::map<std::pair<uint32_t, std::string_view>, std::shared_ptr<const TypedGraph>> functions = {};
  uint64_t passed_numbers = 0;  ///< scalars passed to and from functions
  /// Nodes whose output is a vector only because literal arrays default to vectors; it is accepted as a colour, too.
  std::vector<bool> untyped = {};
  /// Nodes with errors. Their outputs have no type, and nodes that read them report no further errors.
  std::vector<bool> broken = {};

  const graph::Graph& graph() const { return typed.graph; }
  bool is_untyped(const Operand& operand, const graph::Link& link) const {
    return operand.from == Operand::From::node && link.selectors.empty() && untyped[operand.index];
  }
  /// Whether this is an instance of a generic function other than the one for float, which was checked first.
  bool is_instance() const {
    return std::ranges::any_of(
        graph().inputs, [](const graph::Input& input) { return input.any && input.type != Type::floating; });
  }
  support::Span span(graph::TextRange place) const { return graph().span(place); }
  support::Diagnostic& report(support::Id id, graph::TextRange place, std::string message) {
    return diagnostics.report(id, span(place), std::move(message));
  }
};

/// Finds the row or function document of every node, and resolves the links.
void resolve(Work& work);
/// Sorts the nodes topologically; reports cycles.
void order(Work& work);
/// Infers all types, and stores literals and defaults.
void infer(Work& work);
/// Finds what the document needs of its stage; reports misplaced nodes, second derivatives and graphs that expand too
/// far, and warns about unused nodes.
void check_usage(Work& work);

/// Checks a document in its scope.
std::shared_ptr<const TypedGraph> check_in(graph::Graph graph, const Scope& scope, Library& library,
                                           support::Diagnostics& diagnostics);

/// Suggests the candidate nearest to `word`, if one is close enough.
void suggest_nearest(support::Diagnostics& diagnostics, support::Diagnostic& report, std::string_view word,
                     const std::vector<std::string_view>& candidates);

/// `"a", "b" and "c"`; `last` replaces "and".
std::string listed(const std::vector<std::string_view>& words, std::string_view last = "and");

}  // namespace isoshade::check
