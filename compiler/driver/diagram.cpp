// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/diagram.h"

#include <bit>
#include <charconv>
#include <fmt/format.h>
#include <vector>

#include "compiler/driver/box_layers.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::driver {
namespace {

using check::Operand;
using check::TypedGraph;
using graph::Type;
using From = Operand::From;

constexpr std::string_view head = R"(digraph {
  rankdir=LR
  nodesep=0.18
  ranksep=0.45
  bgcolor="#ffffff"
  fontname="DejaVu Sans"
  fontsize=11
  node [shape=plain fontname="DejaVu Sans" fontsize=10]
  edge [fontname="DejaVu Sans" fontsize=8 arrowsize=0.6 color="#4a5568" fontcolor="#4a5568"]
)";

/// Escapes text for Graphviz's HTML labels: tags, entities and escape sequences.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : support::visible(text)) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\\': out += "&#92;"; break;
      default: out += c;
    }
  }
  return out;
}

/// A background colour by type, readable with black text.
std::string_view color_of(Type type) {
  switch (type) {
    case Type::boolean: return "#fbd5d5";
    case Type::integer: return "#e2d9f3";
    case Type::floating: return "#dbeafe";
    case Type::color3:
    case Type::color4: return "#fdecc8";
    case Type::matrix33:
    case Type::matrix44: return "#e5e7eb";
    default: return "#d6f2dc";
  }
}

/// Draws the boxes and links of a document and of the functions that it calls. Names in DOT are "n" and a number.
class Diagram {
 public:
  Diagram(int depth, const std::set<std::string>& left_out) : deepest_(depth), left_out_(left_out) {}

  std::string draw(const TypedGraph& graph) {
    out_ = head;
    whole_ = &graph;
    out_ += fmt::format("  label=\"{} {}\"\n  labelloc=t\n", graph::kind_name(graph.graph.kind),
                        escaped(graph.graph.name));
    Names inputs;
    for (const graph::Input& input : graph.graph.inputs)
      inputs.push_back(full() ? "" : input_box(input, input.value ? " = " + literal_text(*input.value) : ""));
    const Drawn drawn = body(graph, inputs, 0);
    Names names_of_passes;  // in the order of TypedGraph::outputs
    for (const graph::Pass& pass : graph.graph.passes) names_of_passes.push_back(pass.name + " color");
    for (const graph::Pass& pass : graph.graph.passes)
      if (pass.position) names_of_passes.push_back(pass.name + " position");
    for (const graph::Pass& pass : graph.graph.passes)
      if (pass.cutout)
        names_of_passes.insert(names_of_passes.end(), {pass.name + " cutout", pass.name + " cutoff"});
    for (size_t i = 0; i < graph.outputs.size() && !full(); ++i) {
      const check::Operand::From from = graph.outputs[i].from;  // a cutoff may be the default, or missing
      if (from == check::Operand::From::nothing || from == check::Operand::From::words) continue;
      const bool has_outputs = graph.graph.kind != graph::DocumentKind::effect;
      const std::string name = has_outputs ? graph.graph.outputs[i].name : names_of_passes[i];
      edge(source_of(graph.outputs[i], drawn, inputs), output_box(name, graph.outputs[i].needed),
           graph.outputs[i]);
    }
    if (full())
      out_ += fmt::format("  n{} [label=\"more than {} nodes: the rest is not drawn\"]\n", new_box(1),
                          most_drawn_nodes);
    if (boxes_ > most_laid_out_nodes) place_boxes();
    return out_ + "}\n";
  }

 private:
  using Names = std::vector<std::string>;
  /// The start points of links, by node and output: "n3:out".
  using Drawn = std::vector<Names>;

  size_t new_box(size_t rows) {
    layers_.add_box(rows);
    return boxes_++;
  }
  bool full() const { return boxes_ > most_drawn_nodes; }

  /// Adds the position of each box, so that Graphviz only draws. Raster output is at most 60 inches wide and high.
  void place_boxes() {
    out_ += "  layout=nop\n  splines=line\n  size=\"60,60\"\n";
    const std::vector<BoxLayers::BoxPosition> positions = layers_.positions();
    for (size_t i = 0; i < positions.size(); ++i)
      out_ += fmt::format("  n{} [pos=\"{},{}\"]\n", i, positions[i].x, positions[i].y);
  }

  /// The number of the box at the end of a link: 12 for "n12:i0".
  static size_t box_of(std::string_view end) {
    size_t number = 0;
    std::from_chars(end.data() + 1, end.data() + end.size(), number);
    return number;
  }

  std::string box(std::string_view border, const std::string& rows, std::string_view attributes = "") {
    size_t lines = 0;
    for (size_t at = 0; (at = rows.find("<tr>", at)) != std::string::npos; ++at) ++lines;
    const std::string name = "n" + std::to_string(new_box(lines));
    out_ += fmt::format(
        "  {} [label=<<table border=\"1\" color=\"{}\" cellborder=\"0\" cellspacing=\"0\" "
        "cellpadding=\"3\">{}"
        "</table>>{}]\n",
        name, border, rows, attributes);
    return name;
  }

  std::string input_box(const graph::Input& input, const std::string& value) {
    const std::string type(input.any ? graph::any_type_name : graph::type_name(input.type));
    return box("#111827", fmt::format("<tr><td port=\"out\" bgcolor=\"{}\"><b>{}</b>  {}{}</td></tr>",
                                      color_of(input.type), escaped(input.name), type, escaped(value))) +
           ":out";
  }

  std::string output_box(const std::string& name, Type type) {
    return box("#111827", fmt::format("<tr><td port=\"in\" bgcolor=\"{}\"><b>{}</b>  {}</td></tr>",
                                      color_of(type), escaped(name), graph::type_name(type))) +
           ":in";
  }

  static std::string literal_text(const graph::Literal& literal) {
    switch (literal.kind) {
      case graph::Literal::Kind::boolean: return literal.boolean ? "true" : "false";
      case graph::Literal::Kind::number: return support::format_float(literal.number);
      case graph::Literal::Kind::string: return support::quote(literal.string);
      case graph::Literal::Kind::numbers: break;
    }
    std::string text;
    for (const float number : literal.numbers)
      text += (text.empty() ? "" : ", ") + support::format_float(number);
    return "[" + text + "]";
  }

  /// Formats a literal or default value.
  static std::string words_text(const TypedGraph& graph, const Operand& operand) {
    const uint32_t* words = graph.words.data() + operand.index;
    if (operand.needed == Type::boolean) return words[0] != 0 ? "true" : "false";
    if (operand.needed == Type::integer) return std::to_string(static_cast<int32_t>(words[0]));
    std::string text;
    bool same = true;
    const int count = graph::float_count(operand.needed);
    for (int i = 0; i < count; ++i) {
      same &= words[i] == words[0];
      text += (i == 0 ? "" : ", ") + support::format_float(std::bit_cast<float>(words[i]));
    }
    return count == 1 ? text
           : same     ? support::format_float(std::bit_cast<float>(words[0]))
                      : "[" + text + "]";
  }

  static const std::string* given_text(const graph::Node& node, std::string_view port) {
    for (const graph::Port& given : node.ports) {
      const auto* literal = std::get_if<graph::Literal>(&given.value);
      if (given.name == port && literal != nullptr) return &literal->string;
    }
    return nullptr;
  }

  Names output_names(const check::Node& node) const {
    Names names;
    if (node.row != nullptr)
      for (const nodes::Output& output : node.row->outputs) names.emplace_back(output.name);
    else
      for (const graph::Output& output : node.callee->graph.outputs) names.push_back(output.name);
    return names;
  }

  bool is_left_out(const TypedGraph& graph, uint32_t node) const {
    return &graph == whole_ && left_out_.contains(graph.graph.nodes[node].id);
  }
  /// The box of a node of which nothing is computed is grey.
  std::string color_of_node(const TypedGraph& graph, uint32_t node, Type type) const {
    return is_left_out(graph, node) ? "#f3f4f6" : std::string(color_of(type));
  }
  std::string box_of_node(const TypedGraph& graph, uint32_t node, const std::string& rows) {
    return is_left_out(graph, node) ? box("#d1d5db", rows, " fontcolor=\"#9ca3af\"") : box("#6b7280", rows);
  }

  /// The box of a node, or of a function whose contents are not drawn.
  std::string node_box(const TypedGraph& graph, uint32_t index) {
    const check::Node& node = graph.nodes[index];
    const graph::Node& source = graph.graph.nodes[index];
    const auto operands = graph.operands_of(node);
    const auto types = graph.types_of(node);
    std::string rows = fmt::format("<tr><td colspan=\"2\" bgcolor=\"{}\"><b>{}</b>  {}</td></tr>",
                                   color_of_node(graph, index, types.front()), escaped(source.id), escaped(source.label()));
    for (size_t i = 0; i < operands.size(); ++i) {
      const std::string name(node.row != nullptr ? node.row->ports[i].name
                                                 : std::string_view(node.callee->graph.inputs[i].name));
      std::string value;
      if (operands[i].from == From::words) value = " = " + words_text(graph, operands[i]);
      if (operands[i].from == From::setting || operands[i].from == From::nothing) {
        const std::string* text = given_text(source, name);
        if (text == nullptr) continue;
        value = " = " + *text;
      }
      rows += fmt::format("<tr><td align=\"left\" port=\"i{}\">{}{}</td><td></td></tr>", i, escaped(name),
                          escaped(value));
    }
    const Names outputs = output_names(node);
    for (size_t i = 0; i < outputs.size(); ++i)
      rows += fmt::format("<tr><td></td><td align=\"right\" port=\"o{}\">{}  {}</td></tr>", i,
                          escaped(outputs[i]), graph::type_name(types[i]));
    return box_of_node(graph, index, rows);
  }

  std::string expression_box(const TypedGraph& graph, const graph::Expression& expression) {
    const check::Node& root = graph.nodes[expression.root];
    const Type type = graph.types_of(root).front();
    std::string rows = fmt::format(
        "<tr><td colspan=\"2\" bgcolor=\"{}\"><b>{}</b></td></tr><tr><td colspan=\"2\"><i>{}</i></td></tr>",
        color_of_node(graph, expression.root, type), escaped(graph.graph.nodes[expression.root].id),
        escaped(expression.code.substr(0, 120)));
    for (size_t i = 0; i < expression.ports.size(); ++i) {
      const auto* literal = std::get_if<graph::Literal>(&expression.ports[i].value);
      const bool value = literal != nullptr && literal->kind != graph::Literal::Kind::string;
      rows += fmt::format("<tr><td align=\"left\" port=\"i{}\">{}{}</td><td></td></tr>", i,
                          escaped(expression.ports[i].name),
                          value ? " = " + escaped(literal_text(*literal)) : "");
    }
    rows +=
        fmt::format("<tr><td></td><td align=\"right\" port=\"o0\">out  {}</td></tr>", graph::type_name(type));
    return box_of_node(graph, expression.root, rows);
  }

  static std::string source_of(const Operand& operand, const Drawn& drawn, const Names& inputs) {
    if (operand.from == From::input) return inputs[operand.index];
    if (operand.from != From::node || drawn[operand.index].empty()) return "";
    return drawn[operand.index][operand.output];
  }

  void edge(const std::string& from, const std::string& to, const Operand& operand) {
    if (from.empty() || to.empty()) return;
    layers_.add_link(box_of(from), box_of(to));
    std::string label;
    for (int i = 0; i < operand.swizzle_count; ++i) label += "xyzw"[operand.swizzle[static_cast<size_t>(i)]];
    if (!label.empty()) label = "." + label;
    if (operand.type != operand.needed)
      label +=
          (label.empty() ? "" : " ") + std::string("to ") + std::string(graph::type_name(operand.needed));
    out_ +=
        fmt::format("  {} -> {}{}\n", from, to, label.empty() ? "" : fmt::format(" [label=\"{}\"]", label));
  }

  /// Draws all nodes of a document; `inputs` are the start points of links from its inputs.
  Drawn body(const TypedGraph& graph, const Names& inputs, int depth) {
    Drawn drawn(graph.nodes.size());
    // The nodes that are parts of an expression, and the roots of expressions.
    constexpr uint32_t none = ~0u;
    std::vector<uint32_t> expression_at(graph.nodes.size(), none);
    std::vector<bool> is_part(graph.nodes.size());
    for (uint32_t e = 0; e < graph.graph.expressions.size(); ++e) {
      const graph::Expression& expression = graph.graph.expressions[e];
      std::fill(is_part.begin() + expression.first, is_part.begin() + expression.end, true);
      expression_at[expression.root] = e;
    }
    for (const uint32_t i : graph.order) {
      if (full()) break;
      if (is_part[i]) continue;
      if (expression_at[i] != none) {
        draw_expression(graph, graph.graph.expressions[expression_at[i]], drawn, inputs);
      } else if (graph.nodes[i].callee != nullptr && depth < deepest_ && !is_left_out(graph, i)) {
        draw_cluster(graph, i, drawn, inputs, depth);
      } else {
        const std::string name = node_box(graph, i);
        for (uint32_t k = 0; k < graph.nodes[i].output_count; ++k)
          drawn[i].push_back(name + ":o" + std::to_string(k));
        const auto operands = graph.operands_of(graph.nodes[i]);
        for (size_t k = 0; k < operands.size(); ++k)
          edge(source_of(operands[k], drawn, inputs), name + ":i" + std::to_string(k), operands[k]);
      }
    }
    return drawn;
  }

  void draw_expression(const TypedGraph& graph, const graph::Expression& expression, Drawn& drawn,
                       const Names& inputs) {
    const std::string name = expression_box(graph, expression);
    drawn[expression.root] = {name + ":o0"};
    // Pass-through nodes have the name of their port.
    const auto link = [&](uint32_t part) {
      for (const Operand& operand : graph.operands_of(graph.nodes[part])) {
        const bool inner =
            operand.from == From::node && operand.index >= expression.first && operand.index < expression.end;
        if (inner) continue;
        for (size_t i = 0; i < expression.ports.size(); ++i)
          if (expression.ports[i].name == graph.graph.nodes[part].shown)
            edge(source_of(operand, drawn, inputs), name + ":i" + std::to_string(i), operand);
      }
    };
    for (uint32_t part = expression.first; part < expression.end; ++part) link(part);
    link(expression.root);
  }

  /// Draws a called document: its inputs, nodes and outputs in a frame.
  void draw_cluster(const TypedGraph& graph, uint32_t index, Drawn& drawn, const Names& inputs, int depth) {
    const check::Node& node = graph.nodes[index];
    const TypedGraph& callee = *node.callee;
    out_ += fmt::format(
        "  subgraph cluster_{} {{\n  label=\"{}  {}\"\n  style=rounded\n  color=\"#9ca3af\"\n"
        "  bgcolor=\"#f7f7f4\"\n",
        clusters_++, escaped(graph.graph.nodes[index].id), escaped(graph.graph.nodes[index].label()));
    const auto operands = graph.operands_of(node);
    Names own;
    for (size_t i = 0; i < operands.size(); ++i) {
      const bool written = operands[i].from == From::words;
      own.push_back(full() ? ""
                           : input_box(callee.graph.inputs[i],
                                       written ? " = " + words_text(graph, operands[i]) : ""));
    }
    const Drawn inner = body(callee, own, depth + 1);
    for (size_t i = 0; i < callee.outputs.size(); ++i) {
      if (full()) {
        drawn[index].emplace_back();
        continue;
      }
      drawn[index].push_back(output_box(callee.graph.outputs[i].name, callee.outputs[i].needed));
      edge(source_of(callee.outputs[i], inner, own), drawn[index].back(), callee.outputs[i]);
    }
    out_ += "  }\n";
    // Links into the frame must be declared outside of it; otherwise Graphviz draws their source inside.
    for (size_t i = 0; i < operands.size(); ++i)
      edge(source_of(operands[i], drawn, inputs), own[i], operands[i]);
  }

  std::string out_;
  int deepest_;
  const std::set<std::string>& left_out_;
  const TypedGraph* whole_ = nullptr;
  size_t boxes_ = 0, clusters_ = 0;
  BoxLayers layers_;
};

}  // namespace

std::string draw(const TypedGraph& graph, int depth, const std::set<std::string>& left_out) {
  return Diagram(depth, left_out).draw(graph);
}

}  // namespace isoshade::driver
