// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "compiler/check/links.h"
#include "compiler/check/literals.h"
#include "compiler/check/work.h"
#include "compiler/support/parse_number.h"

namespace isoshade::check {
namespace {

using graph::Link;
using graph::Literal;
using nodes::PortType;
using nodes::Variable;
using support::Id;
using support::quote;

std::string name_of(Type type) { return std::string(graph::type_name(type)); }

std::string conversion_hint(const Link& link, Type to) {
  if (link.node != Link::unresolved) return "convert it: " + name_of(to) + "(...)";
  std::string text = link.name;
  for (const std::string& selector : link.selectors) text += "." + selector;
  return R"(convert it by a node {"type": "convert", "in": ")" + text + R"(", "to": ")" + name_of(to) +
         R"("})";
}

/// The type that both are taken as.
std::optional<Type> joined(Type a, Type b) {
  if (converts(a, b)) return b;
  if (converts(b, a)) return a;
  return std::nullopt;
}

/// What so many numbers are, a colour only where it must be.
Type tuple_of(size_t numbers, nodes::TypeSet accepts) {
  switch (numbers) {
    case 2: return Type::vector2;
    case 3: return !accepts.has(Type::vector3) && accepts.has(Type::color3) ? Type::color3 : Type::vector3;
    case 9: return Type::matrix33;
    case 16: return Type::matrix44;
    default: return !accepts.has(Type::vector4) && accepts.has(Type::color4) ? Type::color4 : Type::vector4;
  }
}

/// One node of the table or a function: ports to types, types to outputs.
class NodeInference {
 public:
  NodeInference(Work& work, uint32_t index)
      : work_(work), node_(work.typed.nodes[index]), source_(work.graph().nodes[index]), index_(index) {}

  void infer() {
    for (uint32_t i = 0; i < node_.operand_count; ++i) {
      const Link* link = given(i).link;
      if (link != nullptr && !select(work_, *link, operand(i))) fail();
    }
    if (!broken()) node_.row != nullptr ? infer_row() : infer_call();
  }

 private:
  struct Settled {
    std::optional<Type> type;
    size_t port = 0;  ///< that settled it
  };

  Given& given(size_t i) { return work_.given[node_.first_operand + i]; }
  Operand& operand(size_t i) { return work_.typed.operands[node_.first_operand + i]; }
  const Literal* literal(size_t i) {
    const Given& at = given(i);
    return at.port != nullptr && at.link == nullptr ? std::get_if<Literal>(&at.port->value) : nullptr;
  }
  bool broken() const { return work_.broken[index_]; }
  void fail() { work_.broken[index_] = true; }
  support::Diagnostic& report(Id id, size_t port, std::string message) {
    fail();
    const Given& at = given(port);
    return work_.report(id, at.port != nullptr ? at.port->place : source_.id_place, std::move(message));
  }
  /// `"in1" of "add"`; of what stands in an expression `the left side of "+"`.
  std::string of_node(size_t i) {
    const graph::Port* port = given(i).port;
    const std::string_view name = node_.row != nullptr ? node_.row->ports[i].name
                                                       : std::string_view(node_.callee->graph.inputs[i].name);
    return (port != nullptr && !port->shown.empty() ? port->shown : quote(name)) + " of " +
           quote(source_.label());
  }
  std::string of_other(size_t i) {
    const graph::Port* port = given(i).port;
    return port != nullptr && !port->shown.empty() ? port->shown : quote(node_.row->ports[i].name);
  }

  // Rows of the node table.
  const nodes::Port& port(size_t i) const { return node_.row->ports[i]; }
  /// Of a port that nothing has settled: a comparison that chooses between nothing gives its truth.
  Type natural_type(size_t i) {
    bool truth = true;
    for (size_t k = 0; k < node_.operand_count; ++k)
      if (port(k).type.variable == port(i).type.variable)
        truth = truth && given(k).port == nullptr && std::holds_alternative<bool>(port(k).value);
    return truth ? Type::boolean : Type::floating;
  }
  bool is_value(size_t i) const { return port(i).type.kind == PortType::Kind::value; }
  Settled& settled(size_t i) { return settled_[static_cast<size_t>(port(i).type.variable)]; }
  Type type_of(PortType type) const {
    if (type.variable != Variable::none) return *settled_[static_cast<size_t>(type.variable)].type;
    Type only{};
    while (!type.accepts.has(only)) only = static_cast<Type>(static_cast<int>(only) + 1);
    return only;
  }

  void infer_row();
  void read_text(size_t i);
  void read_integer(size_t i);
  void read_image(size_t i, std::string_view name);
  void read_type_name(size_t i, std::string_view text);
  void join(size_t i, Type type);
  void settle_by_links();
  void settle_by_literals();
  void check_settled();
  void place_value(size_t i);
  void check_condition();
  // Functions.
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

void NodeInference::infer_row() {
  const size_t count = node_.operand_count;
  for (size_t i = 0; i < count; ++i) {
    if (is_value(i)) continue;
    const PortType::Kind kind = port(i).type.kind;
    const bool is_number = kind == PortType::Kind::component || kind == PortType::Kind::integer;
    is_number ? read_integer(i) : read_text(i);
  }
  if (!broken()) settle_by_links();
  if (!broken()) settle_by_literals();
  if (!broken()) check_settled();
  for (size_t i = 0; i < count && !broken(); ++i)
    if (is_value(i)) place_value(i);
  if (broken()) return;
  node_.first_type = static_cast<uint32_t>(work_.typed.types.size());
  node_.output_count = static_cast<uint32_t>(node_.row->outputs.size());
  for (const nodes::Output& output : node_.row->outputs) work_.typed.types.push_back(type_of(output.type));
  if (node_.row->condition != nullptr) check_condition();
}

void NodeInference::read_text(size_t i) {
  const bool is_type = port(i).type.kind == PortType::Kind::type_name;
  std::string_view text;
  if (given(i).port == nullptr) {
    text = std::get<std::string_view>(port(i).value);
    if (text.empty()) return;
  } else if (literal(i)->kind == Literal::Kind::string) {
    text = literal(i)->string;
  } else {
    report(Id::wrong_type, i, of_node(i) + " is a string, not " + described(*literal(i)));
    return;
  }
  if (is_type) return read_type_name(i, text);
  operand(i).from = Operand::From::setting;
  if (port(i).type.kind == PortType::Kind::image) return read_image(i, text);
  const std::vector<std::string_view>& choices = port(i).choices;
  for (uint32_t choice = 0; choice < choices.size(); ++choice) {
    operand(i).index = choice;
    if (choices[choice] == text) return;
  }
  support::Diagnostic& wrong = report(Id::unknown_choice, i, of_node(i) + " cannot be " + quote(text));
  suggest_nearest(work_.diagnostics, wrong, text, choices);
  wrong.note("it can be " + listed(choices, "or"));
}

/// 0 for the image that a post goes over, else 1 + the number of one of its images.
void NodeInference::read_image(size_t i, std::string_view name) {
  if (given(i).port == nullptr) return;
  const std::vector<graph::InputImage>& images = work_.graph().images;
  std::vector<std::string_view> names;
  for (uint32_t image = 0; image < images.size(); ++image) {
    operand(i).index = image + 1;
    if (images[image].name == name) return;
    names.push_back(images[image].name);
  }
  support::Diagnostic& wrong = report(Id::unknown_image, i, "the document has no image " + quote(name));
  suggest_nearest(work_.diagnostics, wrong, name, names);
  wrong.note(names.empty() ? "\"images\" of a document lists those that a scene gives it"
                           : "its images are " + listed(names));
}

void NodeInference::read_type_name(size_t i, std::string_view text) {
  const std::optional<Type> type = graph::find_type(text);
  if (type && port(i).type.accepts.has(*type)) {
    settled(i) = {*type, i};
    operand(i).from = Operand::From::setting;
    operand(i).index = static_cast<uint32_t>(*type);
    return;
  }
  support::Diagnostic& wrong =
      report(type ? Id::type_mismatch : Id::unknown_type, i,
             type ? of_node(i) + " cannot be " + name_of(*type) : "no type " + quote(text));
  if (!type) suggest_nearest(work_.diagnostics, wrong, text, graph::all_type_names());
  wrong.note("it can be " + described(port(i).type.accepts));
}

void NodeInference::read_integer(size_t i) {
  int64_t index = 0;
  if (given(i).port != nullptr) {
    const Literal& written = *literal(i);
    if (!graph::fits(Type::integer, written)) {
      report(Id::wrong_type, i, of_node(i) + " is a whole number, not " + described(written));
      return;
    }
    index = written.integer;
  }
  operand(i).from = Operand::From::setting;
  operand(i).index = static_cast<uint32_t>(index);
}

void NodeInference::join(size_t i, Type type) {
  Settled& at = settled(i);
  if (!at.type) {
    at = {type, i};
    return;
  }
  const bool named = !is_value(at.port);
  const std::optional<Type> both = named && !converts(type, *at.type) ? std::nullopt : joined(*at.type, type);
  if (!both) {
    const std::string other =
        named ? "it is to be " + name_of(*at.type) : of_other(at.port) + " is " + name_of(*at.type);
    support::Diagnostic& wrong =
        report(Id::type_mismatch, i, of_node(i) + " is " + name_of(type) + ", but " + other);
    if (given(i).link != nullptr) wrong.suggest(conversion_hint(*given(i).link, *at.type));
  } else if (*both != *at.type) {
    at = {*both, i};
  }
}

void NodeInference::settle_by_links() {
  for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
    if (is_value(i) && given(i).link != nullptr && port(i).type.variable != Variable::none)
      join(i, operand(i).type);
  }
}

void NodeInference::settle_by_literals() {
  // Arrays and booleans have a type of their own; numbers take any that is left.
  for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
    const Literal* value = literal(i);
    if (value == nullptr || !is_value(i) || port(i).type.variable == Variable::none) continue;
    const Settled& at = settled(i);
    if (at.type && fits(*value, *at.type)) continue;
    const size_t numbers = value->numbers.size();
    const bool tuple = (numbers >= 2 && numbers <= 4) || numbers == 9 || numbers == 16;
    if (value->kind == Literal::Kind::boolean) {
      join(i, Type::boolean);
    } else if (tuple && !(at.type && graph::float_count(*at.type) == static_cast<int>(numbers))) {
      join(i, tuple_of(numbers, port(i).type.accepts));
    } else if (value->kind == Literal::Kind::numbers) {
      report(Id::wrong_type, i,
             of_node(i) + " takes " + described(port(i).type.accepts) + ", not " + described(*value));
    }
  }
  for (size_t i = 0; i < node_.operand_count; ++i)
    if (is_value(i) && port(i).type.variable != Variable::none && !settled(i).type)
      settled(i) = {natural_type(i), i};
}

void NodeInference::check_settled() {
  for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
    if (port(i).type.variable == Variable::none) continue;
    Settled& at = settled(i);
    const nodes::TypeSet accepts = port(i).type.accepts;
    if (accepts.has(*at.type)) continue;
    if (*at.type == Type::integer && accepts.has(Type::floating)) {
      at.type = Type::floating;
      continue;
    }
    report(Id::type_mismatch, at.port,
           of_node(at.port) + " takes " + described(accepts) + ", not " + name_of(*at.type));
  }
}

void NodeInference::place_value(size_t i) {
  const Type needed = type_of(port(i).type);
  Operand& to = operand(i);
  if (given(i).link != nullptr) {
    to.needed = needed;
    if (converts(to.type, needed)) return;
    report(Id::type_mismatch, i, of_node(i) + " takes " + name_of(needed) + ", not " + name_of(to.type))
        .suggest(conversion_hint(*given(i).link, needed));
  } else if (const Literal* value = literal(i)) {
    if (fits(*value, needed) && needed == Type::filename)
      return place_file(work_.typed, {value->string, given(i).port->place}, to);
    if (fits(*value, needed)) return place(work_.typed, *value, needed, to);
    report(Id::wrong_type, i, of_node(i) + " is " + name_of(needed) + ", not " + described(*value));
  } else {
    place(work_.typed, port(i).value, needed, to);
  }
}

void NodeInference::check_condition() {
  std::vector<Type> types;
  std::vector<uint32_t> settings;
  for (size_t i = 0; i < node_.operand_count; ++i) {
    types.push_back(operand(i).needed);
    settings.push_back(operand(i).from == Operand::From::setting ? operand(i).index : 0);
  }
  const Type out = work_.typed.types[node_.first_type];
  if (std::optional<nodes::Refusal> refusal = node_.row->condition(types, settings, out))
    report(refusal->id, refusal->port, std::move(refusal->message));
}

/// What is linked to inputs of any type tells the type, else literals do.
void NodeInference::settle_instance() {
  Settled any;
  const auto join_any = [&](size_t i, Type type) {
    if (type == Type::integer) type = Type::floating;
    const std::optional<Type> both = any.type ? joined(*any.type, type) : type;
    if (!both || !nodes::float_types.has(type)) {
      support::Diagnostic& wrong =
          report(Id::type_mismatch, i,
                 of_node(i) + (both ? " takes " + described(nodes::float_types) + ", not " + name_of(type)
                                    : " is " + name_of(type) + ", but " +
                                          quote(node_.callee->graph.inputs[any.port].name) + " is " +
                                          name_of(*any.type)));
      if (!both && given(i).link != nullptr) wrong.suggest(conversion_hint(*given(i).link, *any.type));
    } else if (!any.type || *both != *any.type) {
      any = {*both, i};
    }
  };
  const std::vector<graph::Input>& inputs = node_.callee->graph.inputs;
  for (size_t i = 0; i < inputs.size() && !broken(); ++i)
    if (inputs[i].any && given(i).link != nullptr) join_any(i, operand(i).type);
  for (size_t i = 0; i < inputs.size() && !broken(); ++i) {
    const Literal* value = literal(i);
    if (!inputs[i].any || value == nullptr || (any.type && fits(*value, *any.type))) continue;
    const size_t numbers = value->numbers.size();
    if (numbers >= 2 && numbers <= 4) join_any(i, tuple_of(numbers, nodes::float_types));
  }
  if (broken() || !any.type || *any.type == Type::floating) return;
  const support::Span where = work_.span(source_.type_place);
  node_.callee = work_.library.instance(node_.callee, *any.type, where, work_.diagnostics);
  if (node_.callee == nullptr) fail();
}

void NodeInference::infer_call() {
  if (node_.callee->graph.is_generic()) settle_instance();
  if (broken()) return;
  for (size_t i = 0; i < node_.operand_count; ++i) place_argument(i);
  node_.first_type = static_cast<uint32_t>(work_.typed.types.size());
  node_.output_count = static_cast<uint32_t>(node_.callee->outputs.size());
  for (const Operand& output : node_.callee->outputs) work_.typed.types.push_back(output.needed);
}

void NodeInference::place_argument(size_t i) {
  const graph::Input& input = node_.callee->graph.inputs[i];
  Operand& to = operand(i);
  if (given(i).link != nullptr) {
    to.needed = input.type;
    if (converts(to.type, input.type)) return;
    report(Id::type_mismatch, i, of_node(i) + " takes " + name_of(input.type) + ", not " + name_of(to.type))
        .suggest(conversion_hint(*given(i).link, input.type));
    return;
  }
  const Literal& value = literal(i) != nullptr ? *literal(i) : *input.value;
  if (!fits(value, input.type)) {
    report(Id::wrong_type, i, of_node(i) + " is " + name_of(input.type) + ", not " + described(value));
    return;
  }
  check_range(i, input);
  place(work_.typed, value, input.type, to);
}

void NodeInference::check_range(size_t i, const graph::Input& input) {
  const Literal* value = literal(i);
  if (value == nullptr) return;
  const auto check = [&](float number) {
    const bool low = input.min && number < *input.min;
    if (!low && !(input.max && number > *input.max)) return true;
    report(Id::out_of_range, i,
           of_node(i) + (low ? " is at least " + support::format_float(*input.min)
                             : " is at most " + support::format_float(*input.max)))
        .note(node_.callee->graph.span(input.place), "as declared here");
    return false;
  };
  if (value->kind == Literal::Kind::number) check(value->number);
  for (const float number : value->numbers)
    if (!check(number)) return;
}

/// What an output of the document needs, given what it reads.
void infer_output(Work& work, size_t i) {
  Operand& output = work.typed.outputs[i];
  const Link& link = *work.roots[i];
  if (!select(work, link, output)) return;
  output.needed = output.type;
  if (work.graph().kind == graph::DocumentKind::function) return;
  if (i >= work.typed.values().size()) {
    if (output.type == Type::vector3) return;
    work.report(Id::type_mismatch, link.place, "\"position\" is a vector3, not " + name_of(output.type));
    return;
  }
  if (nodes::color_types.has(output.type)) return;
  output.needed = Type::color3;
  if (converts(output.type, Type::color3)) return;
  work.report(Id::type_mismatch, link.place, "\"color\" is color3 or color4, not " + name_of(output.type))
      .suggest(conversion_hint(link, Type::color3));
}

}  // namespace

void infer(Work& work) {
  work.typed.types.reserve(work.typed.nodes.size());
  for (const uint32_t node : work.typed.order)
    if (!work.broken[node]) NodeInference(work, node).infer();
  for (size_t i = 0; i < work.typed.outputs.size(); ++i) infer_output(work, i);
}

}  // namespace isoshade::check
