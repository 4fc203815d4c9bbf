// SPDX-License-Identifier: Apache-2.0
// Between the C++ types of function templates and the IR's values: a vector is one value, a matrix its columns.
#pragma once

#include <span>
#include <vector>

#include "compiler/functions/matrix_type.h"
#include "compiler/functions/traced.h"

namespace isoshade::functions::traced {

template <class T>
struct Flat;

template <class T, ir::Type type>
struct FlatScalar {
  static void types(std::vector<ir::Type>& out) { out.push_back(type); }
  static void values(ir::Builder& b, const T& from, std::vector<ir::ValueId>& out) { out.push_back(from.id(b)); }
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
struct Flat<lanes::vec<Float, N>> : FlatScalar<lanes::vec<Float, N>, ir::vector_type(N)> {};

template <int N>
ir::Builder* builder_in(const mat<Float, N>& value) {
  return value[0].builder;
}

template <int N>
struct Flat<mat<Float, N>> {
  using Column = Flat<lanes::vec<Float, N>>;
  static void types(std::vector<ir::Type>& out) {
    for (int i = 0; i < N; ++i) Column::types(out);
  }
  static void values(ir::Builder& b, const mat<Float, N>& from, std::vector<ir::ValueId>& out) {
    for (int i = 0; i < N; ++i) Column::values(b, from[i], out);
  }
  static mat<Float, N> take(ir::Builder& b, std::span<const ir::ValueId>& from) {
    return take_columns(b, from, std::make_integer_sequence<int, N>());
  }

 private:
  template <int... I>
  static mat<Float, N> take_columns(ir::Builder& b, std::span<const ir::ValueId>& from,
                                    std::integer_sequence<int, I...>) {
    return {{(static_cast<void>(I), Column::take(b, from))...}};
  }
};

}  // namespace isoshade::functions::traced
