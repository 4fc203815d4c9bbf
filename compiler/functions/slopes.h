// SPDX-License-Identifier: Apache-2.0
// Helpers of the DERIVATIVE rows of functions.def.
#pragma once

#include "compiler/functions/noise.h"
#include "compiler/functions/power.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// The derivative of x^y with respect to x. At x = 0 it is 1 for y = 1, else 0, even where it is infinite.
template <class F>
F power_slope(F x, F y) {
  const F at_zero = select(y == 1.0f, F(1.0f), F(0.0f));
  return select(x > 0.0f, y * pow(x, y - 1.0f), at_zero);
}

/// part / (y^2 + x^2), 0 at the origin.
template <class F>
F angle_slope(F part, F y, F x) {
  const F square = y * y + x * x;
  return select(square > 0.0f, part / square, F(0.0f));
}

/// The change of v / |v| if v changes by d: the component of d perpendicular to v, divided by |v|; 0 if v is 0.
template <class F, int N>
vec<F, N> normalize_change(vec<F, N> v, vec<F, N> d) {
  const vec<F, N> unit = normalize(v);
  const F size = length(v);
  const vec<F, N> across = d - unit * splat<N>(dot(unit, d));
  return componentwise([&](F c) { return select(size > 0.0f, c / size, F(0.0f)); }, across);
}

/// v, rotated clockwise by 90 degrees.
template <class F>
vec<F, 2> rotate_right(vec<F, 2> v) {
  return {v[1], negate(v[0])};
}

/// x, negated if this bit of the hash is set. Unlike negate_by_bit, allows NaN, because changes may be NaN.
template <class F>
F negated_by_bit(F x, int_of<F> hash, int bit) {
  return select((hash & (1 << bit)) == 0, x, negate(x));
}

/// A dual number: a value and its change.
template <class F>
struct Dual {
  F value;
  F change;
};

template <class F>
Dual<F> mix(Dual<F> a, Dual<F> b, Dual<F> t) {
  return {mix(a.value, b.value, t.value), mix(a.change, b.change, t.value) + (b.value - a.value) * t.change};
}

template <class F>
Dual<F> fade(Dual<F> t) {
  const F rise = t.value * (1.0f - t.value);
  return {fade(t.value), (rise * rise) * (t.change * 30.0f)};
}

/// The change of `gradient`, which is linear in its arguments.
template <class F>
F gradient_change(int_of<F> hash, F dx, F dy) {
  const auto flat = (hash & 4) == 0;
  const F once = select(flat, dx, dy);
  const F twice = select(flat, dy, dx) * 2.0f;
  return negated_by_bit(once, hash, 0) + negated_by_bit(twice, hash, 1);
}
template <class F>
F gradient_change(int_of<F> hash, F dx, F dy, F dz) {
  const F first = select((hash & 8) == 0, dx, dy);
  const F other = select((hash & 13) == 12, dx, dz);
  const F second = select((hash & 12) == 0, dy, other);
  return negated_by_bit(first, hash, 0) + negated_by_bit(second, hash, 1);
}

/// The change of a noise channel if the point moves by d.
template <class F>
F channel_change(const Square<F>& square, int bit, vec<F, 2> d) {
  const F dx = d[0];
  const F dy = d[1];
  const F x1 = square.x - 1.0f;
  const F y1 = square.y - 1.0f;
  const auto corner = [&](int i, F x, F y) {
    const auto hash = bit == 0 ? square.hashes[i] : shift_right(square.hashes[i], bit);
    return Dual<F>{gradient(hash, x, y), gradient_change(hash, dx, dy)};
  };
  const Dual<F> across = fade(Dual<F>{square.x, dx});
  const Dual<F> near = mix(corner(0, square.x, square.y), corner(1, x1, square.y), across);
  const Dual<F> far = mix(corner(2, square.x, y1), corner(3, x1, y1), across);
  return mix(near, far, fade(Dual<F>{square.y, dy})).change * 0.6616f;
}

template <class F>
F channel_change(const Cube<F>& cube, int bit, vec<F, 3> d) {
  const F dx = d[0];
  const F dy = d[1];
  const F dz = d[2];
  const F x1 = cube.x - 1.0f;
  const F y1 = cube.y - 1.0f;
  const F z1 = cube.z - 1.0f;
  const Dual<F> across = fade(Dual<F>{cube.x, dx});
  const auto edge = [&](int i, F y, F z) {
    const auto corner = [&](int k, F x) {
      const auto hash = bit == 0 ? cube.hashes[k] : shift_right(cube.hashes[k], bit);
      return Dual<F>{gradient(hash, x, y, z), gradient_change(hash, dx, dy, dz)};
    };
    return mix(corner(i, cube.x), corner(i + 1, x1), across);
  };
  const Dual<F> down = fade(Dual<F>{cube.y, dy});
  const Dual<F> near = mix(edge(0, cube.y, cube.z), edge(2, y1, cube.z), down);
  const Dual<F> far = mix(edge(4, cube.y, z1), edge(6, y1, z1), down);
  return mix(near, far, fade(Dual<F>{cube.z, dz})).change * 0.982f;
}

template <class F>
F noise_change(vec<F, 2> p, vec<F, 2> d) {
  return channel_change(Square<F>(p), 0, d);
}
template <class F>
F noise_change(vec<F, 3> p, vec<F, 3> d) {
  return channel_change(Cube<F>(p), 0, d);
}
template <class F>
vec<F, 3> noise_change_vector3(vec<F, 2> p, vec<F, 2> d) {
  const Square<F> square(p);
  return {channel_change(square, 0, d), channel_change(square, 8, d), channel_change(square, 16, d)};
}
template <class F>
vec<F, 3> noise_change_vector3(vec<F, 3> p, vec<F, 3> d) {
  const Cube<F> cube(p);
  return {channel_change(cube, 0, d), channel_change(cube, 8, d), channel_change(cube, 16, d)};
}

}  // namespace isoshade::functions
