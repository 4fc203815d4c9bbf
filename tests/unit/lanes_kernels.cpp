// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/lanes_kernels.h"

//
// Compiled once for each table, with LANES_TABLE its name and LANES_FLOAT its float type.

#include "runtime/lanes/lanes.h"

namespace isoshade::lanes::test {
namespace {

using F = LANES_FLOAT;
using I = int_of<F>;
using B = bool_of<F>;

ISOSHADE_INLINE void put(int* to, F value) { store_lanes(to, bits(value)); }
ISOSHADE_INLINE void put(int* to, I value) { store_lanes(to, value); }
ISOSHADE_INLINE void put(int* to, B value) { store_lanes(to, select(value, 1, 0)); }

template <class Body>
ISOSHADE_INLINE void for_all_rows(const Inputs& in, int* results, Body body) {
  for (int row = 0; row < in.count; row += lane_count<F>) {
    const I i = load_lanes<I>(in.columns[0] + row);
    const I j = load_lanes<I>(in.columns[1] + row);
    const I k = load_lanes<I>(in.columns[2] + row);
    put(results + row, body(row, i, j, k));
  }
}

// The operands: floats a b c and without denormals x y z, ints i j, shift amount n, bools p q; uniform float
// s, int m and bool t; tables.
#define KERNEL_WITH(text, more, ...)                                             \
  {                                                                              \
    text, [](const Inputs& in, int* results) {                                   \
      for_all_rows(in, results, [&in]([[maybe_unused]] int row, I i, I j, I k) { \
        [[maybe_unused]] const F a = from_bits_normal(i);                        \
        [[maybe_unused]] const F b = from_bits_normal(j);                        \
        [[maybe_unused]] const F c = from_bits_normal(k);                        \
        [[maybe_unused]] const F x = from_bits(i);                               \
        [[maybe_unused]] const F y = from_bits(j);                               \
        [[maybe_unused]] const F z = from_bits(k);                               \
        [[maybe_unused]] const I n = j & 31;                                     \
        [[maybe_unused]] const B p = (k & 1) != 0;                               \
        [[maybe_unused]] const B q = (k & 2) != 0;                               \
        [[maybe_unused]] const float s = from_bits_normal(in.uniform[0]);        \
        [[maybe_unused]] const int m = in.uniform[1];                            \
        [[maybe_unused]] const bool t = (m & 1) != 0;                            \
        [[maybe_unused]] const FloatBuffer floats = {in.floats, in.table_size};  \
        [[maybe_unused]] const IntBuffer ints = {in.ints, in.table_size};        \
        more return __VA_ARGS__;                                                 \
      });                                                                        \
    }                                                                            \
  }
#define KERNEL(...) KERNEL_WITH(#__VA_ARGS__, , __VA_ARGS__)

// An op as the column `cpp` of ops.def spells it, of x0, x1 and x2: TAKE_rule_precondition says what these are.
#define OP(name, arity, rule, cpp, precondition, ...) \
  KERNEL_WITH(#name, TAKE_##rule##_##precondition, TEXT_##arity##_##cpp),
#define TEXT_1_prefix(sign) sign x0
#define TEXT_2_infix(sign) x0 sign x1
#define TEXT_1_call(function) function(x0)
#define TEXT_2_call(function) function(x0, x1)
#define TEXT_3_call(function) function(x0, x1, x2)
#define TAKE(place, value) [[maybe_unused]] const auto x##place = value;
#define TAKE_same_none TAKE(0, a) TAKE(1, b)
#define TAKE_compare_none TAKE(0, a) TAKE(1, b)
#define TAKE_integer_none TAKE(0, i) TAKE(1, j)
#define TAKE_integer_shift_amount TAKE(0, i) TAKE(1, n)
#define TAKE_icompare_none TAKE(0, i) TAKE(1, j)
#define TAKE_logic_none TAKE(0, p) TAKE(1, q)
#define TAKE_choose_none TAKE(0, p) TAKE(1, a) TAKE(2, b)
#define TAKE_to_int_none TAKE(0, a)
#define TAKE_to_int_finite_in_int_range TAKE(0, a)
#define TAKE_to_int_not_nan TAKE(0, a)
#define TAKE_to_float_none TAKE(0, i)
#define TAKE_to_float_not_denormal_bits TAKE(0, i)

// Formatted by hand: the tool reads `a * b` as a pointer.
// clang-format off
const Kernel kernels[] = {
#include "compiler/ir/ops.def"

    // Values that are only moved keep every bit, also of NaN and denormals.
    KERNEL(bits_nonnan(select(p, a, b))),
    KERNEL(bits_nonnan(select(t, a, b))),
    KERNEL(bits_nonnan(negate(a))),
    KERNEL(bits_nonnan(abs(a))),
    KERNEL(bits_nonnan(from_bits(i))),
    KERNEL(bits_nonnan(F(s))),
    KERNEL(select(p, i, j)),
    KERNEL(select(p, q, a < b)),

    // Idioms that compilers recognise. They may flush a denormal or keep it, so there must be none.
    KERNEL(select(x < y, x, y)),
    KERNEL(select(y < x, x, y)),
    KERNEL(select(x > y, y, x)),
    KERNEL(select(x <= y, y, x)),
    KERNEL(select(x == x, x, y)),
    KERNEL(select(x != x, 1.0f, 0.0f)),
    KERNEL(select(x < 0.0f, negate(x), x)),
    KERNEL(select(x < 0.0f, 0.0f, select(x > 1.0f, 1.0f, x))),
    KERNEL(to_float(to_int(select(abs(x) < 8388608.0f, x, 0.0f)))),
    KERNEL((x < y) & (y < z)),
    KERNEL((x < y) | !(y >= z)),
    KERNEL(select((x < y) ^ (i < j), x, select(unsigned_less(i, j), y, z))),
    KERNEL(x * y + z),
    KERNEL(x * y - z),
    KERNEL(z - x * y),
    KERNEL(1.0f / sqrt(x)),

    // Uniform operands.
    KERNEL(a + s),
    KERNEL(s - a),
    KERNEL(a * 0.5f),
    KERNEL(s / a),
    KERNEL(a < s),
    KERNEL(s == a),
    KERNEL(s != a),
    KERNEL(select(p, a, s)),
    KERNEL(select(p, s, a)),
    KERNEL(select(p, s, 2.0f)),
    KERNEL(select(p, m, 7)),
    KERNEL(select(p, i, m)),
    KERNEL(select(p, true, false)),
    KERNEL(select(p, t, q)),
    KERNEL(select(t, p, q)),
    KERNEL(select(t, i, j)),
    KERNEL(i + m),
    KERNEL(m - i),
    KERNEL(i * m),
    KERNEL((i & 0x7fffff) | 0x3f800000),
    KERNEL(i < m),
    KERNEL(m == i),
    KERNEL(unsigned_less(i, m)),
    KERNEL(mul_hi(i, m)),
    KERNEL(shift_left(i, m & 31)),
    KERNEL(shift_right(i, m & 31)),
    KERNEL(shift_right_signed(i, m & 31)),
    KERNEL(shift_left(i, 23)),
    KERNEL(shift_right(i, 23)),
    KERNEL(shift_right_signed(i, 31)),
    KERNEL(p & t),
    KERNEL(p | t),

    // Memory.
    KERNEL(load(floats, i)),
    KERNEL(load(ints, i)),
    KERNEL(load(floats, n)),
    KERNEL(load(ints, n)),
    KERNEL(F(load(floats, m))),
    KERNEL(lane_index<I>() + row),

    // Branches.
    KERNEL(branch(p, [&] { return a + b; }, [&] { return a * b; })),
    KERNEL(branch(t, [&] { return a + b; }, [&] { return a * b; })),
    KERNEL(branch(a < s, [&] { return i; }, [&] { return j; })),
    KERNEL(branch(p, [&] { return a < b; }, [&] { return q; })),
    KERNEL(branch(p, [&] { return a; }, [&] { return s; })),
    KERNEL(F(branch(t, [&] { return a; }, [&] { return s; }))),
    KERNEL(branch(p, [&] { return vec3<F>(a, b, c); }, [&] { return vec3<float>(s, s, 1.0f); }).y),

    // Vectors.
    KERNEL((vec2<F>(a, b) + vec2<F>(b, c)).x),
    KERNEL((vec2<F>(a, b) - vec2<F>(b, c)).y),
    KERNEL((vec2<F>(a, b) * vec2<float>(s, s)).y),
    KERNEL((vec2<F>(a, b) / vec2<F>(b, c))[0]),
    KERNEL(sqrt(negate(floor(abs(vec2<F>(a, b))))).y),
    KERNEL(select(p, vec2<F>(a, b), vec2<F>(b, c)).y),
    KERNEL(select(p, vec2<float>(s, 1.0f), vec2<float>(2.0f, s)).y),
    KERNEL((vec3<F>(a, b, c) + vec3<F>(b, c, a)).x),
    KERNEL((vec3<F>(a, b, c) - vec3<F>(b, c, a))[1]),
    KERNEL((vec3<F>(a, b, c) * vec3<F>(b, c, a)).z),
    KERNEL((vec3<float>(1.0f, s, 2.0f) / vec3<F>(b, c, a)).y),
    KERNEL(abs(vec3<F>(a, b, c))[2]),
    KERNEL(sqrt(vec3<F>(a, b, c)).y),
    KERNEL(negate(floor(vec3<F>(a, b, c))).x),
    KERNEL(select(p, vec3<F>(a, b, c), vec3<F>(b, c, a)).z),
    KERNEL(select(t, vec3<F>(a, b, c), vec3<F>(b, c, a)).z),
    KERNEL((vec4<F>(a, b, c, s) + vec4<F>(b, c, a, a)).w),
    KERNEL((vec4<F>(a, b, c, s) - vec4<F>(b, c, a, a)).z),
    KERNEL((vec4<F>(a, b, c, s) * vec4<F>(b, c, a, a)).y),
    KERNEL((vec4<F>(a, b, c, s) / vec4<F>(b, c, a, a))[3]),
    KERNEL(abs(floor(vec4<F>(a, b, c, s))).w),
    KERNEL(negate(sqrt(vec4<F>(a, b, c, s))).x),
    KERNEL(select(p, vec4<F>(a, b, c, s), vec4<F>(b, c, a, a)).w),
    KERNEL(vec4<F>(vec4<float>(s, 1.0f, 2.0f, s)).w),
};
// clang-format on

void copy(const float* from, float* to, int count) {
  for (int at = 0; at < count; at += lane_count<F>) store_lanes(to + at, load_lanes<F>(from + at));
}

void copy_pixels(const float* from, int stride, float* to, int count) {
  const auto channel = [&](int c) { return load_lanes<F>(from + c * stride); };
  store_pixels(to, channel(0), channel(1), channel(2), channel(3), count);
}

void count_branch_sides(const int* conditions, int* then_count, int* other_count) {
  int then_calls = 0, other_calls = 0;
  const B condition = load_lanes<I>(conditions) != 0;
  branch(
      condition, [&] { return ++then_calls, F(1.0f); }, [&] { return ++other_calls, F(2.0f); });
  *then_count = then_calls;
  *other_count = other_calls;
}

const KernelTable table = {lane_count<F>, kernels, sizeof(kernels) / sizeof(kernels[0]), copy, copy_pixels,
                           count_branch_sides};

}  // namespace

const KernelTable& LANES_TABLE() { return table; }

}  // namespace isoshade::lanes::test
