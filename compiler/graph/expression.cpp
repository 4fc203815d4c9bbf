// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/expression.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compiler/graph/code_text.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {
namespace {

using support::Id;
using support::quote;
using Value = std::variant<Literal, Link>;
using Token = CodeText::Token;

struct Operand {
  Value value = Literal{};
  Place place;
};

Literal number_literal(float number) {
  Literal literal;
  literal.number = number;
  return literal;
}

Literal boolean_literal(bool value) {
  Literal literal;
  literal.kind = Literal::Kind::boolean;
  literal.boolean = value;
  return literal;
}

Literal string_literal(std::string_view text) {
  Literal literal;
  literal.kind = Literal::Kind::string;
  literal.string = text;
  return literal;
}

/// Components, not the name of an output.
bool is_swizzle(std::string_view selector) {
  return selector.size() <= 4 && selector.find_first_not_of("xyzwrgba") == std::string_view::npos;
}

/// An operator between two operands. What it does stands in the node library, under its own text.
struct Binary {
  std::string_view text;
  int precedence;
};

constexpr Binary binaries[] = {{"||", 1}, {"&&", 2}, {"==", 3}, {"!=", 3}, {"<", 4}, {"<=", 4},
                               {">", 4},  {">=", 4}, {"+", 5},  {"-", 5},  {"*", 6}, {"/", 6}};

class ExpressionParser {
 public:
  ExpressionParser(Graph& graph, uint32_t root, const CodeText& code, support::Diagnostics& diagnostics)
      : graph_(graph), root_(root), code_(code), diagnostics_(diagnostics), id_(graph.nodes[root].id) {
    made_.root = root;
    made_.first = made_.end = static_cast<uint32_t>(graph.nodes.size());
    made_.code = code.text();
    made_.ports = std::move(graph.nodes[root].ports);
    used_.resize(made_.ports.size());
    handed_on_.resize(made_.ports.size(), Link::unresolved);
    token_ = code_.next(0);
  }

  void parse();

 private:
  Operand choice();
  Operand binary(int precedence);
  Operand unary();
  Operand postfix();
  Operand primary();
  Operand number();
  Operand port_or_constant(const Token& name);
  Operand call(const Token& name);
  Operand type_call(const Token& name, Type type, std::vector<Operand> arguments, Place place);

  /// Appends a node; `shown` is what stands for it in the code.
  uint32_t add(std::string_view type, Node::Origin origin, std::string_view shown, Place place);
  void give(uint32_t node, std::string_view port, std::string_view shown, Operand operand);
  /// An operator's node; `shown` has what its operands are called.
  struct Part {
    std::string_view shown;
    Operand operand;
  };
  Operand operation(std::string_view row, const Token& sign, Place place, std::vector<Part> parts);
  /// A node that hands on a value, so that it can be linked to.
  Operand handed_on(Value value, std::string_view shown, Place place);
  Operand link_to(uint32_t node, Place place) const;
  void become_root(Operand result);

  bool is(std::string_view symbol) const {
    return token_.kind == CodeText::Kind::symbol && token_.text == symbol;
  }
  Token advance() {
    last_end_ = token_.end;
    return std::exchange(token_, code_.next(token_.end));
  }
  bool take(std::string_view symbol) {
    if (!is(symbol)) return false;
    advance();
    return true;
  }
  void expect(std::string_view symbol, std::string_view why);
  /// What to write for a sign of other languages that stands here.
  std::string_view way_out() const;
  /// Reports the first error only: what follows is read in a wrong light.
  Operand fail(Place place, std::string message, std::string_view fix = {});
  bool too_deep();
  Place place_of(const Token& token) const { return code_.place(token.begin, token.end); }
  Place since(Place first) const { return {first.begin, code_.place(last_end_, last_end_).begin}; }

  Graph& graph_;
  uint32_t root_;
  const CodeText& code_;
  support::Diagnostics& diagnostics_;
  std::string id_;
  Expression made_;
  std::vector<bool> used_;           ///< of the ports
  std::vector<uint32_t> handed_on_;  ///< the node that hands on a port
  Token token_;
  uint32_t last_end_ = 0;
  int depth_ = 0;
  bool failed_ = false;
};

Operand ExpressionParser::fail(Place place, std::string message, std::string_view fix) {
  if (!failed_) {
    support::Diagnostic& report =
        diagnostics_.report(Id::bad_expression, graph_.span(place), std::move(message));
    if (!fix.empty()) report.suggest(std::string(fix));
  }
  failed_ = true;
  const auto end = static_cast<uint32_t>(code_.text().size());
  token_ = {CodeText::Kind::end, {}, end, end};
  return {};
}

std::string_view ExpressionParser::way_out() const {
  if (token_.text == "%") return "write mod(x, y)";
  if (token_.text == "^") return "write pow(x, y)";
  if (token_.text == "=") return "compare with ==";
  return {};
}

void ExpressionParser::expect(std::string_view symbol, std::string_view why) {
  if (take(symbol)) return;
  const std::string found =
      token_.kind == CodeText::Kind::end ? "the code ends" : quote(token_.text) + " stands";
  fail(place_of(token_), found + " where " + quote(symbol) + " " + std::string(why) + " is needed",
       way_out());
}

bool ExpressionParser::too_deep() {
  if (depth_ <= max_expression_depth) return false;
  fail(place_of(token_), "expressions are nested at most " + std::to_string(max_expression_depth) + " deep",
       "make a part of it a node of its own");
  return true;
}

uint32_t ExpressionParser::add(std::string_view type, Node::Origin origin, std::string_view shown,
                               Place place) {
  if (graph_.expression_nodes == max_expression_nodes && !failed_) {
    diagnostics_.report(Id::too_large, graph_.span(place),
                        "the expressions of a document are more than " +
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

void ExpressionParser::give(uint32_t node, std::string_view port, std::string_view shown, Operand operand) {
  if (failed_) return;
  graph_.nodes[node].ports.push_back(
      {std::string(port), std::move(operand.value), operand.place, operand.place, std::string(shown)});
}

Operand ExpressionParser::link_to(uint32_t node, Place place) const {
  return {Link{graph_.nodes[node].shown, {}, place, node}, place};
}

Operand ExpressionParser::handed_on(Value value, std::string_view shown, Place place) {
  const uint32_t node = add("constant", Node::Origin::operation, shown, place);
  give(node, "value", "the value", {std::move(value), place});
  return link_to(node, place);
}

Operand ExpressionParser::operation(std::string_view row, const Token& sign, Place place,
                                    std::vector<Part> parts) {
  const uint32_t node = add(row, Node::Origin::call, row == "?:" ? row : sign.text, place_of(sign));
  for (size_t i = 0; i < parts.size(); ++i)
    give(node, std::to_string(i + 1), parts[i].shown, std::move(parts[i].operand));
  return link_to(node, place);
}

Operand ExpressionParser::choice() {
  ++depth_;
  Operand condition = too_deep() ? Operand{} : binary(1);
  if (is("?")) {
    const Token sign = advance();
    Operand then = choice();
    expect(":", "between the two results of \"?\"");
    Operand other = choice();
    const Place place{condition.place.begin, other.place.end};
    condition = operation("?:", sign, place,
                          {{"the condition", std::move(condition)},
                           {"the first result", std::move(then)},
                           {"the second result", std::move(other)}});
  }
  --depth_;
  return condition;
}

Operand ExpressionParser::binary(int precedence) {
  Operand left = unary();
  while (token_.kind == CodeText::Kind::symbol) {
    const auto* row = std::ranges::find(binaries, token_.text, &Binary::text);
    if (row == std::end(binaries) || row->precedence < precedence) break;
    const Token sign = advance();
    Operand right = binary(row->precedence + 1);
    const Place place{left.place.begin, right.place.end};
    left = operation(row->text, sign, place,
                     {{"the left side", std::move(left)}, {"the right side", std::move(right)}});
  }
  return left;
}

Operand ExpressionParser::unary() {
  if (!is("-") && !is("+") && !is("!")) return postfix();
  ++depth_;
  const Token sign = advance();
  Operand operand = too_deep() ? Operand{} : unary();
  --depth_;
  const Place place{place_of(sign).begin, operand.place.end};
  if (sign.text == "+") return operand;
  if (sign.text == "!") return operation("!", sign, place, {{"the operand", std::move(operand)}});
  auto* literal = std::get_if<Literal>(&operand.value);
  if (literal != nullptr && literal->kind == Literal::Kind::number) {
    literal->number = -literal->number;
    literal->integer = -literal->integer;
    return {std::move(operand.value), place};
  }
  return operation("negate", sign, place, {{"the operand", std::move(operand)}});
}

Operand ExpressionParser::postfix() {
  Operand operand = primary();
  const int depth = depth_;
  while (is(".")) {
    advance();
    if (token_.kind != CodeText::Kind::name)
      return fail(place_of(token_), "components or the name of an output stand after \".\"");
    const std::string selector(advance().text);
    auto* link = std::get_if<Link>(&operand.value);
    if (link == nullptr || link->selectors.size() == 2 ||
        (link->selectors.size() == 1 && is_swizzle(link->selectors[0]))) {
      ++depth_;
      if (too_deep()) break;
      // Messages show no more of it, and each of very many nodes keeps a copy.
      operand = handed_on(std::move(operand.value), code_.text().substr(0, 100), operand.place);
      link = &std::get<Link>(operand.value);
    }
    link->selectors.push_back(selector);
    link->place = operand.place = since(operand.place);
  }
  depth_ = depth;
  return operand;
}

Operand ExpressionParser::primary() {
  const Place start = place_of(token_);
  switch (token_.kind) {
    case CodeText::Kind::number: return number();
    case CodeText::Kind::name: {
      const Token name = advance();
      return is("(") ? call(name) : port_or_constant(name);
    }
    case CodeText::Kind::symbol:
      if (take("(")) {
        Operand inner = choice();
        expect(")", "after the parenthesis");
        inner.place = since(start);
        return inner;
      }
      return fail(start, "a value is needed before " + quote(token_.text));
    case CodeText::Kind::end:
      return fail(start,
                  code_.text().empty() ? "the code is empty" : "the code ends where a value is needed");
    case CodeText::Kind::unknown: break;
  }
  return fail(start, quote(token_.text) + " means nothing in an expression");
}

Operand ExpressionParser::number() {
  const Token token = advance();
  const std::optional<float> number = support::parse_float(token.text);
  if (!number || !std::isfinite(*number))
    return fail(place_of(token), quote(token.text) + " is beyond the range of float");
  Literal literal = number_literal(*number);
  constexpr size_t most_digits = 9;
  literal.integral =
      token.text.size() <= most_digits && token.text.find_first_of(".eE") == std::string_view::npos;
  if (literal.integral) literal.integer = std::stoll(std::string(token.text));
  return {std::move(literal), place_of(token)};
}

Operand ExpressionParser::port_or_constant(const Token& name) {
  const Place place = place_of(name);
  if (name.text == "true" || name.text == "false") return {boolean_literal(name.text == "true"), place};
  const auto found = std::ranges::find(made_.ports, name.text, &Port::name);
  if (found == made_.ports.end()) {
    if (name.text == "pi") return {number_literal(3.14159265f), place};
    if (failed_) return {};
    std::vector<std::string_view> names;
    for (const Port& port : made_.ports) names.push_back(port.name);
    diagnostics_
        .report_unknown(Id::unknown_port, graph_.span(place),
                        "the expression has no port " + quote(name.text), name.text, names)
        .note("a name in the code is a key of the node: \"" + std::string(name.text.substr(0, 40)) +
              "\": \"node.port\"");
    failed_ = true;
    return fail(place, {});
  }
  const auto index = static_cast<size_t>(found - made_.ports.begin());
  used_[index] = true;
  // A number fits any type where it is read; a link is resolved once, at the port.
  const auto* literal = std::get_if<Literal>(&found->value);
  if (literal != nullptr && literal->kind != Literal::Kind::string && !is(".")) return {found->value, place};
  if (handed_on_[index] == Link::unresolved) {
    const Operand at_port = handed_on(found->value, found->name, found->place);
    handed_on_[index] = std::get<Link>(at_port.value).node;
  }
  return link_to(handed_on_[index], place);
}

Operand ExpressionParser::call(const Token& name) {
  ++depth_;
  advance();
  std::vector<Operand> arguments;
  if (!is(")")) {
    do arguments.push_back(choice());
    while (take(","));
  }
  expect(")", "after the arguments");
  --depth_;
  const Place place = since(place_of(name));
  if (const std::optional<Type> type = find_type(name.text))
    return type_call(name, *type, std::move(arguments), place);
  std::string reference;
  for (size_t i = 0; i < name.text.size(); ++i) {
    reference += name.text[i] == ':' ? '/' : name.text[i];
    if (name.text[i] == ':') ++i;
  }
  const uint32_t node = add(reference, Node::Origin::call, name.text, place_of(name));
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string position = std::to_string(i + 1);
    give(node, position, "argument " + position, std::move(arguments[i]));
  }
  return link_to(node, place);
}

Operand ExpressionParser::type_call(const Token& name, Type type, std::vector<Operand> arguments,
                                    Place place) {
  const std::string type_text(name.text);
  const int count = float_count(type);
  const bool tuple = count >= 2 && count <= 4;
  if (!tuple && type != Type::floating && type != Type::integer && type != Type::boolean)
    return fail(place_of(name), "an expression makes no " + type_text,
                "make it by a node and give the expression a port for it");
  if (arguments.size() == 1) {
    const uint32_t node = add("convert", Node::Origin::operation, name.text, place_of(name));
    give(node, "in", "the argument", std::move(arguments[0]));
    give(node, "to", "the type", {string_literal(name.text), place_of(name)});
    return link_to(node, place);
  }
  if (!tuple || arguments.size() != static_cast<size_t>(count))
    return fail(place_of(name), type_text + " takes 1 " +
                                    (tuple ? "or " + std::to_string(count) + " arguments" : "argument") +
                                    ", not " + std::to_string(arguments.size()));
  const uint32_t node =
      add("combine" + std::to_string(count), Node::Origin::operation, name.text, place_of(name));
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string position = std::to_string(i + 1);
    give(node, "in" + position, "argument " + position, std::move(arguments[i]));
  }
  if (count > 2) give(node, "to", "the type", {string_literal(name.text), place_of(name)});
  return link_to(node, place);
}

void ExpressionParser::become_root(Operand result) {
  auto* link = std::get_if<Link>(&result.value);
  const auto last = static_cast<uint32_t>(graph_.nodes.size() - 1);
  if (link == nullptr || link->node != last || !link->selectors.empty() || last == root_) {
    result = handed_on(std::move(result.value), code_.text(), result.place);
    return become_root(std::move(result));
  }
  // What is computed last was appended last.
  Node& root = graph_.nodes[root_];
  Node& made = graph_.nodes[last];
  root.type = std::move(made.type);
  root.shown = std::move(made.shown);
  root.origin = made.origin;
  root.type_place = made.type_place;
  root.ports = std::move(made.ports);
  graph_.nodes.pop_back();
}

void ExpressionParser::parse() {
  Operand result = choice();
  if (!failed_ && token_.kind != CodeText::Kind::end)
    fail(place_of(token_), "an operator is needed before " + quote(token_.text), way_out());
  for (size_t i = 0; i < used_.size() && !failed_; ++i) {
    if (used_[i]) continue;
    diagnostics_
        .report(Id::unknown_port, graph_.span(made_.ports[i].name_place),
                "the code does not read " + quote(made_.ports[i].name))
        .suggest("use it in the code, or remove it");
  }
  if (failed_) return;
  become_root(std::move(result));
  made_.end = static_cast<uint32_t>(graph_.nodes.size());
  graph_.expressions.push_back(std::move(made_));
}

}  // namespace

void expand_expression(Graph& graph, uint32_t root, const Document& document, const Json& code,
                       support::Diagnostics& diagnostics) {
  const CodeText text(document, code);
  ExpressionParser(graph, root, text, diagnostics).parse();
}

}  // namespace isoshade::graph
