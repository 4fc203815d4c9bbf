// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/expression_parser.h"

namespace isoshade::graph {

using support::Id;

namespace {

Literal string_literal(std::string_view text) {
  Literal literal;
  literal.kind = Literal::Kind::string;
  literal.string = text;
  return literal;
}

}  // namespace

uint32_t ExpressionParser::add(std::string_view type, Node::Origin origin, std::string_view shown,
                               TextRange place) {
  if (graph_.expression_nodes == max_expression_nodes && !failed_) {
    diagnostics_.report(Id::too_large, graph_.span(place),
                        "the expressions of the document have more than " +
                            std::to_string(max_expression_nodes) + " operations");
    failed_ = true;
    fail(place, {});
  }
  if (failed_) return root_;
  ++graph_.expression_nodes;
  Node node;
  node.id = id_;
  node.type = type;
  node.shown = shown;
  node.origin = origin;
  node.id_place = node.type_place = node.place = place;
  graph_.nodes.push_back(std::move(node));
  return static_cast<uint32_t>(graph_.nodes.size() - 1);
}

void ExpressionParser::add_port(uint32_t node, std::string_view port, std::string_view shown, Operand operand) {
  if (failed_) return;
  graph_.nodes[node].ports.push_back(
      {std::string(port), std::move(operand.value), operand.place, operand.place, std::string(shown)});
}

ExpressionParser::Operand ExpressionParser::link_to(uint32_t node, TextRange place) const {
  return {Link{graph_.nodes[node].shown, {}, place, node}, place};
}

ExpressionParser::Operand ExpressionParser::pass_through(Value value, std::string_view shown, TextRange place) {
  const uint32_t node = add("constant", Node::Origin::operation, shown, place);
  add_port(node, "value", "the value", {std::move(value), place});
  return link_to(node, place);
}

ExpressionParser::Operand ExpressionParser::operation(std::string_view row, const Token& sign, TextRange place,
                                                      std::vector<Part> parts) {
  const uint32_t node = add(row, Node::Origin::call, row == "?:" ? row : sign.text, place_of(sign));
  for (size_t i = 0; i < parts.size(); ++i)
    add_port(node, std::to_string(i + 1), parts[i].shown, std::move(parts[i].operand));
  return link_to(node, place);
}

ExpressionParser::Operand ExpressionParser::type_call(const Token& name, Type type,
                                                      std::vector<Operand> arguments, TextRange place) {
  const std::string type_text(name.text);
  const int count = float_count(type);
  const bool tuple = count >= 2 && count <= 4;
  const bool matrix = type == Type::matrix33 || type == Type::matrix44;
  if (!tuple && !matrix && type != Type::floating && type != Type::integer && type != Type::boolean)
    return fail(place_of(name), "an expression cannot construct a " + type_text, "add a port for it");
  if (matrix) {
    const size_t columns = type == Type::matrix33 ? 3 : 4;
    if (arguments.size() != columns)
      return fail(place_of(name), type_text + " takes " + std::to_string(columns) + " arguments, its columns, not " +
                                      std::to_string(arguments.size()));
    return construct("creatematrix", name, std::move(arguments));
  }
  if (arguments.size() == 1) {
    const uint32_t node = add("convert", Node::Origin::operation, name.text, place_of(name));
    add_port(node, "in", "the argument", std::move(arguments[0]));
    add_port(node, "to", "the type", {string_literal(name.text), place_of(name)});
    return link_to(node, place);
  }
  // Two arguments: two numbers, or all components but the last one, and the last one.
  const bool all = tuple && arguments.size() == static_cast<size_t>(count);
  if (all || (tuple && arguments.size() == 2)) {
    const std::string row = "combine" + std::to_string(arguments.size());
    return construct(row, name, std::move(arguments));
  }
  return fail(place_of(name), type_text + " takes 1" +
                                  (count > 2  ? ", 2 or " + std::to_string(count) + " arguments"
                                   : tuple ? " or 2 arguments"
                                           : " argument") +
                                  ", not " + std::to_string(arguments.size()));
}

ExpressionParser::Operand ExpressionParser::construct(std::string_view row, const Token& name,
                                                    std::vector<Operand> arguments) {
  const TextRange place = since(place_of(name));
  const uint32_t node = add(row, Node::Origin::operation, name.text, place_of(name));
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string position = std::to_string(i + 1);
    add_port(node, "in" + position, "argument " + position, std::move(arguments[i]));
  }
  add_port(node, "to", "the type", {string_literal(name.text), place_of(name)});
  return link_to(node, place);
}

void ExpressionParser::become_root(Operand result) {
  auto* link = std::get_if<Link>(&result.value);
  const auto last = static_cast<uint32_t>(graph_.nodes.size() - 1);
  if (link == nullptr || link->node != last || !link->selectors.empty() || last == root_) {
    result = pass_through(std::move(result.value), code_.text(), result.place);
    return become_root(std::move(result));
  }
  // The last operation was appended last.
  Node& root = graph_.nodes[root_];
  Node& made = graph_.nodes[last];
  root.type = std::move(made.type);
  root.shown = std::move(made.shown);
  root.origin = made.origin;
  root.type_place = made.type_place;
  root.ports = std::move(made.ports);
  graph_.nodes.pop_back();
}

}  // namespace isoshade::graph
