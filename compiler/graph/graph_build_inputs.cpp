// SPDX-License-Identifier: Apache-2.0
// The inputs of a function, and the parameters of an effect or post.
#include <algorithm>

#include "compiler/graph/graph_builder.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;
using Need = ObjectReader::Need;

namespace {

std::string types_note() {
  std::string note = "the types are";
  for (const std::string_view name : all_type_names()) {
    const Type type = *find_type(name);
    if (float_count(type) > 0 || type == Type::boolean || type == Type::integer)
      note += " " + std::string(name);
  }
  return note;
}

}  // namespace

/// "enum": the names of the values 0, 1, ... of an integer.
void GraphBuilder::read_names(const Json& json, Input& input) {
  constexpr size_t most = 64;
  if (input.type != Type::integer) {
    diagnostics_.report(
        Id::wrong_type, document_.span(json),
        "\"enum\" is only for integers, not for " + std::string(type_name(input.type)));
    return;
  }
  if (json.items.empty() || json.items.size() > most) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        "\"enum\" must be an array of 1 to " + std::to_string(most) + " names, not of " +
                            std::to_string(json.items.size()));
    return;
  }
  for (const Json& item : json.items) {
    if (item.kind != Json::Kind::string) {
      diagnostics_.report(Id::wrong_type, document_.span(item),
                          "\"enum\" must be an array of names, but contains " + std::string(kind_name(item.kind)));
      continue;
    }
    check_id(item.string, place_of(item), "a value");
    if (std::ranges::find(input.names, item.string) != input.names.end()) {
      diagnostics_.report(Id::duplicate_name, document_.span(item),
                          "two values of " + quote(input.name) + " have the name " + quote(item.string));
    }
    input.names.push_back(item.string);
  }
  input.min = 0.0f;
  input.max = static_cast<float>(json.items.size() - 1);
}

void GraphBuilder::check_value(const Input& input, const Json& json) {
  if (!fits(input.type, *input.value)) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        "the value of " + quote(input.name) + " must be " + std::string(type_name(input.type)));
    return;
  }
  const auto check = [&](float value, const Json& at) {
    const bool low = input.min && value < *input.min;
    if (!low && !(input.max && value > *input.max)) return;
    if (!input.names.empty()) {
      diagnostics_
          .report(Id::out_of_range, document_.span(at),
                  quote(input.name) + " has no value " + limit_text(input.type, value))
          .note(described_names(input.names));
      return;
    }
    diagnostics_.report(Id::out_of_range, document_.span(at),
                        "the value of " + quote(input.name) +
                            (low ? " is less than its min " + limit_text(input.type, *input.min)
                                 : " is greater than its max " + limit_text(input.type, *input.max)));
  };
  if (input.value->kind == Literal::Kind::number) check(input.value->number, json);
  for (size_t i = 0; i < input.value->numbers.size(); ++i) check(input.value->numbers[i], json.items[i]);
}

void GraphBuilder::read_input(const Member& member, bool is_parameter) {
  Input input;
  input.name = member.key;
  input.name_place = key_place(member);
  input.place = place_of(member.value);
  const std::string what = (is_parameter ? "parameter " : "input ") + quote(member.key);
  ObjectReader reader(document_, member.value, what, diagnostics_);
  const Json* type = reader.value("type");
  if (type != nullptr && type->kind != Json::Kind::string) {
    reader.report_wrong("type", *type, "a string");
  } else if (type != nullptr) {
    const std::optional<Type> found = find_type(type->string);
    input.type = found.value_or(Type::floating);
    input.any = !is_parameter && type->string == any_type_name;
    if (!found && !input.any) {
      diagnostics_
          .report_unknown(Id::unknown_type, document_.span(*type), "there is no type " + quote(type->string),
                          type->string, all_type_names())
          .note(type->string == any_type_name ? "only inputs of functions can have type \"any\""
                : type->string == "image"     ? "an image has the type \"filename\""
                                              : types_note());
    }
  }
  if (const Json* names = reader.array("enum", Need::optional)) {
    read_names(*names, input);
  } else if (float_count(input.type) > 0 || input.type == Type::integer) {
    input.min = reader.optional_number("min");
    input.max = reader.optional_number("max");
    if (input.min && input.max && *input.min > *input.max) {
      diagnostics_.report(Id::out_of_range, document_.span(*reader.value("max")),
                          "the max of " + what + " is less than its min");
    }
  }
  const bool is_vector =
      input.type == Type::vector2 || input.type == Type::vector3 || input.type == Type::vector4;
  if (!is_parameter && is_vector) input.unit = reader.boolean("unit", false);
  if (is_parameter) input.dynamic = reader.boolean("dynamic", false);
  const Json* value = reader.value("value", is_parameter ? Need::required : Need::optional);
  if (value != nullptr) {
    input.value = parse_literal(document_, *value, "value", diagnostics_);
    const bool is_name = input.value && input.value->kind == Literal::Kind::string && !input.names.empty();
    if (is_name) {
      const std::vector<std::string_view> names(input.names.begin(), input.names.end());
      input.value = named_value(input.names, value->string);
      if (!input.value)
        diagnostics_
            .report_unknown(Id::unknown_choice, document_.span(*value),
                            quote(input.name) + " has no value named " + quote(value->string),
                            value->string, names)
            .note(described_names(input.names));
    }
    input.value_place = place_of(*value);
  }
  input.doc = reader.string("doc", "");
  if (reader.finish() && input.value) check_value(input, *value);
  graph_.inputs.push_back(std::move(input));
}

void GraphBuilder::read_inputs(const Json& inputs, bool are_parameters) {
  for (const Member& member : inputs.members) {
    enter(member, are_parameters ? "a parameter" : "an input",
          {true, static_cast<uint32_t>(graph_.inputs.size())});
    read_input(member, are_parameters);
  }
}

}  // namespace isoshade::graph
