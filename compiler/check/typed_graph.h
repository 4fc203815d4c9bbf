// SPDX-License-Identifier: Apache-2.0
// A graph with all links resolved and all types inferred.
#pragma once

#include <algorithm>
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

/// The value that a port, or an output of the document, reads.
struct Operand {
  enum class From : uint8_t {
    nothing,
    input,    ///< index: in Graph::inputs
    node,     ///< index: in Graph::nodes
    words,    ///< a literal, converted to `needed`; index: its first word in TypedGraph::words
    setting,  ///< index: the value itself: a Type, a choice, a component
    surface,  ///< index: of the alternative of nodes::SurfaceValue
    file,     ///< index: in TypedGraph::files
  };
  From from = From::nothing;
  Type type{};    ///< after the swizzle
  Type needed{};  ///< the type after implicit conversion
  uint32_t index = 0;
  uint32_t output = 0;  ///< which output of a node
  std::array<uint8_t, 4> swizzle{};
  uint8_t swizzle_count = 0;  ///< 0: the whole value
};

/// A path in a port, or the default of a function's input; empty for no file.
struct File {
  std::string path;     ///< relative to the document in which it is written
  support::Span place;  ///< where that is
};

/// What a document can need of the stage that evaluates it, besides the values of its inputs.
enum class StageNeed : uint8_t {
  surface,      ///< attributes of the surface point, or matrices between spaces
  vertex,       ///< attributes that only vertices have
  pixel,        ///< attributes that only pixels have
  images,       ///< textures
  lights,       ///< the lights of the scene
  derivatives,  ///< changes from pixel to pixel
  repetition,   ///< the number of a repetition of a pass
  // What posts have, too.
  environment,  ///< the environment of the scene
  time
};
inline constexpr size_t stage_need_count = static_cast<size_t>(StageNeed::time) + 1;
/// Whether posts have what is needed.
constexpr bool posts_have(StageNeed need) { return need >= StageNeed::environment; }
inline constexpr uint32_t no_node = ~0u;

struct TypedGraph;

struct Node {
  const nodes::Row* row = nullptr;           ///< row of the node table; null for a function document
  std::shared_ptr<const TypedGraph> callee;  ///< the function document; null for a row
  uint32_t first_operand = 0;                ///< in TypedGraph::operands: one per port or input
  uint32_t operand_count = 0;
  uint32_t first_type = 0;  ///< in TypedGraph::types: one per output
  uint32_t output_count = 0;
  bool per_iteration = false;  ///< depends on the light or tap of the enclosing sum
};

struct TypedGraph {
  graph::Graph graph;
  /// Its name in emitted text and reports: the path as the user gave it, or "library/brdf/ggx_d.json".
  std::string document;
  std::vector<Node> nodes;        ///< parallel to Graph::nodes
  std::vector<uint32_t> order;    ///< all nodes in topological order, otherwise in document order
  std::vector<Operand> operands;  ///< of all nodes
  std::vector<Type> types;        ///< of the outputs of all nodes
  std::vector<uint32_t> words;    ///< bits of literals: floats, booleans, integers
  std::vector<File> files;        ///< named in ports
  /// One per Graph::outputs of a function or post; for an effect, the color of each pass, then the position of each
  /// pass that has one, then the cutout and the cutoff (nothing if the cutout is a boolean) of each pass that has them.
  std::vector<Operand> outputs;
  uint64_t expanded_nodes = 0;  ///< the number of nodes with all calls and sums expanded
  /// By StageNeed: the first node that an output depends on and that needs it, by itself or because it calls a function
  /// that does; or no_node.
  std::array<uint32_t, stage_need_count> needed_by = filled_with_no_node();
  int derivative_order = 0;  ///< of how many derivatives, each taken of the other, its outputs are
  std::vector<int> differentiated_inputs = {};  ///< by Graph::inputs: how often it takes the derivative of each

  std::span<const Operand> operands_of(const Node& node) const {
    return {operands.data() + node.first_operand, node.operand_count};
  }
  /// The outputs of a function or post, or the colors of passes.
  std::span<const Operand> values() const {
    return std::span(outputs).first(graph.passes.empty() ? outputs.size() : graph.passes.size());
  }
  std::span<const Operand> positions() const {
    const std::span<const Operand> rest = std::span(outputs).subspan(values().size());
    return rest.first(static_cast<size_t>(
        std::ranges::count_if(graph.passes, [](const graph::Pass& pass) { return pass.position.has_value(); })));
  }
  std::span<const Operand> cutouts() const {
    return std::span(outputs).subspan(values().size() + positions().size());
  }
  /// The vertex position of a pass; null if it keeps the position of the mesh.
  const Operand* position_of(size_t pass) const {
    if (!graph.passes[pass].position) return nullptr;
    size_t index = graph.passes.size();
    for (size_t i = 0; i < pass; ++i) index += graph.passes[i].position ? 1 : 0;
    return &outputs[index];
  }
  /// Where a pass is drawn: a boolean, or a float and its cutoff; empty if it is drawn everywhere.
  std::span<const Operand> cutout_of(size_t pass) const {
    if (!graph.passes[pass].cutout) return {};
    size_t index = 0;
    for (size_t i = 0; i < pass; ++i) index += graph.passes[i].cutout ? 2 : 0;
    return cutouts().subspan(index, cutouts()[index + 1].from == Operand::From::nothing ? 1 : 2);
  }
  std::span<const Type> types_of(const Node& node) const {
    return {types.data() + node.first_type, node.output_count};
  }
  bool needs(StageNeed need) const { return needed_by[static_cast<size_t>(need)] != no_node; }

  static constexpr std::array<uint32_t, stage_need_count> filled_with_no_node() {
    std::array<uint32_t, stage_need_count> filled{};
    filled.fill(no_node);
    return filled;
  }
};

/// Whether a node is an image that is trilinear, or that an input can make so.
bool may_be_trilinear(const TypedGraph& graph, const Node& node);
/// Whether a node is an image of which another layer than the first may be read.
bool reads_layers(const TypedGraph& graph, const Node& node);

}  // namespace isoshade::check
