// SPDX-License-Identifier: Apache-2.0
// The results of the stages as text, for --dump-after and for tests.
#pragma once

#include <string>

#include "compiler/check/typed_graph.h"
#include "compiler/graph/document.h"
#include "compiler/ir/module.h"

namespace isoshade::driver {

/// One line per key or element: position, JSON pointer, value.
std::string dump_document(const graph::Document& document);
/// One line per node, with its ports as written.
std::string dump_graph(const graph::Graph& graph);
/// One line per node in topological order, with resolved operands and types.
std::string dump_typed(const check::TypedGraph& graph);
/// Text IR.
std::string dump_module(const ir::Module& module);

}  // namespace isoshade::driver
