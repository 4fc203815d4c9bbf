// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "compiler/graph/graph.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Diagnostics;
using support::Id;
using support::quote;

std::optional<Literal> parse_literal(const Document& document, const Json& json, std::string_view key,
                                     Diagnostics& diagnostics) {
  Literal literal;
  const auto finite = [&](const Json& number) {
    if (std::isfinite(document.to_float(number))) return true;
    diagnostics.report(Id::out_of_range, document.span(number), quote(key) + " is beyond the range of float");
    return false;
  };
  switch (json.kind) {
    case Json::Kind::boolean:
      literal.kind = Literal::Kind::boolean;
      literal.boolean = json.boolean;
      return literal;
    case Json::Kind::number:
      if (!finite(json)) return std::nullopt;
      literal.number = document.to_float(json);
      literal.integral = json.integral;
      if (json.integral) literal.integer = document.to_integer(json);
      return literal;
    case Json::Kind::string:
      literal.kind = Literal::Kind::string;
      literal.string = json.string;
      return literal;
    case Json::Kind::array:
      literal.kind = Literal::Kind::numbers;
      if (json.items.empty() || json.items.size() > max_literal_numbers) break;
      for (const Json& item : json.items) {
        if (item.kind != Json::Kind::number) {
          diagnostics.report(
              Id::wrong_type, document.span(item),
              quote(key) + " is an array of numbers, not with " + std::string(kind_name(item.kind)));
          return std::nullopt;
        }
        if (!finite(item)) return std::nullopt;
        literal.numbers.push_back(document.to_float(item));
      }
      return literal;
    case Json::Kind::null:
    case Json::Kind::object: break;
  }
  const bool array = json.kind == Json::Kind::array;
  diagnostics.report(Id::wrong_type, document.span(json),
                     array ? quote(key) + " is an array of 1 to " + std::to_string(max_literal_numbers) +
                                 " numbers, not of " + std::to_string(json.items.size())
                           : quote(key) + " cannot be " + std::string(kind_name(json.kind)));
  return std::nullopt;
}

}  // namespace isoshade::graph
