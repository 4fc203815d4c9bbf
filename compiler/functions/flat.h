// SPDX-License-Identifier: Apache-2.0
// Converts between the C++ types of function templates and IR values; a matrix is several IR values.
#pragma once

#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "compiler/functions/body.h"
#include "compiler/functions/traced.h"

namespace isoshade::functions::traced {

template <int N>
using M = mat<Float, N>;

template <class T>
struct Flat;

template <class T, ir::Type type>
struct FlatScalar {
  static void types(std::vector<ir::Type>& out) { out.push_back(type); }
  static void values(ir::Builder& b, const T& from, std::vector<ir::ValueId>& out) {
    out.push_back(from.id(b));
  }
  static T take(ir::Builder& b, std::span<const ir::ValueId>& from) {
    const T result(b, from.front());
    from = from.subspan(1);
    return result;
  }
};

template <>
struct Flat<Float> : FlatScalar<Float, ir::float_type> {};
template <>
struct Flat<Int> : FlatScalar<Int, ir::int_type> {};
template <>
struct Flat<Bool> : FlatScalar<Bool, ir::bool_type> {};
template <int N>
struct Flat<V<N>> : FlatScalar<V<N>, ir::vector_type(N)> {};

template <int N>
ir::Builder* builder_in(const M<N>& value) {
  return value[0].builder;
}

template <int N>
struct Flat<M<N>> {
  using Column = Flat<V<N>>;
  static void types(std::vector<ir::Type>& out) {
    for (int i = 0; i < N; ++i) Column::types(out);
  }
  static void values(ir::Builder& b, const M<N>& from, std::vector<ir::ValueId>& out) {
    for (int i = 0; i < N; ++i) Column::values(b, from[i], out);
  }
  static M<N> take(ir::Builder& b, std::span<const ir::ValueId>& from) {
    return take_columns(b, from, std::make_integer_sequence<int, N>());
  }

 private:
  template <int... I>
  static M<N> take_columns(ir::Builder& b, std::span<const ir::ValueId>& from,
                           std::integer_sequence<int, I...>) {
    return {{(static_cast<void>(I), Column::take(b, from))...}};
  }
};

template <class... T>
struct Flat<std::tuple<T...>> {
  static void values(ir::Builder& b, const std::tuple<T...>& from, std::vector<ir::ValueId>& out) {
    std::apply([&](const T&... part) { (Flat<T>::values(b, part, out), ...); }, from);
  }
  static std::tuple<T...> take(ir::Builder& b, std::span<const ir::ValueId>& from) {
    return {Flat<T>::take(b, from)...};
  }
};

/// Builds an IR `branch`: then() if the condition holds, else other(). The traced counterpart of lanes::branch.
template <class Then, class Other>
auto branch(Bool condition, const Then& then, const Other& other) {
  using Result = decltype(then());
  ir::Builder& b = *condition.builder;
  const auto side = [&b](const auto& body) {
    return [&b, &body] {
      std::vector<ir::ValueId> values;
      Flat<Result>::values(b, body(), values);
      return values;
    };
  };
  const std::vector<ir::ValueId> results = b.branch(condition.value, side(then), side(other));
  std::span<const ir::ValueId> rest(results);
  return Flat<Result>::take(b, rest);
}

/// Builds an IR `loop` over body(index, state...) for index 0 .. count-1. The traced counterpart of functions::loop. At
/// least one initial state must not be a literal.
template <class Body, class... State>
std::tuple<State...> loop(Int count, const Body& body, const State&... initial) {
  using States = std::tuple<State...>;
  ir::Builder& b = builder_of(initial...);
  const auto flat = [&b](const States& states) {
    std::vector<ir::ValueId> values;
    Flat<States>::values(b, states, values);
    return values;
  };
  const std::vector<ir::ValueId> results =
      b.loop(count.id(b), flat({initial...}), [&](ir::ValueId i, std::span<const ir::ValueId> carried) {
        const auto step = [&](const State&... state) { return body(Int(b, i), state...); };
        return flat(std::apply(step, Flat<States>::take(b, carried)));
      });
  std::span<const ir::ValueId> rest(results);
  return Flat<States>::take(b, rest);
}

}  // namespace isoshade::functions::traced
