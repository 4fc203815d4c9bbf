// SPDX-License-Identifier: Apache-2.0
// The code of an expression node, as the nodes that it stands for:
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
// Types are none of its business: what it makes is checked and lowered like nodes that an author wrote.
#pragma once

#include "compiler/graph/graph.h"

namespace isoshade::graph {

inline constexpr std::string_view expression_type = "expression";
inline constexpr std::string_view expression_doc =
    "A formula: its `code` is arithmetic over values that the other keys name.";
/// Limits that keep hostile code harmless: parentheses and signs inside each other, and nodes a document.
inline constexpr int max_expression_depth = 100;
inline constexpr size_t max_expression_nodes = 200'000;

/// Makes graph.nodes[root], the node as it is written, what its code computes last, and appends the rest.
/// `code` is the value of its key. Reports code that is malformed, and warns of ports that it does not read.
void expand_expression(Graph& graph, uint32_t root, const Document& document, const Json& code,
                       support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
