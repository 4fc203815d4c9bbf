// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "compiler/check/work.h"
#include "compiler/nodes/table.h"

namespace isoshade::check {
namespace {

using graph::DocumentKind;
using graph::Link;
using graph::Literal;
using nodes::PortType;
using support::Id;
using support::quote;

std::string_view input_word(const graph::Graph& graph) {
  return graph.kind == DocumentKind::function ? "input" : "parameter";
}

/// Resolves the name of a link; its selectors are resolved later, when types are known.
bool resolve_link(Work& work, const Link& link, Operand& operand) {
  const graph::Graph& graph = work.graph();
  if (link.node != Link::unresolved) {
    operand.from = Operand::From::node;
    operand.index = link.node;
    return true;
  }
  if (const auto found = graph.names.find(link.name)) {
    operand.from = found->is_input ? Operand::From::input : Operand::From::node;
    operand.index = found->index;
    return true;
  }
  support::Diagnostic& report = work.report(
      Id::unknown_node, link.place, "there is no node or " + std::string(input_word(graph)) + " " + quote(link.name));
  if (work.diagnostics.full()) return false;
  std::vector<std::string_view> names;
  for (const graph::Input& input : graph.inputs) names.push_back(input.name);
  for (const graph::Node& node : graph.nodes) names.push_back(node.id);
  const std::string_view near = support::nearest(link.name, names);
  if (near.empty()) return false;
  const graph::Graph::Name name = graph.names.at(near);
  const graph::TextRange place =
      name.is_input ? graph.inputs[name.index].name_place : graph.nodes[name.index].id_place;
  report.suggest("did you mean " + quote(near) + " (" +
                 (name.is_input ? std::string(input_word(graph)) : "node") + ", line " +
                 std::to_string(work.span(place).line()) + ")?");
  return false;
}

class NodeResolver {
 public:
  NodeResolver(Work& work, uint32_t index)
      : work_(work), node_(work.typed.nodes[index]), source_(work.graph().nodes[index]), index_(index) {}

  void resolve() {
    node_.row = is_call() ? nodes::find_function(source_.type) : nodes::find(source_.type);
    if (node_.row == nullptr) {
      node_.callee = function();
      if (node_.callee == nullptr || !passes_few_numbers()) return fail();
    }
    if (node_.row != nullptr && !available(node_.row->availability())) {
      support::Diagnostic& report =
          work_.report(Id::misplaced_node, source_.type_place,
                       quote(source_.label()) + " is not available in " +
                           graph::with_article(work_.graph().kind) + " document");
      if (in_function()) report.suggest(function_fix());
      fail();
    }
    add_operands();
    for (const graph::Port& port : source_.ports) match(port);
    for (const graph::Port& port : source_.free_keys)
      if (node_.callee != nullptr && find_port(port.name)) match(port);
    for (uint32_t i = 0; i < node_.operand_count; ++i) {
      if (work_.given[node_.first_operand + i].port == nullptr) check_missing(i);
    }
  }

 private:
  void fail() { work_.broken[index_] = true; }
  bool is_call() const { return source_.origin == graph::Node::Origin::call; }
  bool in_function() const { return work_.graph().kind == DocumentKind::function; }
  /// What to do in a function instead of using a node that only posts may use.
  std::string function_fix() const {
    if (node_.row->is_sum())
      return "compute the sum in the post that calls the function, over the outputs of the function";
    if (node_.row->is<nodes::Fetch>())
      return "read the image in the post that calls the function, and pass the colour as an input";
    return "pass it as an input of the function";
  }
  bool available(nodes::Availability where) const {
    switch (work_.graph().kind) {
      case DocumentKind::post: return where != nodes::Availability::effects;
      case DocumentKind::function: return where != nodes::Availability::posts && where != nodes::Availability::pictures;
      case DocumentKind::effect:
      case DocumentKind::scene:
      case DocumentKind::image: break;
    }
    return where != nodes::Availability::posts;
  }
  size_t port_count() const {
    return node_.row != nullptr ? node_.row->ports.size() : node_.callee->graph.inputs.size();
  }
  std::string_view port_name(size_t i) const {
    return node_.row != nullptr ? node_.row->ports[i].name
                                : std::string_view(node_.callee->graph.inputs[i].name);
  }

  /// Once the limit on errors is reached, no further files are searched.
  std::shared_ptr<const TypedGraph> function() {
    std::shared_ptr<const TypedGraph>& found = work_.functions[{source_.type_place.source, source_.type}];
    if (found == nullptr && !work_.diagnostics.full()) {
      const support::Span where = work_.span(source_.type_place);
      // A base refers to functions relative to itself.
      const bool by_base = source_.type_place.source != 0;
      const Scope of_base = by_base ? work_.library.scope_of(where.file->path()) : Scope();
      found = work_.library.function({source_.type, is_call() ? nodes::function_table() : nodes::table()},
                                     by_base ? of_base : work_.scope, where, work_.diagnostics);
    }
    return found;
  }

  bool passes_few_numbers() {
    const uint64_t before = work_.passed_numbers;
    const auto count = [&](Type type) { work_.passed_numbers += std::max(1, graph::float_count(type)); };
    for (const graph::Input& input : node_.callee->graph.inputs) count(input.type);
    for (const Operand& output : node_.callee->outputs) count(output.needed);
    if (work_.passed_numbers <= max_passed_numbers) return true;
    if (before <= max_passed_numbers) {
      work_.report(Id::too_large, source_.type_place,
                   "the graph passes more than " + std::to_string(max_passed_numbers) +
                       " scalars to and from functions");
    }
    return false;
  }

  void add_operands() {
    node_.first_operand = static_cast<uint32_t>(work_.typed.operands.size());
    node_.operand_count = static_cast<uint32_t>(port_count());
    work_.typed.operands.resize(node_.first_operand + node_.operand_count);
    work_.given.resize(work_.typed.operands.size());
  }

  std::optional<uint32_t> find_port(const std::string& name) const {
    if (is_call()) {
      const auto position = static_cast<uint32_t>(std::stoul(name)) - 1;
      return position < node_.operand_count ? std::optional(position) : std::nullopt;
    }
    if (node_.row == nullptr) {
      const auto found = node_.callee->graph.names.find(name);
      return found && found->is_input ? std::optional(found->index) : std::nullopt;
    }
    for (uint32_t i = 0; i < node_.operand_count; ++i) {
      if (node_.row->ports[i].name == name) return i;
    }
    return std::nullopt;
  }

  void match(const graph::Port& port) {
    const std::optional<uint32_t> found = find_port(port.name);
    if (!found) return report_unknown(port);
    Given& given = work_.given[node_.first_operand + *found];
    given.port = &port;
    Operand& operand = work_.typed.operands[node_.first_operand + *found];
    if (node_.row != nullptr && node_.row->ports[*found].type.kind != PortType::Kind::value) {
      if (std::holds_alternative<Literal>(port.value)) return;  // checked in infer()
      if (node_.row->ports[*found].takes_input) {
        given.link = &std::get<Link>(port.value);
        if (!resolve_link(work_, *given.link, operand)) fail();
        return;
      }
      work_.report(Id::not_literal, port.place,
                   quote(port.name) + " of " + quote(source_.label()) + " must be a literal, not a link");
      return fail();
    }
    given.link = link_in(port, takes_text(*found));
    if (given.link != nullptr && is_named_value(*given.link, *found)) return fail();
    if (given.link != nullptr && !resolve_link(work_, *given.link, operand)) fail();
  }

  /// Reports an unresolvable link that is the name of one of the input's named values.
  bool is_named_value(const Link& link, uint32_t port) {
    if (node_.callee == nullptr || !link.selectors.empty() || work_.graph().names.contains(link.name))
      return false;
    const auto value = graph::named_value(node_.callee->graph.inputs[port].names, link.name);
    if (!value) return false;
    work_
        .report(Id::unknown_node, link.place,
                "a string in a port is a link, but there is no node or input " + quote(link.name))
        .suggest("write " + std::to_string(value->integer) + ", the number of that value");
    return true;
  }

  bool takes_text(size_t i) const {
    if (node_.row == nullptr) return node_.callee->graph.inputs[i].type == Type::filename;
    return node_.row->ports[i].type.accepts.has(Type::filename);
  }

  /// The link in a port, or null: a string is a link unless the port takes text.
  const Link* link_in(const graph::Port& port, bool takes_text) {
    if (const auto* link = std::get_if<Link>(&port.value)) return link;
    const Literal& literal = std::get<Literal>(port.value);
    if (literal.kind != Literal::Kind::string || takes_text) return nullptr;
    std::optional<Link> link =
        graph::parse_link(literal.string, port.place, work_.span(port.place), work_.diagnostics);
    if (!link) {
      fail();
      return nullptr;
    }
    return &work_.links.emplace_back(std::move(*link));
  }

  void report_unknown(const graph::Port& port) {
    fail();
    if (is_call()) {
      work_.report(Id::unknown_port, port.place,
                   quote(source_.label()) + " takes only " + arguments());
      return;
    }
    support::Diagnostic& report = work_.report(Id::unknown_port, port.name_place,
                                               quote(source_.label()) + " has no port " + quote(port.name));
    if (work_.diagnostics.full()) return;
    std::vector<std::string_view> names;
    for (size_t i = 0; i < node_.operand_count; ++i) names.push_back(port_name(i));
    suggest_nearest(work_.diagnostics, report, port.name, names);
    report.note(names.empty() ? "it has no ports" : "its ports are " + listed(names));
  }

  void check_missing(uint32_t i) {
    const bool required = node_.row != nullptr
                              ? node_.row->ports[i].required(work_.graph().kind != DocumentKind::post)
                              : !node_.callee->graph.inputs[i].value.has_value();
    if (!required) return;
    fail();
    if (is_call()) {
      work_.report(
          Id::missing_port, source_.type_place,
          quote(source_.label()) + " takes " + arguments() + ": " + quote(port_name(i)) + " is missing");
      return;
    }
    support::Diagnostic& report = work_.report(
        Id::missing_port, source_.id_place,
        "node " + quote(source_.id) + " (" + quote(source_.type) + ") needs " + quote(port_name(i)));
    if (node_.row != nullptr)
      report.note(std::string(port_name(i)) + ": " + std::string(node_.row->ports[i].doc));
    else if (port_name(i) == "type")
      report.suggest("the key \"type\" of a node is its type, so rename the input or declare its \"value\"");
  }

  /// "3 arguments"
  std::string arguments() const {
    return std::to_string(port_count()) + (port_count() == 1 ? " argument" : " arguments");
  }

  Work& work_;
  Node& node_;
  const graph::Node& source_;
  uint32_t index_;
};

enum class State : uint8_t { unseen, open, done };

struct Visit {
  uint32_t node;
  uint32_t next_operand;
};

/// The cycle through `node` as text: "a -> b -> a". All operations of an expression count as one node.
std::string path_of(const Work& work, const std::vector<Visit>& open, uint32_t node) {
  size_t first = open.size();
  while (open[first - 1].node != node) --first;
  --first;
  std::vector<std::string_view> ids;
  for (size_t i = first; i < open.size(); ++i) {
    const std::string& id = work.graph().nodes[open[i].node].id;
    if (ids.empty() || ids.back() != id) ids.push_back(id);
  }
  const std::string& last = work.graph().nodes[node].id;
  if (ids.size() > 1 && ids.back() == last) ids.pop_back();
  const size_t length = ids.size();
  constexpr size_t shown = 8;
  std::string path;
  for (size_t i = 0; i < length; ++i) {
    if (length > shown && i == shown / 2) {
      path += "... " + std::to_string(length - shown) + " more ... -> ";
      i = length - shown / 2;
    }
    path += std::string(ids[i]) + " -> ";
  }
  return path + last;
}

}  // namespace

void resolve(Work& work) {
  const graph::Graph& graph = work.graph();
  work.typed.nodes.resize(graph.nodes.size());
  work.broken.resize(graph.nodes.size());
  work.typed.operands.reserve(graph.nodes.size() * 2);
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) NodeResolver(work, i).resolve();

  for (const graph::Output& output : graph.outputs) work.roots.push_back(&output.link);
  for (const graph::Pass& pass : graph.passes) work.roots.push_back(&pass.color);
  for (const graph::Pass& pass : graph.passes)
    if (pass.position) work.roots.push_back(&*pass.position);
  for (const graph::Pass& pass : graph.passes) {
    if (!pass.cutout) continue;
    work.roots.push_back(&*pass.cutout);
    work.roots.push_back(pass.cutoff ? &*pass.cutoff : nullptr);
  }
  work.typed.outputs.resize(work.roots.size());
  for (size_t i = 0; i < work.roots.size(); ++i)
    if (work.roots[i] != nullptr) resolve_link(work, *work.roots[i], work.typed.outputs[i]);
}

void order(Work& work) {
  TypedGraph& typed = work.typed;
  std::vector<State> states(typed.nodes.size(), State::unseen);
  std::vector<Visit> open;
  typed.order.reserve(typed.nodes.size());
  for (uint32_t root = 0; root < typed.nodes.size(); ++root) {
    if (states[root] != State::unseen) continue;
    states[root] = State::open;
    open.push_back({root, 0});
    while (!open.empty()) {
      Visit& visit = open.back();
      const Node& node = typed.nodes[visit.node];
      if (visit.next_operand == node.operand_count) {
        states[visit.node] = State::done;
        typed.order.push_back(visit.node);
        open.pop_back();
        continue;
      }
      const uint32_t at = node.first_operand + visit.next_operand++;
      Operand& operand = typed.operands[at];
      if (operand.from != Operand::From::node || states[operand.index] == State::done) continue;
      if (states[operand.index] == State::unseen) {
        states[operand.index] = State::open;
        open.push_back({operand.index, 0});
        continue;
      }
      work.report(Id::cycle, work.given[at].link->place,
                  "the nodes form a cycle: " + path_of(work, open, operand.index));
      work.broken[visit.node] = true;
      operand.from = Operand::From::nothing;
    }
  }
}

}  // namespace isoshade::check
