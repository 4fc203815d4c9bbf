// SPDX-License-Identifier: Apache-2.0
// Replacements for float, int, bool and vectors that record operations. A function template of this folder builds IR if
// instantiated with `traced::Float`, and computes if instantiated with `float`.
#pragma once

#include <array>
#include <concepts>
#include <span>

#include "compiler/ir/builder.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::functions::traced {

/// A value of a builder, or a literal that becomes a constant when it is combined with a value.
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

// The functions of runtime/lanes on traced values, from the column `cpp` of ops.def; each records its op.
// TRACE_rule(arity, function, op) is what a row becomes.
#define SPELLED_infix(sign) operator sign
#define SPELLED_prefix(sign) operator sign
#define SPELLED_call(function) function
#define TRACE_same(arity, function, op) TRACE_##arity(Float, function, Float, op)
#define TRACE_compare(arity, function, op) TRACE_##arity(Bool, function, Float, op)
#define TRACE_icompare(arity, function, op) TRACE_##arity(Bool, function, Int, op)
#define TRACE_integer(arity, function, op) TRACE_##arity(Int, function, Int, op)
#define TRACE_logic(arity, function, op) TRACE_##arity(Bool, function, Bool, op)
#define TRACE_to_int(arity, function, op) TRACE_##arity(Int, function, Float, op)
#define TRACE_to_float(arity, function, op) TRACE_##arity(Float, function, Int, op)
#define TRACE_choose(arity, function, op) \
  TRACE_##arity(Float, function, Float, op) TRACE_##arity(Int, function, Int, op) \
  TRACE_##arity(Bool, function, Bool, op)

// Not templates, so that a literal on either side converts.
#define TRACE_1(result, function, type, op) result function(type a);
#define TRACE_2(result, function, type, op) result function(type a, type b);
#define TRACE_3(result, function, type, op) result function(Bool condition, type a, type b);
#define OP(name, arity, rule, cpp, ...) TRACE_##rule(arity, SPELLED_##cpp, name)
#include "compiler/ir/ops.def"
#undef TRACE_1
#undef TRACE_2
#undef TRACE_3

/// The builder of a value; null for a literal.
template <class T>
ir::Builder* builder_in(const T& value) {
  return value.builder;
}

/// The builder of the first argument that is not a literal.
template <class... T>
ir::Builder& builder_of(const T&... values) {
  ir::Builder* found = nullptr;
  ((found = found ? found : builder_in(values)), ...);
  support::assert_that(found != nullptr, "a traced operation has only literal operands");
  return *found;
}

/// What is recorded serves all values, so it must do what some of them need.
inline bool any(Bool) { return true; }

/// Records a primitive op.
template <class Result, class... T>
Result record(ir::Opcode op, const T&... operands) {
  ir::Builder& b = builder_of(operands...);
  return Result(b, b.op(op, {operands.id(b)...}));
}

/// Records the construction of a vector.
ir::ValueId construct(ir::Builder& builder, std::span<const Float> components);

}  // namespace isoshade::functions::traced

namespace isoshade::lanes {

template <>
struct traits<functions::traced::Float>
    : family<functions::traced::Float, functions::traced::Int, functions::traced::Bool, 1> {};
template <>
struct traits<functions::traced::Int> : traits<functions::traced::Float> {};

/// One IR value of a vector type; components are extracted on demand.
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

// The ops that work on vectors, too.
// clang-format off
#define TRACE_VECTOR_1(function, op) \
  template <int N> V<N> function(V<N> a) { return record<V<N>>(ir::Opcode::op, a); }
#define TRACE_VECTOR_2(function, op) \
  template <int N> V<N> function(V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::op, a, b); }
#define TRACE_VECTOR_3(function, op) \
  template <int N> V<N> function(Bool c, V<N> a, V<N> b) { return record<V<N>>(ir::Opcode::op, c, a, b); }
#define TRACE_VECTOR_same(arity, function, op) TRACE_VECTOR_##arity(function, op)
#define TRACE_VECTOR_choose(arity, function, op) TRACE_VECTOR_##arity(function, op)
#define TRACE_VECTOR_compare(arity, function, op)
#define TRACE_VECTOR_icompare(arity, function, op)
#define TRACE_VECTOR_integer(arity, function, op)
#define TRACE_VECTOR_logic(arity, function, op)
#define TRACE_VECTOR_to_int(arity, function, op)
#define TRACE_VECTOR_to_float(arity, function, op)
#define OP(name, arity, rule, cpp, ...) TRACE_VECTOR_##rule(arity, SPELLED_##cpp, name)
#include "compiler/ir/ops.def"
// clang-format on

}  // namespace isoshade::functions::traced
