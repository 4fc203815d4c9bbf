// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/parameter_value.h"

#include <algorithm>

#include "compiler/support/visible.h"

namespace isoshade::driver {

using graph::Literal;
using graph::Type;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

/// Records hold floats, which have all integers up to this one.
constexpr int64_t greatest_integer = int64_t{1} << 24;

/// Whether every number of a value is in the range of the field.
bool check_range(const Field& field, Type type, const Literal& literal, const support::Span& where,
                 Diagnostics& diagnostics) {
  std::vector<float> numbers = literal.numbers;
  if (literal.kind == Literal::Kind::number) numbers = {literal.number};
  for (float number : numbers) {
    const bool below = field.min && number < *field.min;
    if (!below && !(field.max && number > *field.max)) continue;
    const std::string fault = !field.names.empty() ? " has no value " + graph::limit_text(type, number)
                              : below              ? " is at least " + graph::limit_text(type, *field.min)
                                                   : " is at most " + graph::limit_text(type, *field.max);
    support::Diagnostic& report =
        diagnostics.report(Id::out_of_range, where, "the parameter " + quote(field.name) + fault);
    if (!field.names.empty()) report.note(graph::described_names(field.names));
    return false;
  }
  return true;
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

}  // namespace

bool check_integer(const Field& field, int64_t value, const support::Span& where, Diagnostics& diagnostics) {
  if (value >= -greatest_integer && value <= greatest_integer) return true;
  diagnostics.report(Id::out_of_range, where,
                     "the integer parameter " + quote(field.name) + " is " + std::to_string(value) + "; it lies between -" +
                         std::to_string(greatest_integer) + " and " + std::to_string(greatest_integer));
  return false;
}

bool check_fit(const Field& field, const Literal& literal, const support::Span& where,
               Diagnostics& diagnostics) {
  const Type type = type_of(field);
  const std::string& name = field.name;
  const std::vector<std::string>& values = field.names;
  if (literal.kind == Literal::Kind::string && !values.empty()) {
    if (graph::named_value(values, literal.string)) return true;
    std::vector<std::string_view> names(values.begin(), values.end());
    diagnostics
        .report_unknown(Id::unknown_choice, where,
                        "no value of the parameter " + quote(name) + " is called " + quote(literal.string),
                        literal.string, names)
        .note(graph::described_names(values));
    return false;
  }
  if (graph::fits(type, literal))
    return check_range(field, type, literal, where, diagnostics) &&
           (type != Type::integer || check_integer(field, literal.integer, where, diagnostics));
  const int floats = graph::float_count(type);
  std::string expected = std::string(graph::type_name(type));
  if (type == Type::filename) expected += ", a path in quotes";
  if (type == Type::boolean) expected += ", true or false";
  if (type == Type::integer) expected += ", a whole number without fraction";
  if (floats == 1) expected += ", a number";
  if (!values.empty()) expected += ", or one of " + listed(values);
  if (floats > 1) expected += ", an array of " + std::to_string(floats) + " numbers";
  diagnostics.report(Id::wrong_type, where, "the parameter " + quote(name) + " is of type " + expected);
  return false;
}

void store(Type type, const std::vector<std::string>& names, const Literal& literal, float* words) {
  switch (type) {
    case Type::boolean: words[0] = literal.boolean ? 1.0f : 0.0f; break;
    case Type::integer: {
      const auto named = graph::named_value(names, literal.string);
      words[0] = static_cast<float>(named ? named->integer : literal.integer);
      break;
    }
    case Type::floating: words[0] = literal.number; break;
    case Type::filename:
    case Type::string: break;  // not in the record
    default: std::copy(literal.numbers.begin(), literal.numbers.end(), words);
  }
}

}  // namespace isoshade::driver
