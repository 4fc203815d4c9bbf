// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/expression.h"

#include <algorithm>
#include <cmath>

#include "compiler/graph/expression_parser.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;

namespace {

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

/// Whether a selector is a swizzle and not the name of an output.
bool is_swizzle(std::string_view selector) {
  return selector.size() <= 4 && selector.find_first_not_of("xyzwrgba") == std::string_view::npos;
}

/// A binary operator. The node library has a row of the same name, which defines it.
struct Binary {
  std::string_view text;
  int precedence;
};

constexpr Binary binaries[] = {{"||", 1}, {"&&", 2}, {"==", 3}, {"!=", 3}, {"<", 4}, {"<=", 4},
                               {">", 4},  {">=", 4}, {"+", 5},  {"-", 5},  {"*", 6}, {"/", 6}};

}  // namespace

ExpressionParser::Operand ExpressionParser::fail(TextRange place, std::string message, std::string_view fix) {
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

std::string_view ExpressionParser::foreign_operator_fix() const {
  if (token_.text == "%") return "write mod(x, y)";
  if (token_.text == "^") return "write pow(x, y)";
  if (token_.text == "=") return "compare with ==";
  return {};
}

void ExpressionParser::expect(std::string_view symbol, std::string_view why) {
  if (take(symbol)) return;
  const std::string found =
      token_.kind == CodeText::Kind::end ? "the end of the code" : std::string(quote(token_.text));
  fail(place_of(token_), "expected " + quote(symbol) + " " + std::string(why) + ", but found " + found,
       foreign_operator_fix());
}

bool ExpressionParser::too_deep() {
  if (depth_ <= max_expression_depth) return false;
  fail(place_of(token_), "the expression is nested more than " + std::to_string(max_expression_depth) + " deep",
       "move a part of it to another node");
  return true;
}

ExpressionParser::Operand ExpressionParser::choice() {
  ++depth_;
  Operand condition = too_deep() ? Operand{} : binary(1);
  if (is("?")) {
    const Token sign = advance();
    Operand then = choice();
    expect(":", "between the two results of \"?\"");
    Operand other = choice();
    const TextRange place{condition.place.begin, other.place.end, other.place.source};
    condition = operation("?:", sign, place,
                          {{"the condition", std::move(condition)},
                           {"the first result", std::move(then)},
                           {"the second result", std::move(other)}});
  }
  --depth_;
  return condition;
}

ExpressionParser::Operand ExpressionParser::binary(int precedence) {
  Operand left = unary();
  while (token_.kind == CodeText::Kind::symbol) {
    const auto* row = std::ranges::find(binaries, token_.text, &Binary::text);
    if (row == std::end(binaries) || row->precedence < precedence) break;
    const Token sign = advance();
    Operand right = binary(row->precedence + 1);
    const TextRange place{left.place.begin, right.place.end, right.place.source};
    left = operation(row->text, sign, place,
                     {{"the left side", std::move(left)}, {"the right side", std::move(right)}});
  }
  return left;
}

ExpressionParser::Operand ExpressionParser::unary() {
  if (!is("-") && !is("+") && !is("!")) return postfix();
  ++depth_;
  const Token sign = advance();
  Operand operand = too_deep() ? Operand{} : unary();
  --depth_;
  const TextRange place{place_of(sign).begin, operand.place.end, operand.place.source};
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

ExpressionParser::Operand ExpressionParser::postfix() {
  Operand operand = primary();
  const int depth = depth_;
  while (is(".")) {
    advance();
    if (token_.kind != CodeText::Kind::name)
      return fail(place_of(token_), "expected a swizzle or the name of an output after \".\"");
    const std::string selector(advance().text);
    auto* link = std::get_if<Link>(&operand.value);
    if (link == nullptr || link->selectors.size() == 2 ||
        (link->selectors.size() == 1 && is_swizzle(link->selectors[0]))) {
      ++depth_;
      if (too_deep()) break;
      // Messages show no more, and each of possibly many nodes keeps a copy.
      operand = pass_through(std::move(operand.value), code_.text().substr(0, 100), operand.place);
      link = &std::get<Link>(operand.value);
    }
    link->selectors.push_back(selector);
    link->place = operand.place = since(operand.place);
  }
  depth_ = depth;
  return operand;
}

ExpressionParser::Operand ExpressionParser::primary() {
  const TextRange start = place_of(token_);
  switch (token_.kind) {
    case CodeText::Kind::number: return number();
    case CodeText::Kind::name: {
      const Token name = advance();
      return is("(") ? call(name) : port_or_constant(name);
    }
    case CodeText::Kind::symbol:
      if (take("(")) {
        Operand inner = choice();
        expect(")", "to close the parenthesis");
        inner.place = since(start);
        return inner;
      }
      return fail(start, "expected a value before " + quote(token_.text));
    case CodeText::Kind::end:
      return fail(start,
                  code_.text().empty() ? "the code is empty" : "expected a value, but the code ends");
    case CodeText::Kind::unknown: break;
  }
  return fail(start, quote(token_.text) + " is not valid in an expression");
}

ExpressionParser::Operand ExpressionParser::number() {
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

ExpressionParser::Operand ExpressionParser::port_or_constant(const Token& name) {
  const TextRange place = place_of(name);
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
        .note("names in the code are keys of the node: \"" + std::string(name.text.substr(0, 40)) +
              "\": \"node.port\"");
    failed_ = true;
    return fail(place, {});
  }
  const auto index = static_cast<size_t>(found - made_.ports.begin());
  used_[index] = true;
  // A number adapts to the type of each use, so it is copied; a link is resolved once, through one node.
  const auto* literal = std::get_if<Literal>(&found->value);
  if (literal != nullptr && literal->kind != Literal::Kind::string && !is(".")) return {found->value, place};
  if (pass_through_[index] == Link::unresolved) {
    const Operand at_port = pass_through(found->value, found->name, found->place);
    pass_through_[index] = std::get<Link>(at_port.value).node;
  }
  return link_to(pass_through_[index], place);
}

ExpressionParser::Operand ExpressionParser::call(const Token& name) {
  ++depth_;
  advance();
  std::vector<Operand> arguments;
  if (!is(")")) {
    do arguments.push_back(choice());
    while (take(","));
  }
  expect(")", "after the arguments");
  --depth_;
  const TextRange place = since(place_of(name));
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
    add_port(node, position, "argument " + position, std::move(arguments[i]));
  }
  return link_to(node, place);
}

void ExpressionParser::parse() {
  Operand result = choice();
  if (!failed_ && token_.kind != CodeText::Kind::end)
    fail(place_of(token_), "expected an operator before " + quote(token_.text), foreign_operator_fix());
  for (size_t i = 0; i < used_.size() && !failed_; ++i) {
    if (used_[i]) continue;
    diagnostics_
        .report(Id::unread_key, graph_.span(made_.ports[i].name_place),
                "the code does not read " + quote(made_.ports[i].name))
        .suggest("use it in the code, or remove it");
  }
  if (failed_) return;
  become_root(std::move(result));
  made_.end = static_cast<uint32_t>(graph_.nodes.size());
  graph_.expressions.push_back(std::move(made_));
}

void expand_expression(Graph& graph, uint32_t root, const Document& document, const Json& code,
                       support::Diagnostics& diagnostics) {
  const CodeText text(document, code);
  ExpressionParser(graph, root, text, diagnostics).parse();
}

}  // namespace isoshade::graph
