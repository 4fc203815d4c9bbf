// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/inputs.h"

#include <limits>
#include <unordered_set>

#include "compiler/lower/image_slots.h"
#include "compiler/lower/lower.h"
#include "compiler/nodes/site.h"

namespace isoshade::lower {

using check::TypedGraph;
using graph::Type;
using interface::Assumption;
using interface::Binding;
namespace assume = interface::assume;

namespace {

Assumption assumed_of(const graph::Input& input) {
  if (input.type == Type::boolean) return assume::boolean;
  Assumption assumed = input.unit ? assume::direction : assume::anywhere;
  if (input.min) assumed.lo = static_cast<double>(*input.min);
  if (input.max) assumed.hi = static_cast<double>(*input.max);
  if (!input.names.empty()) assumed = {0, static_cast<double>(input.names.size() - 1)};
  // A written limit may lie beyond the other one, which is assumed.
  if (assumed.lo > assumed.hi && !input.max) assumed.hi = assumed.lo;
  if (assumed.lo > assumed.hi) assumed.lo = assumed.hi;
  return assumed;
}

/// The range of a parameter that the optimiser may rely on: scenes are checked when they are loaded.
void limit(ir::Parameter& parameter, const graph::Input& input) {
  constexpr float most_exact = 0x1p24f, largest = std::numeric_limits<float>::max();
  float least = input.min.value_or(-largest), most = input.max.value_or(largest);
  if (!input.names.empty()) least = 0;
  if (!input.names.empty()) most = static_cast<float>(input.names.size() - 1);
  // A float holds a large integer only approximately.
  const bool exact = input.type != Type::integer || (least >= -most_exact && most <= most_exact);
  if (!exact || input.type == Type::boolean) return;
  parameter.least = least;
  parameter.most = most;
}

}  // namespace

std::vector<std::vector<std::string>> names_of_columns(
    const std::vector<std::pair<std::string, Type>>& values) {
  std::unordered_set<std::string> taken;
  for (const auto& [name, type] : values)
    if (nodes::column_count(type) == 1) taken.insert(name);
  std::vector<std::vector<std::string>> all;
  for (const auto& [name, type] : values) {
    std::vector<std::string>& columns = all.emplace_back();
    const int count = nodes::column_count(type);
    if (count == 1) columns.push_back(name);
    for (int i = 0; count > 1 && i < count; ++i) {
      std::string column = name + "_" + std::to_string(i);
      while (!taken.insert(column).second) column += "_";
      columns.push_back(std::move(column));
    }
  }
  return all;
}

std::vector<Binding> bind_input(const TypedGraph& graph, uint32_t index,
                                const std::vector<std::string>& columns, const std::string& group,
                                bool is_parameter) {
  const graph::Input& input = graph.graph.inputs[index];
  std::vector<Binding> bindings;
  for (uint32_t c = 0; c < columns.size(); ++c) {
    Binding binding{interface::source::Input{index, c},
                    {columns[c], nodes::ir_type(input.type), group, is_parameter},
                    assumed_of(input)};
    if (is_parameter) limit(binding.parameter, input);
    if (c == 0) binding.parameter.doc = input.doc;
    if (columns.size() > 1) binding.element = static_cast<int>(c * columns.size());
    bindings.push_back(std::move(binding));
  }
  return bindings;
}

std::vector<std::vector<std::string>> parameter_names(const TypedGraph& graph) {
  std::vector<std::pair<std::string, Type>> inputs;
  for (const graph::Input& input : graph.graph.inputs) inputs.emplace_back(input.name, input.type);
  return names_of_columns(inputs);
}

std::vector<Binding> parameter_bindings(const TypedGraph& graph) {
  const std::vector<std::vector<std::string>> columns = parameter_names(graph);
  std::vector<Binding> bindings;
  for (uint32_t i = 0; i < columns.size(); ++i) {
    if (graph.graph.inputs[i].type == Type::filename) continue;
    for (Binding& binding : bind_input(graph, i, columns[i], "parameters", true))
      bindings.push_back(std::move(binding));
  }
  const std::vector<ImageSlot> slots = image_slots(graph).slots;
  for (uint32_t i = 0; i < slots.size(); ++i) bindings.push_back(interface::bind_image(i, slots[i].name));
  return bindings;
}

}  // namespace isoshade::lower
