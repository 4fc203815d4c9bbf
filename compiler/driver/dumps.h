// SPDX-License-Identifier: Apache-2.0
// What the stages made, as text for --dump-after: for people, and for tests of a stage.
#pragma once

#include <string>

#include "compiler/check/typed_graph.h"
#include "compiler/graph/document.h"
#include "compiler/ir/module.h"

namespace isoshade::driver {

/// A line a key or element: its place, its JSON pointer, its value.
std::string dump_document(const graph::Document& document);
/// A line a node with its ports as written.
std::string dump_graph(const graph::Graph& graph);
/// A line a node, each after those it reads, with settled operands and types.
std::string dump_typed(const check::TypedGraph& graph);
/// Text IR.
std::string dump_module(const ir::Module& module);

}  // namespace isoshade::driver
