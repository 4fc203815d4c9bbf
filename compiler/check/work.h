// SPDX-License-Identifier: Apache-2.0
// One document on its way through checking, and the steps in the order that check.cpp takes them.
#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "compiler/check/check.h"
#include "compiler/support/visible.h"

namespace isoshade::check {

/// What the author wrote for an operand; both null: nothing.
struct Given {
  const graph::Port* port = nullptr;
  const graph::Link* link = nullptr;
};

struct Work {
  TypedGraph& typed;
  const Scope& scope;
  Library& library;
  support::Diagnostics& diagnostics;
  std::vector<Given> given = {};               ///< of TypedGraph::operands
  std::vector<const graph::Link*> roots = {};  ///< of TypedGraph::outputs
  std::deque<graph::Link> links = {};          ///< those made of strings in ports
  /// What node types that are not in the table refer to.
  std::unordered_map<std::string_view, std::shared_ptr<const TypedGraph>> functions = {};
  uint64_t passed_numbers = 0;  ///< to and from functions
  /// Nodes whose output is a vector only because arrays of numbers are: it is taken where a colour is needed, too.
  std::vector<bool> untyped = {};
  /// Nodes with errors. Their outputs have no type, and what reads them is not complained about again.
  std::vector<bool> broken = {};

  const graph::Graph& graph() const { return typed.graph; }
  bool is_untyped(const Operand& operand, const graph::Link& link) const {
    return operand.from == Operand::From::node && link.selectors.empty() && untyped[operand.index];
  }
  /// Whether a document with inputs of any type is checked again, with another type than float.
  bool is_instance() const {
    return std::ranges::any_of(
        graph().inputs, [](const graph::Input& input) { return input.any && input.type != Type::floating; });
  }
  support::Span span(graph::TextRange place) const { return graph().span(place); }
  support::Diagnostic& report(support::Id id, graph::TextRange place, std::string message) {
    return diagnostics.report(id, span(place), std::move(message));
  }
};

/// Finds what every node is, which ports are given, and which node or input each link names.
void resolve(Work& work);
/// Orders the nodes; reports cycles.
void order(Work& work);
/// Settles all types, literals and defaults.
void infer(Work& work);
/// Reports light nodes outside of sums, graphs that expand without measure, and unused nodes.
void check_usage(Work& work);

/// Checks a document in its scope.
std::shared_ptr<const TypedGraph> check_in(graph::Graph graph, const Scope& scope, Library& library,
                                           support::Diagnostics& diagnostics);

/// Suggests the nearest of `candidates`, if one is near.
void suggest_nearest(support::Diagnostics& diagnostics, support::Diagnostic& report, std::string_view word,
                     const std::vector<std::string_view>& candidates);

/// `"a", "b" and "c"`; `last` stands in the place of "and".
std::string listed(const std::vector<std::string_view>& words, std::string_view last = "and");

}  // namespace isoshade::check
