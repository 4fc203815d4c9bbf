// SPDX-License-Identifier: Apache-2.0
// Sine, cosine and tangent over all floats. Angles up to `near_angle` are reduced in floats, larger ones in integers,
// which are computed only if a lane has such an angle.
#pragma once

#include "compiler/functions/sums.h"

namespace isoshade::functions {

inline constexpr float near_angle = 0x1p13f;

/// An angle as quarter turns (modulo 4) and a rest r + r_low, approximately in [-pi/4, pi/4].
template <class F>
struct Reduced {
  int_of<F> quadrant;
  F r;
  F r_low;
};

/// An angle as a quadrant and the sine and cosine of a rest in [-pi/4, pi/4].
template <class F>
struct Angle {
  int_of<F> quadrant;
  F sine;
  F cosine;
};

/// sin(r) = r + r * sine_excess(r * r) for r in [-pi/4, pi/4].
/// Source: polynomials by Sollya's fpminimax.
template <class F>
F sine_excess(F z) {
  return z * polynomial(z, {-0x1.9ab41ap-13f, 0x1.110be6p-7f, -0x1.555552p-3f});
}

/// cos(r) = cosine_of_square(r * r) for r in [-pi/4, pi/4].
template <class F>
F cosine_of_square(F z) {
  return (z * z) * polynomial(z, {0x1.9bc77ap-16f, -0x1.6c129ep-10f, 0x1.555554p-5f}) + (1.0f - z * 0.5f);
}

/// Reduces an angle in radians, |x| <= near_angle.
/// Source: Cody and Waite's reduction by pi/2 in four parts; the products with the first three are exact.
template <class F>
Reduced<F> reduce_near(F x) {
  const F turns = floor(x * 0.636619747f + 0.5f);
  const F coarse = (x - turns * 0x1.92p0f) - turns * 0x1.fb4p-12f;
  const F third = turns * 0x1.444p-24f;
  const F r = coarse - third;
  const F r_low = ((coarse - r) - third) - turns * 0x1.68c234p-39f;
  return {to_int(turns), r, r_low};
}

/// Reduces an angle in radians, near_angle <= |x|. Infinities and NaN give an unspecified angle.
/// Source: Payne and Hanek, "Radian reduction for trigonometric functions", 1983. x is an integer m times 2^k. Of the
/// bits of 2/pi, those that contribute only multiples of 4 to 2^k m 2/pi and those after the next 96 are dropped; m
/// times the rest is a fixed-point number with 2 bits for the quadrant and 62 for the fraction. Every float differs
/// from all multiples of pi/2 by at least 2^-30 of a quarter turn, so at least 32 significant bits remain.
template <class F>
Reduced<F> reduce_far(F x) {
  using Int = int_of<F>;
  // 2/pi, beginning with the bit of weight 2^11, the first one needed for k = -10.
  constexpr int two_over_pi[] = {0x000a2f98,  0x36e4e441, 0x529fc275, 0x7d1f534d, static_cast<int>(0xdc0db629u),
                                 0x5993c439,  0x041fe516};
  const Int pattern = bits(x);
  const Int skipped = (shift_right(pattern, 23) & 255) - 140;  // bits of two_over_pi: k + 10
  const Int m = (pattern & fraction_mask) | implicit_bit;

  const auto two_words = (skipped & 64) != 0;
  const auto one_word = (skipped & 32) != 0;
  const auto of_two = [&](int i) { return select(two_words, Int(two_over_pi[i + 2]), Int(two_over_pi[i])); };
  const Int words[] = {of_two(0), of_two(1), of_two(2), of_two(3), of_two(4)};
  const auto of_one = [&](int i) { return select(one_word, words[i + 1], words[i]); };
  const Int from[] = {of_one(0), of_one(1), of_one(2), of_one(3)};
  const Int shift = skipped & 31;
  const auto shifted = [&](int i) {
    return shift_left(from[i], shift) | shift_right(shift_right(from[i + 1], 1), 31 - shift);
  };
  const Int high_bits = shifted(0);
  const Int middle_bits = shifted(1);
  const Int low_bits = shifted(2);

  // The upper 64 of the lower 96 bits of the product: the quarter turns modulo 4, times 2^62.
  const Int carried = unsigned_mul_hi(low_bits, m);
  const Int lower = middle_bits * m + carried;
  const Int carry = select(unsigned_less(lower, carried), Int(1), Int(0));
  const Int upper = (high_bits * m + unsigned_mul_hi(middle_bits, m)) + carry;
  const Int quadrant = shift_right(upper + 0x20000000, 30);
  const Int rest = upper - shift_left(quadrant, 30);

  // Converts the rest in pieces of 22, 20 and 20 bits, each exact as a float, and sums them.
  const F first = to_float(shift_right_signed(rest, 8)) * 0x1p20f;
  const F second = to_float(shift_left(rest & 255, 12) | shift_right(lower, 20));
  const F third = to_float(lower & 0xfffff) * 0x1p-20f;
  const Sum<F> sum = quick_two_sum(first, second);
  const F low = sum.low + third;
  const Sum<F> product = two_product_by(sum.high, 0x1.921fb6p-42f);
  const F product_low = product.low + (sum.high * -0x1.777a5cp-67f + low * 0x1.921fb6p-42f);
  const Sum<F> r = quick_two_sum(product.high, product_low);

  const auto negative = pattern < 0;
  return {select(negative, 0 - quadrant, quadrant), select(negative, negate(r.high), r.high),
          select(negative, negate(r.low), r.low)};
}

template <class F>
Angle<F> angle_of(const Reduced<F>& reduced) {
  const F z = reduced.r * reduced.r;
  return {reduced.quadrant, (sine_excess(z) * reduced.r + reduced.r_low) + reduced.r, cosine_of_square(z)};
}

/// near() for angles up to near_angle, far() for larger ones, NaN for infinities and NaN.
template <class F, class Near, class Far>
F by_size_of_angle(F x, Near near, Far far) {
  const F size = abs(x);
  return branch(size <= near_angle, near,
                [&] { return select(size < infinity, F(far()), F(not_a_number)); });
}

/// Sine (quarters = 0) or cosine (quarters = 1).
template <class F>
F sine_of(const Angle<F>& angle, int quarters) {
  const auto q = quarters == 0 ? angle.quadrant : angle.quadrant + quarters;
  const F magnitude = select((q & 1) == 0, angle.sine, angle.cosine);
  return from_bits_normal(bits_nonnan(magnitude) ^ shift_left(q & 2, 30));
}

template <class F>
F sine(F x, int quarters) {
  return by_size_of_angle(
      x, [&] { return sine_of(angle_of(reduce_near(x)), quarters); },
      [&] { return sine_of(angle_of(reduce_far(x)), quarters); });
}

/// The sine of x in radians.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 1.75 ULP.
template <class F>
F sin(F x) {
  return sine(x, 0);
}

/// The cosine of x in radians.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 1.75 ULP.
template <class F>
F cos(F x) {
  return sine(x, 1);
}

template <class F>
F tangent_of(const Angle<F>& angle) {
  const auto even = (angle.quadrant & 1) == 0;
  return select(even, angle.sine, negate(angle.cosine)) / select(even, angle.cosine, angle.sine);
}

/// The tangent of x in radians.
/// Domain: all floats; infinities and NaN give NaN. Never overflows: no float is close enough to a pole.
/// Error: 3.5 ULP.
template <class F>
F tan(F x) {
  return by_size_of_angle(
      x, [&] { return tangent_of(angle_of(reduce_near(x))); },
      [&] { return tangent_of(angle_of(reduce_far(x))); });
}

inline constexpr float near_degrees = 0x1p22f;

/// Splits an angle in degrees, |x| <= near_degrees; multiples of 90 degrees are exact.
template <class F>
Angle<F> split_degrees(F x) {
  const F turns = floor(x * 0.0111111114f + 0.5f);
  const F r = (x - turns * 90.0f) * 0.0174532924f;
  const F z = r * r;
  return {to_int(turns), sine_excess(z) * r + r, cosine_of_square(z)};
}

/// x modulo 720, for 0 <= x < 2^25.
template <class Int>
Int modulo_720(Int x) {
  const Int rest = x - unsigned_mul_hi(x, Int(5965232)) * 720;  // 2^32 / 720
  return select(rest >= 720, rest - 720, rest);
}

/// Removes full turns from an angle in degrees, exactly; |x| > near_degrees. Infinities and NaN give an unspecified
/// angle. x is an integer times 2^k half degrees. As 720 = 16 * 45 and 2^12 = 1 modulo 45, 2^k = 2^(k - 12) modulo 720
/// if both exponents are at least 4.
template <class F>
F without_turns(F x) {
  using Int = int_of<F>;
  const Int pattern = bits(x);
  const Int k = (shift_right(pattern, 23) & 255) - 149;
  const Int above_4 = k - 4;
  const Int twelves = shift_right(above_4 * 43, 9);  // above_4 / 12, for 0 <= above_4 <= 102
  const Int power = select(k < 4, k, k - twelves * 12);
  const Int half_degrees = modulo_720(shift_left(modulo_720((pattern & fraction_mask) | implicit_bit), power & 15));
  const F degrees = to_float(half_degrees) * 0.5f;
  return select(pattern < 0, negate(degrees), degrees);
}

/// v, rotated clockwise by the angle.
template <class F>
vec<F, 2> turned(vec<F, 2> v, const Angle<F>& angle) {
  const F s = sine_of(angle, 0);
  const F c = sine_of(angle, 1);
  return {v[0] * c + v[1] * s, v[1] * c - v[0] * s};
}

/// v, rotated clockwise (from +y to +x) by an angle in degrees. Multiples of 90 degrees are exact.
/// Domain: all floats. An infinite or NaN angle gives NaN.
/// Error: 2.5 ULP of |v.x| + |v.y|, in each component.
template <class F>
vec<F, 2> rotate2d(vec<F, 2> v, F degrees) {
  const F size = abs(degrees);
  return branch(
      size <= near_degrees, [&] { return turned(v, split_degrees(degrees)); },
      [&] {
        const vec<F, 2> far = turned(v, split_degrees(without_turns(degrees)));
        return vec<F, 2>(select(size < infinity, far[0], F(not_a_number)),
                         select(size < infinity, far[1], F(not_a_number)));
      });
}

/// Transforms texture coordinates so that the image appears scaled by `scale` and rotated clockwise by `degrees` about
/// `pivot`, then moved by `offset`: rotate2d((texcoord - pivot) / scale, degrees) - offset + pivot.
/// Domain: all floats. A zero in `scale` gives infinities or NaN; an infinite or NaN angle gives NaN.
/// Error: 4 ULP of the sum of the terms' magnitudes, in each component.
template <class F>
vec<F, 2> place2d(vec<F, 2> texcoord, vec<F, 2> pivot, vec<F, 2> scale, F degrees, vec<F, 2> offset) {
  return (rotate2d((texcoord - pivot) / scale, degrees) - offset) + pivot;
}

}  // namespace isoshade::functions
