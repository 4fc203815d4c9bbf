// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/node_inference.h"

namespace isoshade::check {

using graph::Literal;
using support::Id;
using support::quote;

/// Infers the type of a generic call from the links to "any" inputs, then from literal arrays, and selects the instance.
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
    if (takes(i, input.type)) return;
    report(Id::type_mismatch, i, of_node(i) + " takes " + name_of(input.type) + ", not " + name_of(to.type))
        .suggest(conversion_hint(*given(i).link, input.type));
    return;
  }
  const Literal& value = literal(i) != nullptr ? *literal(i) : *input.value;
  if (!fits(value, input.type)) {
    report(Id::wrong_type, i, of_node(i) + " must be " + name_of(input.type) + ", not " + described(value));
    return;
  }
  if (input.type == Type::filename && literal(i) != nullptr) return place_path(i);
  if (input.type == Type::filename)
    return place_file(work_.typed, {value.string, node_.callee->graph.span(input.value_place)}, to);
  check_range(i, input);
  place(work_.typed, value, input.type, to);
}

void NodeInference::check_range(size_t i, const graph::Input& input) {
  const Literal* value = literal(i);
  if (value == nullptr) return;
  const auto check = [&](float number) {
    const bool low = input.min && number < *input.min;
    if (!low && !(input.max && number > *input.max)) return true;
    const std::string fault = !input.names.empty() ? " has no value " + graph::limit_text(input.type, number)
                              : low ? " must be at least " + graph::limit_text(input.type, *input.min)
                                    : " must be at most " + graph::limit_text(input.type, *input.max);
    support::Diagnostic& wrong = report(Id::out_of_range, i, of_node(i) + fault);
    if (!input.names.empty()) wrong.note(graph::described_names(input.names));
    wrong.note(node_.callee->graph.span(input.place), "declared here");
    return false;
  };
  if (value->kind == Literal::Kind::number) check(value->number);
  for (const float number : value->numbers)
    if (!check(number)) return;
}

}  // namespace isoshade::check
