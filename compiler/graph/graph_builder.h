// SPDX-License-Identifier: Apache-2.0
// The builder of build_graph: one class, whose methods stand in graph_build*.cpp.
#pragma once

#include <optional>
#include <string_view>

#include "compiler/graph/graph.h"
#include "compiler/graph/reader.h"

namespace isoshade::graph {

inline TextRange place_of(const Json& json) { return {json.begin, json.end}; }
inline TextRange key_place(const Member& member) { return {member.key_begin, member.key_end}; }

class GraphBuilder {
 public:
  GraphBuilder(const Document& document, support::Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {
    graph_.source = document.source;
  }

  std::optional<Graph> build(DocumentKind kind);

 private:
  void check_id(std::string_view id, TextRange place, std::string_view what);
  /// Enters an input or a node under its name.
  void enter(const Member& member, std::string_view what, Graph::Name name);

  std::optional<Link> link(const Json& json, std::string_view key);
  /// A link, or a colour that is written in place.
  std::optional<Link> color(const Json& json);

  void read_inputs(const Json& inputs, bool are_parameters);
  void read_input(const Member& member, bool is_parameter);
  void read_names(const Json& json, Input& input);
  void check_value(const Input& input, const Json& json);
  void read_nodes(const Json& nodes);
  void read_node(const Member& member);
  /// A key that is free, as a port; nothing if what stands in it could not stand in one.
  void read_free_key(const Member& entry, Node& node);
  void read_code(const Member& member, const Json* code);
  void read_outputs(const Json& outputs);
  void read_passes(const Json& passes);
  void read_pass(const Json& json);
  std::optional<uint32_t> switch_of(const Json& json);
  void read_post(ObjectReader& reader);
  void read_images(const Json& images);

  const Document& document_;
  support::Diagnostics& diagnostics_;
  Graph graph_;
};

}  // namespace isoshade::graph
