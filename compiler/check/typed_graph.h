// SPDX-License-Identifier: Apache-2.0
// A graph in which every link leads somewhere and every type is settled.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compiler/graph/graph.h"
#include "compiler/nodes/row.h"

namespace isoshade::check {

using graph::Type;

/// What a port, or an output of the document, reads.
struct Operand {
  enum class From : uint8_t {
    nothing,
    input,    ///< index: in Graph::inputs
    node,     ///< index: in Graph::nodes
    words,    ///< index: of the first of its words in TypedGraph::words; already of the needed type
    setting,  ///< index: the literal itself: a Type, the number of a choice, a component
    surface,  ///< index: of a nodes::SurfaceValue
    file,     ///< index: in TypedGraph::files
  };
  From from = From::nothing;
  Type type{};    ///< of what is read, after the swizzle
  Type needed{};  ///< the same, or what it is broadcast to
  uint32_t index = 0;
  uint32_t output = 0;  ///< which output of a node
  std::array<uint8_t, 4> swizzle{};
  uint8_t swizzle_count = 0;  ///< 0: the whole value
};

/// A path written in a port: relative to the document; empty: no file.
struct File {
  std::string path;
  graph::TextRange place;
};

struct TypedGraph;

struct Node {
  const nodes::Row* row = nullptr;           ///< of the node table, or null where
  std::shared_ptr<const TypedGraph> callee;  ///< it is a function document
  uint32_t first_operand = 0;                ///< one a port of the row, or an input of the callee, in order
  uint32_t operand_count = 0;
  uint32_t first_type = 0;  ///< of its outputs, in TypedGraph::types
  uint32_t output_count = 0;
  bool per_turn = false;  ///< depends on the light or the tap, and is no sum over them
};

struct TypedGraph {
  graph::Graph graph;
  /// How emitted text and reports name it: the path as the user gave it, or "library/brdf/ggx_d.json".
  std::string document;
  std::vector<Node> nodes;        ///< those of Graph::nodes
  std::vector<uint32_t> order;    ///< all nodes; each after those that it reads, else as written
  std::vector<Operand> operands;  ///< of all nodes
  std::vector<Type> types;        ///< of all nodes' outputs
  std::vector<uint32_t> words;    ///< of literals: bits of floats, booleans, integers
  std::vector<File> files;        ///< that ports name
  /// Of a function's Graph::outputs; or the color of each pass, and then the position of each that has one.
  std::vector<Operand> outputs;
  uint64_t expanded_nodes = 0;  ///< with those of called functions, once for each call

  std::span<const Operand> operands_of(const Node& node) const {
    return {operands.data() + node.first_operand, node.operand_count};
  }
  /// Those that a function gives, or that pixels are made of: without the positions of passes.
  std::span<const Operand> values() const {
    return std::span(outputs).first(graph.passes.empty() ? outputs.size() : graph.passes.size());
  }
  /// Where a pass moves vertices to; null if it leaves them where they are.
  const Operand* position_of(size_t pass) const {
    if (!graph.passes[pass].position) return nullptr;
    size_t index = graph.passes.size();
    for (size_t i = 0; i < pass; ++i) index += graph.passes[i].position ? 1 : 0;
    return &outputs[index];
  }
  std::span<const Type> types_of(const Node& node) const {
    return {types.data() + node.first_type, node.output_count};
  }
};

}  // namespace isoshade::check
