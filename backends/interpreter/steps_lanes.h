// SPDX-License-Identifier: Apache-2.0
// The steps for W lanes. One file for each instruction set includes it. All that is here is inlined or a template over W,
// because the linker must not share code between instruction sets.
#pragma once

#include <iterator>
#include <utility>

#include "backends/interpreter/steps.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::interpreter {

// What the ops compute, as ops.def spells it.
template <ir::Opcode op>
struct Operation;
#define OP(name, arity, rule, cpp, ...)                                    \
  template <>                                                              \
  struct Operation<ir::Opcode::name> {                                     \
    template <class... T>                                                  \
    ISOSHADE_INLINE static auto of(T... x) {                               \
      return SPELL_##cpp;                                                  \
    }                                                                      \
  };
#define SPELL_infix(sign) (x sign...)
#define SPELL_prefix(sign) sign(x, ...)
#define SPELL_call(function) function(x...)
#include "compiler/ir/ops.def"
#undef SPELL_infix
#undef SPELL_prefix
#undef SPELL_call

/// outer(inner(a, b), c), or outer(c, inner(a, b)).
template <ir::Opcode inner, ir::Opcode outer, bool inner_first>
struct Fused {
  template <class F>
  ISOSHADE_INLINE static F of(F a, F b, F c) {
    if constexpr (inner_first) return Operation<outer>::of(Operation<inner>::of(a, b), c);
    return Operation<outer>::of(c, Operation<inner>::of(a, b));
  }
};

template <int W>
struct Steps {
  using F = lanes::Float<W, 1>;
  using I = lanes::Int<W, 1>;
  using B = lanes::Bool<W, 1>;
  static constexpr bool is_mask(const B*) { return true; }
  static constexpr bool is_mask(const void*) { return false; }

  template <class T>
  ISOSHADE_INLINE static std::byte* place(const Context& context, uint32_t offset) {
    if constexpr (is_mask(static_cast<T*>(nullptr))) return context.masks + offset;
    return context.words + offset;
  }
  template <class T>
  ISOSHADE_INLINE static T read(const std::byte* place, size_t group) {
    T value;
    __builtin_memcpy(&value.raw, place + group * sizeof(value.raw), sizeof(value.raw));
    return value;
  }
  template <class T>
  ISOSHADE_INLINE static void write(std::byte* place, size_t group, T value) {
    __builtin_memcpy(place + group * sizeof(value.raw), &value.raw, sizeof(value.raw));
  }

  ISOSHADE_INLINE static F splat(uint32_t word, F*) { return F(lanes::from_bits_normal(static_cast<int>(word))); }
  ISOSHADE_INLINE static I splat(uint32_t word, I*) { return I(static_cast<int>(word)); }
  ISOSHADE_INLINE static B splat(uint32_t word, B*) { return B(word != 0); }

  template <class T, bool uniform>
  struct Operand {
    ISOSHADE_INLINE Operand(const Context& context, uint32_t at) : from(place<T>(context, at)) {}
    ISOSHADE_INLINE T operator[](size_t group) const { return read<T>(from, group); }
    const std::byte* from;
  };
  template <class T>
  struct Operand<T, true> {
    ISOSHADE_INLINE Operand(const Context& context, uint32_t at)
        : value(splat(context.scalars[at], static_cast<T*>(nullptr))) {}
    ISOSHADE_INLINE T operator[](size_t) const { return value; }
    T value;
  };

  // ---- Operations.

  template <class Op, class To, class A, bool uniform_a>
  static const Step* unary(const Step& s, Context& context) {
    const Operand<A, uniform_a> a(context, s.a);
    std::byte* const to = place<To>(context, s.to);
    for (size_t group = context.begin, end = context.end; group < end; ++group) write<To>(to, group, Op::of(a[group]));
    return &s + 1;
  }
  template <class Op, class To, class A, bool uniform_a, bool uniform_b>
  static const Step* binary(const Step& s, Context& context) {
    const Operand<A, uniform_a> a(context, s.a);
    const Operand<A, uniform_b> b(context, s.b);
    std::byte* const to = place<To>(context, s.to);
    for (size_t group = context.begin, end = context.end; group < end; ++group)
      write<To>(to, group, Op::of(a[group], b[group]));
    return &s + 1;
  }
  template <class Op, class To, class A, class B, bool uniform_a, bool uniform_b, bool uniform_c>
  static const Step* ternary(const Step& s, Context& context) {
    const Operand<A, uniform_a> a(context, s.a);
    const Operand<B, uniform_b> b(context, s.b);
    const Operand<B, uniform_c> c(context, s.c);
    std::byte* const to = place<To>(context, s.to);
    for (size_t group = context.begin, end = context.end; group < end; ++group)
      write<To>(to, group, Op::of(a[group], b[group], c[group]));
    return &s + 1;
  }

  template <class Op, class To, class A>
  static Run* find_unary() {
    return unary<Op, To, A, false>;
  }
  template <class Op, class To, class A>
  static Run* find_binary(unsigned uniform) {
    if (uniform == 0) return binary<Op, To, A, false, false>;
    return uniform == 1 ? binary<Op, To, A, true, false> : binary<Op, To, A, false, true>;
  }
  template <class Op, class To, class A, class B>
  static Run* find_ternary(unsigned uniform) {
    constexpr Run* of[] = {
        ternary<Op, To, A, B, false, false, false>, ternary<Op, To, A, B, true, false, false>,
        ternary<Op, To, A, B, false, true, false>,  ternary<Op, To, A, B, true, true, false>,
        ternary<Op, To, A, B, false, false, true>,  ternary<Op, To, A, B, true, false, true>,
        ternary<Op, To, A, B, false, true, true>,
    };
    return of[uniform];
  }

  template <ir::Opcode op, int arity, class To, class A>
  static Run* find_alike(unsigned uniform) {
    if constexpr (arity == 1) return find_unary<Operation<op>, To, A>();
    else return find_binary<Operation<op>, To, A>(uniform);
  }
  template <ir::Opcode op>
  static Run* find_choice(const Shape& shape) {
    switch (shape.type) {
      case ir::Scalar::floating: return find_ternary<Operation<op>, F, B, F>(shape.uniform);
      case ir::Scalar::integer: return find_ternary<Operation<op>, I, B, I>(shape.uniform);
      case ir::Scalar::boolean: break;
    }
    return find_ternary<Operation<op>, B, B, B>(shape.uniform);
  }
  template <ir::Opcode op, int arity, ir::Rule rule>
  static Run* find_operation(const Shape& shape) {
    using enum ir::Rule;
    if constexpr (rule == choose) return find_choice<op>(shape);
    else if constexpr (rule == same) return find_alike<op, arity, F, F>(shape.uniform);
    else if constexpr (rule == compare) return find_alike<op, arity, B, F>(shape.uniform);
    else if constexpr (rule == icompare) return find_alike<op, arity, B, I>(shape.uniform);
    else if constexpr (rule == integer) return find_alike<op, arity, I, I>(shape.uniform);
    else if constexpr (rule == logic) return find_alike<op, arity, B, B>(shape.uniform);
    else if constexpr (rule == to_int) return find_alike<op, arity, I, F>(shape.uniform);
    else return find_alike<op, arity, F, I>(shape.uniform);
  }
  static Run* find_primitive(const Shape& shape) {
    switch (shape.op) {
#define OP(name, arity, rule, ...) \
  case ir::Opcode::name: return find_operation<ir::Opcode::name, arity, ir::Rule::rule>(shape);
#define FORM(name, ...) case ir::Opcode::name:
#include "compiler/ir/ops.def"
      break;
    }
    return nullptr;
  }

  template <ir::Opcode inner, ir::Opcode outer>
  static Run* find_fused_pair(const Shape& shape) {
    return shape.inner_first ? find_ternary<Fused<inner, outer, true>, F, F, F>(shape.uniform)
                             : find_ternary<Fused<inner, outer, false>, F, F, F>(shape.uniform);
  }
  template <ir::Opcode inner>
  static Run* find_fused_after(const Shape& shape) {
    using enum ir::Opcode;
    if (shape.op == fadd) return find_fused_pair<inner, fadd>(shape);
    return shape.op == fsub ? find_fused_pair<inner, fsub>(shape) : find_fused_pair<inner, fmul>(shape);
  }
  template <size_t... i>
  static Run* find_integer_pair(const Shape& shape, std::index_sequence<i...>) {
    Run* found = nullptr;
    const auto look_at = [&]<size_t n>(std::integral_constant<size_t, n>) {
      constexpr IntegerPair pair = integer_pairs[n];
      if (shape.inner == pair.inner && shape.op == pair.outer)
        found = find_ternary<Fused<pair.inner, pair.outer, true>, I, I, I>(shape.uniform);
    };
    (look_at(std::integral_constant<size_t, i>()), ...);
    return found;
  }
  static Run* find_fused(const Shape& shape) {
    using enum ir::Opcode;
    if (Run* const run = find_integer_pair(shape, std::make_index_sequence<std::size(integer_pairs)>())) return run;
    if (shape.inner == fadd) return find_fused_after<fadd>(shape);
    return shape.inner == fsub ? find_fused_after<fsub>(shape) : find_fused_after<fmul>(shape);
  }

  struct Same {
    template <class T>
    ISOSHADE_INLINE static T of(T x) {
      return x;
    }
  };
  template <class T>
  static Run* find_copy(unsigned uniform) {
    return uniform == 0 ? unary<Same, T, T, false> : unary<Same, T, T, true>;
  }

  template <class T, class Table>
  static const Step* load(const Step& s, Context& context) {
    const BufferView& view = context.buffers[s.more];
    const Table table{static_cast<decltype(Table::data)>(view.data), view.size};
    const std::byte* const from = place<I>(context, s.a);
    std::byte* const to = place<T>(context, s.to);
    for (size_t group = context.begin, end = context.end; group < end; ++group) {
      const I index = read<I>(from, group);
      const int first = index.raw[0];
      // Neighbours mostly read the same element, and gathering is slow.
      write<T>(to, group, all(index == I(first)) ? T(lanes::load(table, first)) : lanes::load(table, index));
    }
    return &s + 1;
  }

  // ---- Control.

  static void execute(const Step* from, const Step* to, Context& context) {
    while (from != to) from = from->run(*from, context);
  }

  /// Executes steps for the groups of [begin, end) where `wanted` holds, as many at a time as are side by side.
  template <class Wanted>
  ISOSHADE_INLINE static void execute_where(const Wanted& wanted, uint32_t begin, uint32_t end, const Step* from,
                                            const Step* to, Context& context) {
    for (uint32_t group = begin; group < end;) {
      if (!wanted(group)) {
        ++group;
        continue;
      }
      context.begin = group;
      while (group < end && wanted(group)) ++group;
      context.end = group;
      execute(from, to, context);
    }
    context.begin = begin;
    context.end = end;
  }

  static const Step* split(const Step& s, Context& context) {
    const std::byte* const mask = place<B>(context, s.a);
    const uint32_t begin = context.begin, end = context.end;
    const Step* const other = &s + s.b;
    const auto wants_then = [&](uint32_t group) __attribute__((always_inline)) { return any(read<B>(mask, group)); };
    const auto wants_other = [&](uint32_t group) __attribute__((always_inline)) { return !all(read<B>(mask, group)); };
    execute_where(wants_then, begin, end, &s + 1, other, context);
    execute_where(wants_other, begin, end, other, &s + s.c, context);
    return &s + s.c;
  }

  static Run* find(const Shape& shape) {
    using enum ir::Scalar;
    switch (shape.kind) {
      case Kind::primitive: return find_primitive(shape);
      case Kind::fused: return find_fused(shape);
      case Kind::load: return shape.type == floating ? load<F, lanes::FloatBuffer> : load<I, lanes::IntBuffer>;
      case Kind::copy: return shape.type == boolean ? find_copy<B>(shape.uniform) : find_copy<I>(shape.uniform);
      case Kind::split: return split;
      case Kind::jump:
      case Kind::jump_if_not:
      case Kind::jump_unless_less: break;
    }
    return nullptr;
  }
};

template <int W>
constexpr LaneCode lane_code() {
  return {W, sizeof(typename Steps<W>::B::Raw), Steps<W>::find, Steps<W>::execute};
}

}  // namespace isoshade::interpreter
