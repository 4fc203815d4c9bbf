// SPDX-License-Identifier: Apache-2.0
#include "compiler/nodes/manual.h"

#include <algorithm>

#include "compiler/graph/expression.h"
#include "compiler/nodes/example.h"
#include "compiler/nodes/table.h"
#include "compiler/support/parse_number.h"

namespace isoshade::nodes {
namespace {

struct SetName {
  TypeSet types;
  std::string_view name;
};
/// Sets that readers know by one word.
constexpr SetName set_names[] = {{value_types, "any type"},
                                 {scalar_types, "float"},
                                 {vector_types, "vector"},
                                 {color_types, "colour"},
                                 {matrix_types, "matrix"}};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

std::string types_text(TypeSet types) {
  std::vector<std::string> words;
  for (const SetName& set : set_names) {
    if ((types | set.types) != types) continue;
    words.emplace_back(set.name);
    types.bits = static_cast<uint16_t>(types.bits & ~set.types.bits);
  }
  for (const Type type : types_in(types)) words.emplace_back(graph::type_name(type));
  return joined(words);
}

std::string surface_text(SurfaceValue value) {
  constexpr std::string_view names[] = {"position",
                                        "position that is seen",
                                        "position at the frame before",
                                        "normal",
                                        "texture coordinates",
                                        "second texture coordinates",
                                        "view direction",
                                        "tangent",
                                        "bitangent",
                                        "colour",
                                        "outline normal",
                                        "pixel size",
                                        "corner normal",
                                        "corner normal",
                                        "corner normal",
                                        "side that is seen"};
  static_assert(std::size(names) == interface::surface_count);
  const bool object = value.space == Space::object;
  return "the surface's " + std::string(names[static_cast<size_t>(value.attribute)]) +
         (object ? " in object space" : "");
}

/// As documents have it: whole numbers without a fraction.
std::string number_text(float number) {
  std::string text = support::format_float(number);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

std::string padded(std::string text, size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text;
}

std::string_view first_sentence(std::string_view doc) {
  const size_t end = doc.find(". ");
  return end == std::string_view::npos ? doc : doc.substr(0, end + 1);
}

std::string line_text(std::string_view name, std::string_view doc) {
  return "  " + padded(std::string(name), 18) + " " + std::string(first_sentence(doc)) + "\n";
}

/// The ports of a function, those with a default in brackets, and its outputs: "alpha float, [n float] -> out float".
std::string signature_text(const Row& row) {
  std::string ports, outputs;
  for (const Port& port : row.ports) {
    const std::string text = std::string(port.name) + " " + types_text(port.type.accepts);
    ports += (ports.empty() ? "" : ", ") + (port.required(true) ? text : "[" + text + "]");
  }
  for (const Output& output : row.outputs)
    outputs += (outputs.empty() ? "" : ", ") + std::string(output.name) + " " + types_text(output.type.accepts);
  return "    " + ports + (ports.empty() ? "" : " ") + "-> " + outputs + "\n";
}

/// A cell of a table: no bars.
std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  return text;
}

/// Of the default tier, and of the others where they differ.
std::string domain_text(const Row& row) {
  const std::string_view usual = domain_of(row);
  if (usual.empty()) return {};
  std::string text = "domain " + std::string(usual) + "\n";
  for (const functions::Tier tier : {functions::Tier::fast, functions::Tier::precise})
    if (const std::string_view own = domain_of(row, tier); own != usual)
      text += "  with --precision " + std::string(functions::tier_name(tier)) + ": " + std::string(own) + "\n";
  return text;
}

std::string port_markdown(const Port& port) {
  const std::string value = default_text(port);
  return "`" + std::string(port.name) + (value.empty() ? "`" : "` (" + value + ")");
}

}  // namespace

std::string type_text(const PortType& type) {
  switch (type.kind) {
    case PortType::Kind::type_name: return "the name of a type: " + types_text(type.accepts);
    case PortType::Kind::choice: return "one of its names";
    case PortType::Kind::component:
    case PortType::Kind::integer: return "a whole number, written in place";
    case PortType::Kind::image: return "the name of an image";
    case PortType::Kind::value: break;
  }
  constexpr std::string_view suffixes[] = {"", " (T)", " (U)"};
  return types_text(type.accepts) + std::string(suffixes[static_cast<size_t>(type.variable)]);
}

std::string default_text(const Port& port) {
  const Default& value = port.value;
  if (const auto* number = std::get_if<float>(&value)) return number_text(*number);
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* text = std::get_if<std::string_view>(&value))
    return text->empty() ? "" : "\"" + std::string(*text) + "\"";
  if (const auto* attribute = std::get_if<SurfaceValue>(&value)) return surface_text(*attribute);
  std::string list;
  if (const auto* numbers = std::get_if<std::array<float, 3>>(&value))
    for (const float number : *numbers) list += (list.empty() ? "[" : ", ") + number_text(number);
  return list.empty() ? list : list + "]";
}

std::string table_text(std::span<const Row> library) {
  std::string text;
  std::string_view group;
  for (const Row& row : table()) {
    if (row.group != group) text += (group.empty() ? "" : "\n") + std::string(row.group) + "\n";
    group = row.group;
    text += line_text(row.name, row.doc);
  }
  text += "\nformulas\n" + line_text(graph::expression_type, graph::expression_doc);
  if (!library.empty()) text += "\nlibrary\n";
  for (const Row& row : library) text += line_text(row.name, row.doc) + signature_text(row);
  return text;
}

std::string expression_text() {
  return std::string(graph::expression_type) + " (formulas)\n  " + std::string(graph::expression_doc) +
         "\nports\n  code  the formula, written in place: \"a*a / (pi * t*t)\"; required\n"
         "  ...   each name in it that is neither a function nor a number: a literal or a link\n"
         "outputs\n  out   what the formula gives\n";
}

std::string row_text(const Row& row) {
  std::string text =
      std::string(row.name) + " (" + std::string(row.group) + ")\n  " + std::string(row.doc) + "\n";
  constexpr std::string_view homes[] = {"", "  Only in effects and posts.\n", "  Only in effects.\n",
                                        "  Only in posts.\n",
                                        "  Only in posts, and in effects for the color of passes that are blended.\n"};
  text += homes[static_cast<size_t>(row.availability())];
  text += domain_text(row);
  size_t width = 0;
  for (const Port& port : row.ports) width = std::max(width, port.name.size() + 2);
  for (const Output& output : row.outputs) width = std::max(width, output.name.size() + 2);
  if (!row.ports.empty()) text += "ports\n";
  for (const Port& port : row.ports) {
    std::string line = "  " + padded(std::string(port.name), width);
    std::vector<std::string> choices;
    for (const std::string_view choice : port.choices) choices.push_back("\"" + std::string(choice) + "\"");
    line += choices.empty() ? type_text(port.type) : joined(choices);
    if (port.takes_input) line += ", or a link to an input with an enum of these names";
    const std::string value = default_text(port);
    if (!value.empty()) line += "; default " + value;
    if (port.required(true)) line += "; required";
    text += line + "\n  " + std::string(width, ' ') + std::string(port.doc) + "\n";
  }
  text += "outputs\n";
  for (const Output& output : row.outputs)
    text += "  " + padded(std::string(output.name), width) + type_text(output.type) + "\n";
  return text;
}

/// Of nodes, and of functions of expressions, with parentheses, that are no nodes by that name.
std::string domains_markdown() {
  std::vector<std::pair<std::string_view, std::string>> lines;  ///< of the same words: with the first of them
  const auto add = [&](std::string_view domain, const std::string& name) {
    if (domain.empty()) return;
    auto line = std::ranges::find(lines, domain, [](const auto& known) { return known.first; });
    if (line == lines.end()) line = lines.insert(lines.end(), {domain, ""});
    line->second += (line->second.empty() ? "" : " ") + name;
  };
  const auto add_row = [&](const Row& row, std::string_view parentheses) {
    const std::string name = "`" + std::string(row.name) + std::string(parentheses) + "`";
    const std::string_view usual = domain_of(row), fast = domain_of(row, functions::Tier::fast);
    add(usual, name);
    if (fast != usual) add(fast, name + " in the tier `fast`");
  };
  for (const Row& row : table()) add_row(row, "");
  for (const Row& row : function_table())
    if (row.is<Function>() && find(row.name) == nullptr) add_row(row, "()");
  std::string text = "| node or function() | takes, and gives beyond |\n|---|---|\n";
  for (const auto& [domain, names] : lines) text += "| " + names + " | " + cell(std::string(domain)) + " |\n";
  return text;
}

/// "mix(x, y, z)"
std::string call_text(const Row& function) {
  std::string arguments;
  for (const Port& port : function.ports) arguments += (arguments.empty() ? "" : ", ") + std::string(port.name);
  return std::string(function.name) + "(" + arguments + ")";
}

/// The node that computes a function, or "".
std::string_view node_of(const Row& function) {
  for (const Row& row : table()) {
    const auto* called = std::get_if<Function>(&row.lowering);
    const auto* op = std::get_if<ir::Opcode>(&row.lowering);
    const auto* other = std::get_if<ir::Opcode>(&function.lowering);
    if (called != nullptr && called->row == function.name) return row.name;
    if (op != nullptr && other != nullptr && *op == *other) return row.name;
  }
  return {};
}

std::string functions_markdown() {
  std::string text = "| call | arguments | gives | node |\n|---|---|---|---|\n";
  for (const Row& function : function_table()) {
    if (function.group != "function") continue;  // an operator
    std::string types;
    for (const Port& port : function.ports)
      types += (types.empty() ? "" : "; ") + std::string(port.name) + ": " + type_text(port.type);
    const std::string_view node = node_of(function);
    text += "| `" + call_text(function) + "` | " + cell(types) + " | " +
            cell(types_text(function.outputs[0].type.accepts)) + " | " +
            (node.empty() ? "" : "`" + std::string(node) + "`") + " |\n";
  }
  return text;
}

std::string pass_states_markdown() {
  std::string text = "| key | value | |\n|---|---|---|\n";
  for (const interface::PassStateRow& state : interface::pass_states())
    for (size_t v = 0; v < state.values.size(); ++v)
      text += "| `" + std::string(state.key) + "` | `\"" + std::string(state.values[v]) + "\"`" +
              (v == state.fallback ? " (default)" : "") + " | " + cell(std::string(state.value_docs[v])) + " |\n";
  return text;
}

std::string table_markdown(std::span<const Row> library) {
  std::string text;
  std::string_view group;
  const auto add = [&](const Row& row) {
    if (row.group != group) {
      text += (group.empty() ? "**" : "\n**") + std::string(row.group) +
              "**\n\n| node | ports (defaults) | gives | |\n|---|---|---|---|\n";
      group = row.group;
    }
    std::string ports, outputs;
    for (const Port& port : row.ports) ports += (ports.empty() ? "" : " ") + port_markdown(port);
    if (row.outputs.size() == 1) outputs = types_text(row.outputs[0].type.accepts);
    for (const Output& output : row.outputs)
      if (row.outputs.size() > 1) outputs += (outputs.empty() ? "`" : " `") + std::string(output.name) + "`";
    text += "| " + cell("`" + std::string(row.name) + "`") + " | " + cell(ports) + " | " + cell(outputs) +
            " | " + cell(std::string(row.doc)) + " |\n";
  };
  std::ranges::for_each(table(), add);
  std::ranges::for_each(library, add);
  return text + "\n**functions of expressions**\n\n" + functions_markdown() + "\n**domains**\n\n" +
         domains_markdown() + "\n**states of passes**\n\n" + pass_states_markdown();
}

}  // namespace isoshade::nodes
