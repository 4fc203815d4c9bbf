// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/node_cost.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "compiler/check/check.h"
#include "compiler/functions/library.h"
#include "compiler/graph/document.h"
#include "compiler/ir/expansion.h"
#include "compiler/lower/lower.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/assert.h"

namespace isoshade::driver {

namespace {

lower::Lowered lowered(const nodes::Example& example) {
  support::Diagnostics diagnostics;
  const auto source =
      std::make_shared<support::SourceFile>("example.json", nodes::function_document(std::span(&example, 1)));
  const auto document = graph::parse_document(source, diagnostics);
  auto graph = document ? graph::build_graph(*document, diagnostics) : std::nullopt;
  check::Library library;
  const auto typed = graph ? check::check(std::move(*graph), library, diagnostics) : nullptr;
  if (typed == nullptr) support::bug(diagnostics.text());
  return lower::lower(*typed);
}

bool is_operation(ir::Opcode op) { return static_cast<int>(op) < ir::primitive_count; }

std::string error_of_row(std::string_view row, functions::Tier tier) {
  const auto found = std::ranges::find(functions::variants(), row, &functions::Variant::row);
  support::assert_that(found != functions::variants().end(), row);
  const functions::Accuracy& accuracy = found->accuracy[static_cast<size_t>(tier)];
  return fmt::format("{:g} ULP{}", accuracy.ulp,
                     accuracy.unit == "result"         ? ""
                     : accuracy.unit == "ones(result)" ? " of 1"
                                                       : " of its terms");
}

}  // namespace

NodeCost cost_of(const nodes::Example& example, functions::Tier tier) {
  NodeCost cost;
  auto [module, interface] = lowered(example);
  std::set<std::string> calls;
  const uint32_t entry = interface.entry;
  for (const ir::Instruction& instruction : module.functions[entry].instructions) {
    cost.own_operations += is_operation(instruction.op) ? 1 : 0;
    if (instruction.op != ir::Opcode::call) continue;
    const std::string& name = module.functions[instruction.imm].library;
    for (const functions::Variant& variant : functions::variants())
      if (variant.name == name) calls.emplace(variant.row);
  }
  cost.calls.assign(calls.begin(), calls.end());
  passes::Entries entries{entry};
  passes::run(passes::optimisations(), module, entries, tier);
  cost.operations = static_cast<int64_t>(ir::expanded_operations(module, entries[0])[entries[0]]);
  return cost;
}

std::string error_of(const NodeCost& cost, functions::Tier tier) {
  if (cost.calls.empty()) {
    if (cost.own_operations == 0) return "exact";
    return cost.own_operations == 1 ? "0 ULP" : fmt::format("0 ULP in each of {} steps", cost.own_operations);
  }
  if (cost.calls.size() == 1 && cost.own_operations == 0) return error_of_row(cost.calls[0], tier);
  std::string text;
  for (const std::string& row : cost.calls)
    text += (text.empty() ? "" : ", ") + fmt::format("{} in `{}`", error_of_row(row, tier), row);
  return text + (cost.own_operations > 0 ? ", else 0 in each step" : "");
}

}  // namespace isoshade::driver
