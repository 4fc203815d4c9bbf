// SPDX-License-Identifier: Apache-2.0
// The class behind build_graph; graph_build*.cpp define its methods.
#pragma once

#include <optional>
#include <string_view>

#include "compiler/graph/graph.h"
#include "compiler/graph/reader.h"

namespace isoshade::graph {

inline TextRange place_of(const Json& json) { return {json.begin, json.end, json.source}; }
inline TextRange key_place(const Member& member) {
  return {member.key_begin, member.key_end, member.value.source};
}

class GraphBuilder {
 public:
  GraphBuilder(const Document& document, support::Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {
    graph_.source = document.source;
    graph_.bases = document.others;
  }

  std::optional<Graph> build(DocumentKind kind);

 private:
  void check_id(std::string_view id, TextRange place, std::string_view what);
  /// Adds an input or a node to the namespace.
  void enter(const Member& member, std::string_view what, Graph::Name name);

  std::optional<Link> link(const Json& json, std::string_view key);
  /// A link or a literal colour.
  std::optional<Link> color(const Json& json);
  /// Adds a node for a literal that stands where a link may stand.
  Link constant(Literal value, std::string_view key, Type type, TextRange place);

  void read_inputs(const Json& inputs, bool are_parameters);
  void read_input(const Member& member, bool is_parameter);
  void read_names(const Json& json, Input& input);
  void check_value(const Input& input, const Json& json);
  void read_nodes(const Json& nodes);
  void read_node(const Member& member);
  /// Adds "doc" or "extras" to Node::free_keys if its value can be a port.
  void read_free_key(const Member& entry, Node& node);
  void read_code(const Member& member, const Json* code);
  void read_outputs(const Json& outputs);
  void read_passes(const Json& passes);
  void read_pass(const Json& json);
  /// How often a pass is drawn.
  void read_repeat(const Json& json, Pass& pass);
  /// Where a pass is drawn: "cutout" and "cutoff".
  void read_cutout(ObjectReader& reader, Pass& pass);
  /// The parameter that a key of a pass or post names ("enabled"), which is switched on where it is not 0.
  std::optional<uint32_t> read_switch(const Json& json, std::string_view key);
  void read_post(ObjectReader& reader);
  void read_images(const Json& images);

  const Document& document_;
  support::Diagnostics& diagnostics_;
  Graph graph_;
};

}  // namespace isoshade::graph
