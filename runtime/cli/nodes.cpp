// SPDX-License-Identifier: Apache-2.0
// isoshade nodes, isoshade schema: describe the node library for readers and for editors.
#include <algorithm>
#include <cstdio>

#include "compiler/driver/library_rows.h"
#include "compiler/driver/node_cost.h"
#include "compiler/graph/expression.h"
#include "compiler/nodes/manual.h"
#include "compiler/nodes/schema.h"
#include "runtime/cli/frame_times.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/visible.h"
#include "runtime/cli/session.h"
#include "runtime/scene/format.h"

namespace isoshade::cli {

namespace {

/// The types for which the cost is printed: of those that the row accepts, float and a type of three components.
std::vector<nodes::Example> measured(const nodes::Row& row) {
  const std::vector<nodes::Example> all = nodes::examples_of(row);
  std::vector<nodes::Example> chosen;
  for (const graph::Type wanted : {graph::Type::floating, graph::Type::vector3, graph::Type::color3}) {
    const auto found = std::ranges::find(all, wanted, &nodes::Example::t);
    if (found != all.end() && chosen.size() < 2) chosen.push_back(*found);
  }
  return chosen.empty() ? std::vector{all.front()} : chosen;
}

struct CostText {
  std::string cost, error;
};

CostText cost_text(const nodes::Row& row, functions::Tier tier) {
  std::string cost, error;
  for (const nodes::Example& example : measured(row)) {
    const driver::NodeCost measured = driver::cost_of(example, tier);
    if (!cost.empty()) cost += ", ";
    cost += std::to_string(measured.operations) + " operations";
    const bool typed = std::ranges::any_of(
        row.ports, [](const nodes::Port& port) { return port.type.variable == nodes::Variable::t; });
    if (typed) cost += " on " + std::string(graph::type_name(example.t));
    if (error.empty()) error = driver::error_of(measured, tier);
  }
  return {cost, error};
}

/// Cost and error in the default tier, and in the others if they differ.
std::string cost_text(const nodes::Row& row) {
  const CostText usual = cost_text(row, functions::Tier::standard);
  std::string text = "cost   " + usual.cost + "\nerror  " + usual.error + "\n";
  for (const functions::Tier tier : {functions::Tier::fast, functions::Tier::precise}) {
    const CostText other = cost_text(row, tier);
    if (other.cost == usual.cost && other.error == usual.error) continue;
    text += "with --precision " + std::string(functions::tier_name(tier)) + "\n  cost   " + other.cost +
            "\n  error  " + other.error + "\n";
  }
  return text;
}

}  // namespace

int nodes(const NodesArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  check::Library documents = make_library(common);
  const driver::LibraryRows library(documents, diagnostics);
  if (arguments.name.empty()) {
    const std::string text =
        arguments.markdown ? nodes::table_markdown(library.rows()) : nodes::table_text(library.rows());
    std::fputs(text.c_str(), stdout);
    return flush(diagnostics, common) ? failure : success;
  }
  if (arguments.name == graph::expression_type) {
    std::fputs(nodes::expression_text().c_str(), stdout);
    return success;
  }
  const nodes::Row* row = nodes::find(arguments.name);
  if (row != nullptr) {
    std::string text = nodes::row_text(*row);
    if (row->availability() == nodes::Availability::anywhere) text += cost_text(*row);
    std::fputs(text.c_str(), stdout);
    return success;
  }
  const auto function = std::ranges::find(library.rows(), arguments.name, &nodes::Row::name);
  if (function != library.rows().end()) {
    std::fputs(nodes::row_text(*function).c_str(), stdout);
    return success;
  }
  const nodes::Row* called = nodes::find_function(arguments.name);
  if (called != nullptr && called->group == "function") {
    const std::string_view node = nodes::find_synonym(arguments.name, nodes::table());
    std::string text = nodes::row_text(*called) + "  For expressions; its arguments are in this order.\n";
    if (!node.empty()) text += "  The node is " + std::string(node) + ".\n";
    std::fputs(text.c_str(), stdout);
    return success;
  }
  std::vector<std::string_view> names;
  for (const nodes::Row& known : nodes::table()) names.push_back(known.name);
  for (const nodes::Row& known : library.rows()) names.push_back(known.name);
  const std::string_view other = nodes::find_synonym(arguments.name, nodes::table());
  const std::string_view near = other.empty() ? support::nearest(arguments.name, names) : other;
  diagnostics
      .report(support::Id::unknown_node, "no node and no library function is called " + support::quote(arguments.name))
      .suggest(near.empty() ? "`isoshade nodes` lists all" : "did you mean " + support::quote(near) + "?");
  flush(diagnostics, common);
  return failure;
}

int schema(const SchemaArguments& arguments, const Common& common) {
  if (arguments.stats) {
    std::fputs(measured_schema().c_str(), stdout);
    return success;
  }
  if (arguments.reflection || arguments.markdown) {
    const std::string text = !arguments.reflection ? scene::format::markdown()
                             : arguments.markdown  ? reflect::markdown()
                                                   : reflect::schema();
    std::fputs(text.c_str(), stdout);
    return success;
  }
  support::Diagnostics diagnostics = make_diagnostics(common);
  check::Library documents = make_library(common);
  const driver::LibraryRows library(documents, diagnostics);
  std::fputs(nodes::json_schema(library.rows(), scene::format::schema()).c_str(), stdout);
  return flush(diagnostics, common) ? failure : success;
}

}  // namespace isoshade::cli
