// SPDX-License-Identifier: Apache-2.0
// Stand-ins for float, int, bool and vectors that record what is done with them. A function template of this
// folder instantiated with `traced::Float` builds IR; instantiated with `float` it computes.
#pragma once

#include <array>
#include <concepts>
#include <span>

#include "compiler/ir/builder.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::functions::traced {

/// A value of a builder, or a literal that becomes a constant where it first meets a value.
template <class Literal>
struct Scalar {
  ir::Builder* builder = nullptr;
  ir::ValueId value = ir::none;
  Literal literal{};

  Scalar(Literal literal) : literal(literal) {}
  Scalar(ir::Builder& builder, ir::ValueId value) : builder(&builder), value(value) {}
  ir::ValueId id(ir::Builder& b) const { return builder ? value : b.constant(literal); }
};

struct Bool : Scalar<bool> {
  using Scalar::Scalar;
};
struct Int : Scalar<int> {
  using Scalar::Scalar;
};
struct Float : Scalar<float> {
  using Scalar::Scalar;
};

// Not templates, so that a literal on either side converts.
#define UNARY(result, name, type, op) result name(type a);
#define BINARY(result, name, type, op) result name(type a, type b);
#include "compiler/functions/traced_ops.def"

Float select(Bool condition, Float then, Float other);
Int select(Bool condition, Int then, Int other);
Bool select(Bool condition, Bool then, Bool other);

/// The builder of a value; null for a literal.
template <class T>
ir::Builder* builder_in(const T& value) {
  return value.builder;
}

/// The builder of the values among these.
template <class... T>
ir::Builder& builder_of(const T&... values) {
  ir::Builder* found = nullptr;
  ((found = found ? found : builder_in(values)), ...);
  support::assert_that(found != nullptr, "a traced operation on literals alone");
  return *found;
}

/// Records a primitive op.
template <class Result, class... T>
Result record(ir::Opcode op, const T&... operands) {
  ir::Builder& b = builder_of(operands...);
  return Result(b, b.op(op, {operands.id(b)...}));
}

/// Records the vector of these components.
ir::ValueId construct(ir::Builder& builder, std::span<const Float> components);

}  // namespace isoshade::functions::traced

namespace isoshade::lanes {

template <>
struct traits<functions::traced::Float>
    : family<functions::traced::Float, functions::traced::Int, functions::traced::Bool, 1> {};

/// A traced vector is one value of a vector type; components are extracted on demand.
template <int N>
struct vec<functions::traced::Float, N> {
  using Float = functions::traced::Float;
  ir::Builder* builder;
  ir::ValueId value;

  vec(ir::Builder& builder, ir::ValueId value) : builder(&builder), value(value) {}
  template <std::convertible_to<Float>... Components>
  requires(sizeof...(Components) == N) vec(const Components&... components)
      : builder(&functions::traced::builder_of(Float(components)...)),
        value(functions::traced::construct(*builder, std::array<Float, N>{Float(components)...})) {}

  Float operator[](int i) const { return Float(*builder, builder->extract(value, static_cast<uint32_t>(i))); }
  ir::ValueId id(ir::Builder&) const { return value; }
};

}  // namespace isoshade::lanes

namespace isoshade::functions::traced {

template <int N>
using V = lanes::vec<Float, N>;

// clang-format off
template <int N> V<N> operator+(V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::fadd, a, b); }
template <int N> V<N> operator-(V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::fsub, a, b); }
template <int N> V<N> operator*(V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::fmul, a, b); }
template <int N> V<N> operator/(V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::fdiv, a, b); }
template <int N> V<N> negate(V<N> a) { return record<V<N>>(ir::Opcode::fneg, a); }
template <int N> V<N> abs(V<N> a) { return record<V<N>>(ir::Opcode::fabs, a); }
template <int N> V<N> sqrt(V<N> a) { return record<V<N>>(ir::Opcode::fsqrt, a); }
template <int N> V<N> floor(V<N> a) { return record<V<N>>(ir::Opcode::floor, a); }
template <int N> V<N> select(Bool c, V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::select, c, a, b); }
// clang-format on

}  // namespace isoshade::functions::traced
