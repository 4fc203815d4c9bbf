// SPDX-License-Identifier: Apache-2.0
// The parser of expressions: expression.cpp parses, expression_nodes.cpp creates the nodes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "compiler/graph/code_text.h"
#include "compiler/graph/expression.h"

namespace isoshade::graph {

class ExpressionParser {
 public:
  ExpressionParser(Graph& graph, uint32_t root, const CodeText& code, support::Diagnostics& diagnostics)
      : graph_(graph), root_(root), code_(code), diagnostics_(diagnostics), id_(graph.nodes[root].id) {
    made_.root = root;
    made_.first = made_.end = static_cast<uint32_t>(graph.nodes.size());
    made_.code = code.text();
    made_.ports = std::move(graph.nodes[root].ports);
    used_.resize(made_.ports.size());
    pass_through_.resize(made_.ports.size(), Link::unresolved);
    token_ = code_.next(0);
  }

  void parse();

 private:
  using Token = CodeText::Token;
  using Value = std::variant<Literal, Link>;
  struct Operand {
    Value value = Literal{};
    TextRange place;
  };

  Operand choice();
  Operand binary(int precedence);
  Operand unary();
  Operand postfix();
  Operand primary();
  Operand number();
  Operand port_or_constant(const Token& name);
  Operand call(const Token& name);
  Operand type_call(const Token& name, Type type, std::vector<Operand> arguments, TextRange place);

  /// A node of `row` with the arguments as in1, in2, ... and the type `name` as "to".
  Operand construct(std::string_view row, const Token& name, std::vector<Operand> arguments);

  /// Appends a node; `shown` is its name in messages.
  uint32_t add(std::string_view type, Node::Origin origin, std::string_view shown, TextRange place);
  void add_port(uint32_t node, std::string_view port, std::string_view shown, Operand operand);
  /// Appends the node of an operator.
  struct Part {
    std::string_view shown;  ///< name of the operand in messages
    Operand operand;
  };
  Operand operation(std::string_view row, const Token& sign, TextRange place, std::vector<Part> parts);
  /// A `constant` node that passes a value through, so that links can refer to it.
  Operand pass_through(Value value, std::string_view shown, TextRange place);
  Operand link_to(uint32_t node, TextRange place) const;
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
  /// A suggestion if the current token is an operator of other languages, such as "%".
  std::string_view foreign_operator_fix() const;
  /// Reports only the first error: later ones would be consequences of it.
  Operand fail(TextRange place, std::string message, std::string_view fix = {});
  bool too_deep();
  TextRange place_of(const Token& token) const { return code_.place(token.begin, token.end); }
  TextRange since(TextRange first) const {
    return {first.begin, code_.place(last_end_, last_end_).begin, first.source};
  }

  Graph& graph_;
  uint32_t root_;
  const CodeText& code_;
  support::Diagnostics& diagnostics_;
  std::string id_;
  Expression made_;
  std::vector<bool> used_;              ///< by port
  std::vector<uint32_t> pass_through_;  ///< by port: its pass-through node, or unresolved
  Token token_;
  uint32_t last_end_ = 0;
  int depth_ = 0;
  bool failed_ = false;
};

}  // namespace isoshade::graph
