// SPDX-License-Identifier: Apache-2.0
#include "compiler/nodes/example.h"

#include <algorithm>
#include <map>

namespace isoshade::nodes {
namespace {

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

/// The setting that a port has by default.
uint32_t default_setting(const Port& port) {
  const auto* text = std::get_if<std::string_view>(&port.value);
  if (text == nullptr) return static_cast<uint32_t>(std::get<float>(port.value));
  const auto found = std::ranges::find(port.choices, *text);
  return static_cast<uint32_t>(found - port.choices.begin());
}

/// The types that a variable of the row can have; a single dummy if the row does not use the variable.
std::vector<Type> choices_of(const Row& row, Variable variable) {
  for (const Port& port : row.ports)
    if (port.type.variable == variable) return types_in(port.type.accepts);
  return {Type::floating};
}

}  // namespace

std::vector<Type> types_in(TypeSet set) {
  std::vector<Type> types;
  for (const std::string_view name : graph::all_type_names())
    if (set.has(*graph::find_type(name))) types.push_back(*graph::find_type(name));
  return types;
}

Type Example::type_of(PortType type) const {
  if (type.variable == Variable::none) return types_in(type.accepts).front();
  return type.variable == Variable::u ? u : t;
}

bool Example::accepted() const {
  if (row->condition == nullptr) return true;
  std::vector<Type> types;
  std::vector<uint32_t> settings;
  for (const Port& port : row->ports) {
    const bool value = port.type.kind == PortType::Kind::value;
    const bool type_name = port.type.kind == PortType::Kind::type_name;
    types.push_back(value ? type_of(port.type) : Type{});
    settings.push_back(type_name ? static_cast<uint32_t>(type_of(port.type))
                       : value   ? 0
                                 : default_setting(port));
  }
  return !row->condition(types, settings, type_of(row->outputs[0].type));
}

std::vector<Example> examples_of(const Row& row) {
  std::vector<Example> all;
  for (const Type t : choices_of(row, Variable::t)) {
    for (const Type u : choices_of(row, Variable::u)) {
      const Example example{&row, t, u};
      if (example.accepted()) all.push_back(example);
    }
  }
  return all;
}

std::string function_document(std::span<const Example> examples) {
  std::string inputs, nodes, outputs;
  std::map<std::string, bool> declared;
  const auto separator = [](const std::string& list) { return list.empty() ? "" : ",\n    "; };
  for (size_t n = 0; n < examples.size(); ++n) {
    const Example& example = examples[n];
    const std::string id = "n" + std::to_string(n);
    nodes += separator(nodes) + quoted(id) + ": {\"type\": " + quoted(example.row->name);
    std::map<Type, int> used;
    for (const Port& port : example.row->ports) {
      std::string value;
      if (port.type.kind == PortType::Kind::value) {
        const Type type = example.type_of(port.type);
        const std::string type_name(graph::type_name(type));
        value = type_name + "_" + std::to_string(used[type]++);
        if (!std::exchange(declared[value], true))
          inputs += separator(inputs) + quoted(value) + ": {\"type\": " + quoted(type_name) + "}";
      } else if (port.type.kind == PortType::Kind::type_name) {
        value = graph::type_name(example.type_of(port.type));
      } else {
        continue;
      }
      nodes += ", " + quoted(port.name) + ": " + quoted(value);
    }
    nodes += "}";
    const bool several = example.row->outputs.size() > 1;
    for (const Output& output : example.row->outputs) {
      const std::string name(output.name);
      outputs += separator(outputs) + quoted(several ? id + "_" + name : id) + ": " + quoted(id + "." + name);
    }
  }
  return "{\n  \"isoshade\": 1,\n  \"function\": \"example\",\n  \"inputs\": {\n    " + inputs +
         "\n  },\n  \"nodes\": {\n    " + nodes + "\n  },\n  \"outputs\": {\n    " + outputs + "\n  }\n}\n";
}

}  // namespace isoshade::nodes
