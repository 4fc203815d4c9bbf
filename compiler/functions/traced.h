// SPDX-License-Identifier: Apache-2.0
// Stand-ins for float, int, bool and vectors that record what is done with them. A function template of this
// folder instantiated with `traced::Float` builds IR; instantiated with `float` it computes. One text, both
// uses.
#pragma once

#include <array>
#include <concepts>

#include "compiler/ir/builder.h"
#include "compiler/support/check.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::functions::traced {

/// A value of a builder, or a literal that becomes a constant where it first meets a value.
template <class Literal>
struct Scalar {
  ir::Builder* builder = nullptr;
  ir::ValueId value = ir::none;
  Literal literal{};

  Scalar() = default;
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

template <class T>
ir::Builder* builder_in(const T& value) {
  return value.builder;
}

template <class... T>
ir::Builder& builder_of(const T&... values) {
  ir::Builder* found = nullptr;
  ((found = found ? found : builder_in(values)), ...);
  support::check(found != nullptr, "a traced operation on literals alone");
  return *found;
}

template <class Result, class... T>
Result record(ir::Opcode op, const T&... operands) {
  ir::Builder& b = builder_of(operands...);
  return Result(b, b.op(op, {operands.id(b)...}));
}

// Not templates, so that a literal on either side converts.
#define ISOSHADE_TRACED(result, type, symbol, op) \
  inline result operator symbol(type a, type b) { return record<result>(ir::Opcode::op, a, b); }
ISOSHADE_TRACED(Float, Float, +, fadd)
ISOSHADE_TRACED(Float, Float, -, fsub)
ISOSHADE_TRACED(Float, Float, *, fmul)
ISOSHADE_TRACED(Float, Float, /, fdiv)
ISOSHADE_TRACED(Bool, Float, <, flt)
ISOSHADE_TRACED(Bool, Float, <=, fle)
ISOSHADE_TRACED(Bool, Float, >, fgt)
ISOSHADE_TRACED(Bool, Float, >=, fge)
ISOSHADE_TRACED(Bool, Float, ==, feq)
ISOSHADE_TRACED(Bool, Float, !=, fne)
ISOSHADE_TRACED(Int, Int, +, iadd)
ISOSHADE_TRACED(Int, Int, -, isub)
ISOSHADE_TRACED(Int, Int, *, imul)
ISOSHADE_TRACED(Int, Int, &, iand)
ISOSHADE_TRACED(Int, Int, |, ior)
ISOSHADE_TRACED(Int, Int, ^, ixor)
ISOSHADE_TRACED(Bool, Int, <, ilt)
ISOSHADE_TRACED(Bool, Int, <=, ile)
ISOSHADE_TRACED(Bool, Int, >, igt)
ISOSHADE_TRACED(Bool, Int, >=, ige)
ISOSHADE_TRACED(Bool, Int, ==, ieq)
ISOSHADE_TRACED(Bool, Int, !=, ine)
ISOSHADE_TRACED(Bool, Bool, &, band)
ISOSHADE_TRACED(Bool, Bool, |, bor)
ISOSHADE_TRACED(Bool, Bool, ^, bxor)
#undef ISOSHADE_TRACED

inline Bool operator!(Bool a) { return record<Bool>(ir::Opcode::bnot, a); }
inline Float negate(Float a) { return record<Float>(ir::Opcode::fneg, a); }
inline Float abs(Float a) { return record<Float>(ir::Opcode::fabs, a); }
inline Float sqrt(Float a) { return record<Float>(ir::Opcode::fsqrt, a); }
inline Float floor(Float a) { return record<Float>(ir::Opcode::floor, a); }
inline Int to_int(Float a) { return record<Int>(ir::Opcode::ftoi, a); }
inline Float to_float(Int a) { return record<Float>(ir::Opcode::itof, a); }
inline Int bits(Float a) { return record<Int>(ir::Opcode::fbits, a); }
inline Int bits_nonnan(Float a) { return record<Int>(ir::Opcode::fbits_nonnan, a); }
inline Float from_bits(Int a) { return record<Float>(ir::Opcode::bitsf, a); }
inline Float from_bits_normal(Int a) { return record<Float>(ir::Opcode::bitsf_normal, a); }
inline Int mul_hi(Int a, Int b) { return record<Int>(ir::Opcode::imulhi, a, b); }
inline Int unsigned_mul_hi(Int a, Int b) { return record<Int>(ir::Opcode::umulhi, a, b); }
inline Int shift_left(Int a, Int b) { return record<Int>(ir::Opcode::ishl, a, b); }
inline Int shift_right(Int a, Int b) { return record<Int>(ir::Opcode::ishr, a, b); }
inline Int shift_right_signed(Int a, Int b) { return record<Int>(ir::Opcode::isar, a, b); }
inline Bool unsigned_less(Int a, Int b) { return record<Bool>(ir::Opcode::ult, a, b); }
inline Float select(Bool c, Float a, Float b) { return record<Float>(ir::Opcode::select, c, a, b); }
inline Int select(Bool c, Int a, Int b) { return record<Int>(ir::Opcode::select, c, a, b); }
inline Bool select(Bool c, Bool a, Bool b) { return record<Bool>(ir::Opcode::select, c, a, b); }

}  // namespace isoshade::functions::traced

namespace isoshade::lanes {

template <>
struct traits<functions::traced::Float>
    : family<functions::traced::Float, functions::traced::Int, functions::traced::Bool, 1> {};

/// A vector is one value of a vector type; components are extracted on demand.
template <int N>
struct vec<functions::traced::Float, N> {
  using Float = functions::traced::Float;
  ir::Builder* builder = nullptr;
  ir::ValueId value = ir::none;

  vec(ir::Builder& builder, ir::ValueId value) : builder(&builder), value(value) {}
  template <std::convertible_to<Float>... Components>
  requires(sizeof...(Components) == N) vec(const Components&... components) {
    const std::array<Float, N> floats{Float(components)...};
    for (const Float& component : floats) builder = builder ? builder : component.builder;
    support::check(builder != nullptr, "a traced vector of literals alone");
    std::array<ir::ValueId, N> ids;
    for (int i = 0; i < N; ++i) ids[i] = floats[i].id(*builder);
    value = builder->construct(ids);
  }

  Float operator[](int i) const { return Float(*builder, builder->extract(value, static_cast<uint32_t>(i))); }
  ir::ValueId id(ir::Builder&) const { return value; }
};

}  // namespace isoshade::lanes

namespace isoshade::functions::traced {

template <int N>
using V = lanes::vec<Float, N>;

#define ISOSHADE_TRACED(symbol, op)            \
  template <int N>                             \
  V<N> operator symbol(V<N> a, V<N> b) {       \
    return record<V<N>>(ir::Opcode::op, a, b); \
  }
ISOSHADE_TRACED(+, fadd)
ISOSHADE_TRACED(-, fsub)
ISOSHADE_TRACED(*, fmul)
ISOSHADE_TRACED(/, fdiv)
#undef ISOSHADE_TRACED

#define ISOSHADE_TRACED(name, op)           \
  template <int N>                          \
  V<N> name(V<N> a) {                       \
    return record<V<N>>(ir::Opcode::op, a); \
  }
ISOSHADE_TRACED(negate, fneg)
ISOSHADE_TRACED(abs, fabs)
ISOSHADE_TRACED(sqrt, fsqrt)
ISOSHADE_TRACED(floor, floor)
#undef ISOSHADE_TRACED

template <int N>
V<N> select(Bool c, V<N> a, V<N> b) {
  return record<V<N>>(ir::Opcode::select, c, a, b);
}

}  // namespace isoshade::functions::traced
