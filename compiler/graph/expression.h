// SPDX-License-Identifier: Apache-2.0
// Expands the code of an expression node into ordinary nodes:
//
//     {"type": "expression", "code": "a*a / (pi * t*t)", "a": "alpha", "t": "slope"}
//
//     choice    comparison chains: any ["?" choice ":" choice]
//     any       all {"||" all}
//     all       equality {"&&" equality}
//     equality  order {("==" | "!=") order}
//     order     sum {("<" | "<=" | ">" | ">=") sum}
//     sum       product {("+" | "-") product}
//     product   unary {("*" | "/") unary}
//     unary     ("-" | "+" | "!") unary | postfix
//     postfix   primary {"." selector}
//     primary   number | "true" | "false" | "pi" | port | name "(" [choice {"," choice}] ")" | "(" choice ")"
//     name      id {"::" id}: a function of the library ("mix"), a type ("color3"), or a function document
//               ("brdf::ggx_d")
//
// It does not know types: the nodes are checked and lowered like nodes that an author wrote.
#pragma once

#include "compiler/graph/graph.h"

namespace isoshade::graph {

inline constexpr std::string_view expression_type = "expression";
inline constexpr std::string_view expression_doc =
    "A formula: `code` is an arithmetic expression over the ports, which are the other keys of the node.";
/// Limits that keep hostile code harmless: nesting depth of an expression, and expanded nodes per document.
inline constexpr int max_expression_depth = 100;
inline constexpr size_t max_expression_nodes = 200'000;

/// Replaces graph.nodes[root], the expression node, by the last operation of its code and appends the other
/// nodes. `code` is the value of the key "code". Reports malformed code, and warns about ports that it does not
/// read.
void expand_expression(Graph& graph, uint32_t root, const Document& document, const Json& code,
                       support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
