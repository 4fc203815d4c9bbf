// SPDX-License-Identifier: Apache-2.0
// Infers the types of one node: infer.cpp for rows of the node table, infer_call.cpp for function documents.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/check/operand.h"

namespace isoshade::check {

inline std::string name_of(Type type) { return std::string(graph::type_name(type)); }

/// If the operand is untyped (Work::untyped) and `needed` is a colour type of its width, gives it that type. Returns
/// whether it did.
bool takes_as_color(const Work& work, Operand& operand, const graph::Link& link, Type needed);
/// Suggests how to convert the linked value to type `to`.
std::string conversion_hint(const graph::Link& link, Type to);
/// The type to which both convert implicitly; nullopt if there is none.
std::optional<Type> joined(Type a, Type b);
/// The type of an array of so many numbers: a colour only if no vector is accepted.
Type tuple_of(size_t numbers, nodes::TypeSet accepts);

/// Infers port types from links and literals, then output types from port types.
class NodeInference {
 public:
  NodeInference(Work& work, uint32_t index)
      : work_(work), node_(work.typed.nodes[index]), source_(work.graph().nodes[index]), index_(index) {}

  void infer() {
    for (uint32_t i = 0; i < node_.operand_count; ++i) {
      const graph::Link* link = given(i).link;
      if (link != nullptr && !select(work_, *link, operand(i))) fail();
    }
    if (!broken()) node_.row != nullptr ? infer_row() : infer_call();
  }

 private:
  struct Settled {
    std::optional<Type> type;
    size_t port = 0;  ///< the port that determined the type
  };

  Given& given(size_t i) { return work_.given[node_.first_operand + i]; }
  Operand& operand(size_t i) { return work_.typed.operands[node_.first_operand + i]; }
  const graph::Literal* literal(size_t i) {
    const Given& at = given(i);
    return at.port != nullptr && at.link == nullptr ? std::get_if<graph::Literal>(&at.port->value) : nullptr;
  }
  bool broken() const { return work_.broken[index_]; }
  void fail() { work_.broken[index_] = true; }
  support::Diagnostic& report(support::Id id, size_t port, std::string message) {
    fail();
    const Given& at = given(port);
    return work_.report(id, at.port != nullptr ? at.port->place : source_.id_place, std::move(message));
  }
  /// For messages: `"in1" of "add"`, or `the left side of "+"` in an expression.
  std::string of_node(size_t i) {
    const graph::Port* port = given(i).port;
    const std::string_view name = node_.row != nullptr ? node_.row->ports[i].name
                                                       : std::string_view(node_.callee->graph.inputs[i].name);
    return (port != nullptr && !port->shown.empty() ? port->shown : support::quote(name)) + " of " +
           support::quote(source_.label());
  }
  std::string of_other(size_t i) {
    const graph::Port* port = given(i).port;
    return port != nullptr && !port->shown.empty() ? port->shown : support::quote(node_.row->ports[i].name);
  }

  // Rows of the node table.
  const nodes::Port& port(size_t i) const { return node_.row->ports[i]; }
  /// The type of a port that neither links nor literals determine: boolean if only boolean defaults share its variable
  /// (a comparison without results to choose from), else float.
  Type natural_type(size_t i) {
    bool truth = true;
    for (size_t k = 0; k < node_.operand_count; ++k)
      if (port(k).type.variable == port(i).type.variable)
        truth = truth && given(k).port == nullptr && std::holds_alternative<bool>(port(k).value);
    return truth ? Type::boolean : Type::floating;
  }
  bool is_value(size_t i) const { return port(i).type.kind == nodes::PortType::Kind::value; }
  Settled& settled(size_t i) { return settled_[static_cast<size_t>(port(i).type.variable)]; }
  Type type_of(nodes::PortType type) const {
    if (type.variable != nodes::Variable::none) return *settled_[static_cast<size_t>(type.variable)].type;
    Type only{};
    while (!type.accepts.has(only)) only = static_cast<Type>(static_cast<int>(only) + 1);
    return only;
  }

  /// Whether the linked value is accepted as `needed`; it then has that type or one that converts to it.
  bool takes(size_t i, Type needed);
  bool is_untyped(size_t i) {
    return given(i).link != nullptr && work_.is_untyped(operand(i), *given(i).link);
  }
  bool makes_untyped();
  void infer_row();
  void read_text(size_t i);
  void read_integer(size_t i);
  void read_image(size_t i, std::string_view name);
  void check_chosen(size_t i);
  void read_type_name(size_t i, std::string_view text);
  void join(size_t i, Type type);
  void settle_by_links();
  void settle_by_literals();
  void check_settled();
  void place_value(size_t i);
  /// A path in a port. Reports the name of a parameter, which was meant to be a link.
  void place_path(size_t i);
  void check_condition();
  // Function documents.
  void infer_call();
  void settle_instance();
  void place_argument(size_t i);
  void check_range(size_t i, const graph::Input& input);

  Work& work_;
  Node& node_;
  const graph::Node& source_;
  uint32_t index_;
  std::array<Settled, 3> settled_;  ///< by Variable
};

}  // namespace isoshade::check
