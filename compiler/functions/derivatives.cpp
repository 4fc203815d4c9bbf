// SPDX-License-Identifier: Apache-2.0
#include "compiler/functions/library.h"

#include <map>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "compiler/functions/all.h"
#include "compiler/functions/calls.h"
#include "compiler/functions/signatures.h"
#include "compiler/functions/slopes.h"
#include "compiler/support/assert.h"

namespace isoshade::functions {
namespace {

using namespace traced;

struct Absent {};

// The rows as types, with the argument types of their variants.
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  struct Row_##name {                                           \
    using Variants = Signatures<Float>::signature;              \
    static constexpr bool on_floats = #signature[0] == 'g';     \
    static constexpr std::string_view row = #name;              \
  };
#include "compiler/functions/functions.def"

#define DERIVATIVE(row, argument, change_)                                  \
  struct Change_##row##_##argument : Row_##row {                            \
    static constexpr size_t index = #argument[0] - 'x';                     \
    template <class D, class X, class Y = Absent>                           \
    static auto run(D d, [[maybe_unused]] X x, [[maybe_unused]] Y y = {}) { \
      return change_;                                                       \
    }                                                                       \
  };
#include "compiler/functions/functions.def"

template <class Change, class... T>
ir::ValueId contribution(ir::Builder& b, std::span<const ir::ValueId> arguments, ir::ValueId change) {
  const std::tuple<T...> taken{Flat<T>::take(b, arguments)...};
  const std::tuple_element_t<Change::index, std::tuple<T...>> d(b, change);
  return std::apply([&](T... a) { return Change::run(d, a...); }, taken).value;
}

using Rules = std::map<const Variant*, DerivativeRule>;

template <class... T>
DerivativeRule& rule_of(Rules& rules, std::string_view row, Types<T...>) {
  std::vector<ir::Type> types;
  (Flat<T>::types(types), ...);
  const Variant* variant = find(row, types);
  support::assert_that(variant != nullptr && variant->results.size() == 1, "a derivative of an unknown function");
  return rules[variant];
}

template <class Change, class... T>
void add_change(Rules& rules, Types<T...> types) {
  rule_of(rules, Change::row, types)[Change::index] = &contribution<Change, T...>;
}

/// Vector variants of rows defined on floats need no rule: their bodies call the float variant for each component.
template <class Change, class First, class... Rest>
void add_changes(Rules& rules, Types<First, Rest...>) {
  add_change<Change>(rules, First{});
  if constexpr (!Change::on_floats) (add_change<Change>(rules, Rest{}), ...);
}

template <class Row, class... Variants>
void add_flat(Rules& rules, Types<Variants...>) {
  (rule_of(rules, Row::row, Variants{}), ...);
}

}  // namespace

const DerivativeRule* find_derivative(const Variant& variant) {
  static const Rules rules = [] {
    Rules all;
#define FLAT(row) add_flat<Row_##row>(all, Row_##row::Variants{});
#define DERIVATIVE(row, argument, change) add_changes<Change_##row##_##argument>(all, Row_##row::Variants{});
#include "compiler/functions/functions.def"
    return all;
  }();
  const auto found = rules.find(&variant);
  return found == rules.end() ? nullptr : &found->second;
}

}  // namespace isoshade::functions
