// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/dumps.h"

#include <fmt/format.h>

#include "compiler/graph/graph.h"
#include "compiler/ir/printer.h"
#include "compiler/lower/lower.h"
#include "compiler/nodes/table.h"

namespace isoshade::driver {

namespace {

void dump_json(const graph::Document& document, const graph::Json& json, const std::string& pointer,
               std::string& out) {
  const auto place = document.source_of(json)->position(json.begin);
  out += fmt::format("{}:{} {} ", place.line, place.column, pointer.empty() ? "/" : pointer);
  switch (json.kind) {
    case graph::Json::Kind::null: out += "null\n"; return;
    case graph::Json::Kind::boolean: out += json.boolean ? "true\n" : "false\n"; return;
    case graph::Json::Kind::number: out += fmt::format("{}\n", json.number); return;
    case graph::Json::Kind::string: out += fmt::format("\"{}\"\n", json.string); return;
    case graph::Json::Kind::array:
      out += fmt::format("[{}]\n", json.items.size());
      for (size_t i = 0; i < json.items.size(); ++i)
        dump_json(document, json.items[i], pointer + "/" + std::to_string(i), out);
      return;
    case graph::Json::Kind::object:
      out += fmt::format("{{{}}}\n", json.members.size());
      for (const graph::Member& member : json.members)
        dump_json(document, member.value, pointer + "/" + member.key, out);
      return;
  }
}

std::string text(const graph::Literal& literal) {
  switch (literal.kind) {
    case graph::Literal::Kind::boolean: return literal.boolean ? "true" : "false";
    case graph::Literal::Kind::number: return fmt::format("{}", literal.number);
    case graph::Literal::Kind::numbers: return fmt::format("[{}]", fmt::join(literal.numbers, ", "));
    case graph::Literal::Kind::string: return "\"" + literal.string + "\"";
  }
  return {};
}

std::string text(const graph::Link& link) {
  std::string out = "-> " + link.name;
  for (const std::string& selector : link.selectors) out += "." + selector;
  return out;
}

std::string text(const check::TypedGraph& graph, const check::Operand& operand) {
  const std::string type(graph::type_name(operand.type));
  std::string out;
  switch (operand.from) {
    case check::Operand::From::nothing: return "nothing";
    case check::Operand::From::setting: return fmt::format("#{}", operand.index);
    case check::Operand::From::surface:
      for (const interface::SurfaceValue value : interface::surface_values())
        if (value.index() == operand.index) out = "surface." + interface::name(value);
      break;
    case check::Operand::From::file: out = "\"" + graph.files[operand.index].path + "\""; break;
    case check::Operand::From::words: out = fmt::format("words[{}]", operand.index); break;
    case check::Operand::From::input: out = graph.graph.inputs[operand.index].name; break;
    case check::Operand::From::node:
      out = graph.graph.nodes[operand.index].id;
      if (operand.output != 0) out += fmt::format("#{}", operand.output);
      break;
  }
  if (operand.swizzle_count != 0) out += ".";
  for (int i = 0; i < operand.swizzle_count; ++i) out += "xyzw"[operand.swizzle[static_cast<size_t>(i)]];
  out += ": " + type;
  if (operand.needed != operand.type) out += fmt::format(" as {}", graph::type_name(operand.needed));
  return out;
}

}  // namespace

std::string dump_document(const graph::Document& document) {
  std::string out;
  dump_json(document, document.root, "", out);
  return out;
}

std::string dump_graph(const graph::Graph& graph) {
  std::string out = fmt::format("{} {}\n", graph::kind_name(graph.kind), graph.name);
  for (const graph::Input& input : graph.inputs)
    out += fmt::format("  input {}: {}{}\n", input.name, graph::type_name(input.type),
                       input.value ? " = " + text(*input.value) : "");
  for (const graph::Node& node : graph.nodes) {
    out += fmt::format("  {} = {}", node.id, node.type);
    for (const graph::Port& port : node.ports)
      out += fmt::format(" {}({})", port.name,
                         std::visit([](const auto& value) { return text(value); }, port.value));
    out += "\n";
  }
  for (const graph::Output& output : graph.outputs)
    out += fmt::format("  output {} {}\n", output.name, text(output.link));
  for (const graph::Pass& pass : graph.passes)
    out += fmt::format("  pass {} {}{}{}{}\n", pass.name, text(pass.color),
                       pass.position ? " position " + text(*pass.position) : "",
                       pass.cutout ? " cutout " + text(*pass.cutout) : "",
                       pass.cutoff ? " cutoff " + text(*pass.cutoff) : "");
  return out;
}

std::string dump_typed(const check::TypedGraph& graph) {
  std::string out;
  for (uint32_t index : graph.order) {
    const check::Node& node = graph.nodes[index];
    out += fmt::format("{} = {}", graph.graph.nodes[index].id,
                       node.row != nullptr ? std::string(node.row->name) : node.callee->document);
    for (const check::Operand& operand : graph.operands_of(node))
      out += fmt::format(" ({})", text(graph, operand));
    out += " :";
    for (const check::Type type : graph.types_of(node)) out += fmt::format(" {}", graph::type_name(type));
    out += node.per_iteration ? "  each iteration\n" : "\n";
  }
  for (const check::Operand& operand : graph.outputs)
    if (operand.from != check::Operand::From::nothing) out += fmt::format("output ({})\n", text(graph, operand));
  return out;
}

std::string dump_module(const ir::Module& module) { return ir::print(module); }

}  // namespace isoshade::driver
