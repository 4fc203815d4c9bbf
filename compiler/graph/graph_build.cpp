// SPDX-License-Identifier: Apache-2.0
// Document -> Graph.
#include <utility>

#include "compiler/graph/expression.h"
#include "compiler/graph/extend.h"
#include "compiler/graph/graph_builder.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Diagnostics;
using support::Id;
using support::quote;
using Need = ObjectReader::Need;

void GraphBuilder::check_id(std::string_view id, TextRange place, std::string_view what) {
  if (is_id(id)) return;
  diagnostics_.report(Id::bad_id, graph_.span(place), quote(id) + " is not a valid name of " + std::string(what))
      .note(id.size() > 128 ? "names have at most 128 characters"
                            : "names consist of letters, digits and '_', and do not begin with a digit");
}

void GraphBuilder::enter(const Member& member, std::string_view what, Graph::Name name) {
  check_id(member.key, key_place(member), what);
  if (graph_.names.add(member.key, name)) return;
  // Keys of one object are unique, so a node repeats the name of an input.
  diagnostics_
      .report(Id::duplicate_name, document_.key_span(member),
              std::string(what) + " has the name " + quote(member.key) + " of an input or parameter")
      .note(graph_.span(graph_.inputs[graph_.names.at(member.key).index].name_place), "declared here");
}

std::optional<Link> GraphBuilder::link(const Json& json, std::string_view key) {
  if (json.kind == Json::Kind::string) {
    return parse_link(json.string, place_of(json), document_.span(json), diagnostics_);
  }
  if (json.kind == Json::Kind::object) {
    ObjectReader reader(document_, json, "a link", diagnostics_);
    const Json* target = reader.value("link");
    if (target != nullptr && target->kind != Json::Kind::string)
      reader.report_wrong("link", *target, "a string");
    if (!reader.finish()) return std::nullopt;
    return parse_link(target->string, place_of(*target), document_.span(*target), diagnostics_);
  }
  diagnostics_.report(Id::wrong_type, document_.span(json),
                      quote(key) + " must be a link, not " + std::string(kind_name(json.kind)));
  return std::nullopt;
}

std::optional<Link> GraphBuilder::color(const Json& json) {
  if (json.kind != Json::Kind::number && json.kind != Json::Kind::array) return link(json, "color");
  auto value = parse_literal(document_, json, "color", diagnostics_);
  if (!value) return std::nullopt;
  const size_t count = value->kind == Literal::Kind::numbers ? value->numbers.size() : 3;
  if (count != 3 && count != 4) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        "\"color\" must have 3 or 4 numbers, not " + std::to_string(count));
    return std::nullopt;
  }
  return constant(*std::move(value), "color", count == 3 ? Type::color3 : Type::color4, place_of(json));
}

Link GraphBuilder::constant(Literal value, std::string_view key, Type type, TextRange place) {
  Literal name;
  name.kind = Literal::Kind::string;
  name.string = type_name(type);
  Node node;
  node.id = node.shown = key;
  node.type = "constant";
  node.origin = Node::Origin::operation;
  node.id_place = node.type_place = node.place = place;
  node.ports = {{"value", std::move(value), place, place}, {"to", std::move(name), place, place}};
  graph_.nodes.push_back(std::move(node));
  return Link{std::string(key), {}, place, static_cast<uint32_t>(graph_.nodes.size() - 1)};
}

void GraphBuilder::read_node(const Member& member) {
  const Json& json = member.value;
  if (json.kind != Json::Kind::object) {
    diagnostics_.report(
        Id::wrong_type, document_.span(json),
        "node " + quote(member.key) + " must be an object, not " + std::string(kind_name(json.kind)));
    return;
  }
  Node& node = graph_.nodes.emplace_back();
  node.id = member.key;
  node.id_place = key_place(member);
  node.place = place_of(member.value);
  // Without ObjectReader: all other keys are ports, and the node's type determines which ports exist.
  const Json* type = nullptr;
  const Json* code = nullptr;
  const Json* written_type = json.find("type");
  const bool is_expression = written_type != nullptr && written_type->string == expression_type;
  node.ports.reserve(json.members.size());
  for (const Member& entry : json.members) {
    const Json& value = entry.value;
    if (entry.key == "extras" || entry.key == "doc") read_free_key(entry, node);
    if (entry.key == "extras") continue;
    if (entry.key == "type" || entry.key == "doc") {
      if (value.kind != Json::Kind::string) {
        diagnostics_.report(Id::wrong_type, document_.span(value),
                            quote(entry.key) + " of node " + quote(member.key) + " must be a string, not " +
                                std::string(kind_name(value.kind)));
      }
      (entry.key == "type" ? node.type : node.doc) = value.string;
      if (entry.key == "type") type = &value;
      continue;
    }
    if (is_expression && entry.key == "code") {
      code = &value;
      continue;
    }
    check_id(entry.key, key_place(entry), "a port");
    Port& port = node.ports.emplace_back();
    port.name = entry.key;
    port.name_place = key_place(entry);
    port.place = place_of(value);
    if (value.kind == Json::Kind::object) {
      if (std::optional<Link> found = link(value, entry.key)) port.value = std::move(*found);
    } else if (std::optional<Literal> found = parse_literal(document_, value, entry.key, diagnostics_)) {
      port.value = std::move(*found);
    }
  }
  if (type == nullptr) {
    diagnostics_.report(Id::missing_key, {document_.source_of(json), json.begin, json.begin + 1},
                        "node " + quote(member.key) + " needs the key \"type\"");
  } else {
    node.type_place = place_of(*type);
  }
  if (is_expression) read_code(member, code);
}

void GraphBuilder::read_free_key(const Member& entry, Node& node) {
  Diagnostics unheard;  // any value is allowed
  Port port{entry.key, Literal{}, key_place(entry), place_of(entry.value)};
  const Json* target = entry.value.kind == Json::Kind::object ? entry.value.find("link") : nullptr;
  if (target != nullptr && target->kind == Json::Kind::string) {
    std::optional<Link> link = parse_link(target->string, place_of(*target), document_.span(*target), unheard);
    if (!link) return;
    port.value = std::move(*link);
  } else if (std::optional<Literal> literal = parse_literal(document_, entry.value, entry.key, unheard)) {
    port.value = std::move(*literal);
  } else {
    return;
  }
  node.free_keys.push_back(std::move(port));
}

void GraphBuilder::read_code(const Member& member, const Json* code) {
  if (code == nullptr) {
    diagnostics_
        .report(Id::missing_key, {document_.source_of(member.value), member.value.begin, member.value.begin + 1},
                "expression " + quote(member.key) + " needs the key \"code\"")
        .suggest("write \"code\": \"a * b\", with a and b as further keys");
  } else if (code->kind != Json::Kind::string) {
    diagnostics_.report(
        Id::wrong_type, document_.span(*code),
        "\"code\" of node " + quote(member.key) + " must be a string, not " + std::string(kind_name(code->kind)));
  } else {
    const auto root = static_cast<uint32_t>(graph_.nodes.size() - 1);
    expand_expression(graph_, root, document_, *code, diagnostics_);
  }
}

void GraphBuilder::read_nodes(const Json& nodes) {
  graph_.nodes.reserve(nodes.members.size());
  graph_.names.reserve(graph_.inputs.size() + nodes.members.size());
  for (const Member& member : nodes.members) {
    enter(member, "a node", {false, static_cast<uint32_t>(graph_.nodes.size())});
    read_node(member);
  }
}

void GraphBuilder::read_outputs(const Json& outputs) {
  if (outputs.members.empty()) {
    diagnostics_.report(Id::missing_key, document_.span(outputs), "a document needs at least one output");
  }
  for (const Member& member : outputs.members) {
    check_id(member.key, key_place(member), "an output");
    Output output{member.key, {}, key_place(member)};
    const bool is_color = graph_.kind == DocumentKind::post && member.key == post_output;
    if (std::optional<Link> found = is_color ? color(member.value) : link(member.value, member.key))
      output.link = std::move(*found);
    graph_.outputs.push_back(std::move(output));
  }
}

std::optional<Graph> GraphBuilder::build(DocumentKind kind) {
  const size_t errors_before = diagnostics_.error_count();
  const Json& root = document_.root;
  graph_.kind = kind;
  ObjectReader reader(document_, root, with_article(kind) + " document", diagnostics_);
  reader.ignore("isoshade");
  reader.ignore("$schema");
  if (kind == DocumentKind::effect) reader.ignore(extends_key);  // the base is merged in before
  graph_.doc = reader.string("doc", "");
  graph_.name = reader.string(kind_name(kind));
  const Json& name = *root.find(kind_name(kind));
  graph_.name_place = place_of(name);
  if (name.kind == Json::Kind::string) check_id(graph_.name, graph_.name_place, "a document");

  const bool is_function = kind == DocumentKind::function;
  if (const Json* inputs = reader.object(is_function ? "inputs" : "parameters", Need::optional)) {
    read_inputs(*inputs, !is_function);
  }
  if (const Json* nodes = reader.object("nodes", Need::optional)) read_nodes(*nodes);
  if (kind == DocumentKind::effect) {
    if (const Json* passes = reader.array("passes")) read_passes(*passes);
  } else {
    if (const Json* outputs = reader.object("outputs")) read_outputs(*outputs);
  }
  if (kind == DocumentKind::post) read_post(reader);
  reader.finish();
  if (diagnostics_.error_count() != errors_before) return std::nullopt;
  return std::move(graph_);
}

std::optional<Graph> build_graph(const Document& document, Diagnostics& diagnostics) {
  const std::optional<DocumentKind> kind = document_kind(document, diagnostics);
  if (!kind) return std::nullopt;
  if (*kind == DocumentKind::scene || *kind == DocumentKind::image) {
    diagnostics.report(Id::wrong_kind, document.span(*document.root.find(kind_name(*kind))),
                       with_article(*kind) + " is not a graph; use a function, effect or post here");
    return std::nullopt;
  }
  return GraphBuilder(document, diagnostics).build(*kind);
}

}  // namespace isoshade::graph
