// SPDX-License-Identifier: Apache-2.0
// What the changes in functions.def are written with: slopes that take more than a line.
#pragma once

#include "compiler/functions/noise.h"
#include "compiler/functions/power.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// Of x^y along x. At x = 0 it is 1 for y = 1, and else 0, where it would be infinite too.
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

/// Of v / |v| where v changes by d: what of d is across v, over |v|. 0 where v is.
template <class F, int N>
vec<F, N> normalize_change(vec<F, N> v, vec<F, N> d) {
  const vec<F, N> unit = normalize(v);
  const F size = length(v);
  const vec<F, N> across = d - unit * splat<N>(dot(unit, d));
  return componentwise([&](F c) { return select(size > 0.0f, c / size, F(0.0f)); }, across);
}

/// A quarter turn clockwise.
template <class F>
vec<F, 2> turned_right(vec<F, 2> v) {
  return {v[1], negate(v[0])};
}

/// x, negated where this bit is set. As negate_by_bit, for NaN too: changes may be anything.
template <class F>
F negated_by_bit(F x, int_of<F> hash, int bit) {
  return select((hash & (1 << bit)) == 0, x, negate(x));
}

/// A value and what it changes by.
template <class F>
struct Moving {
  F value;
  F change;
};

template <class F>
Moving<F> mix(Moving<F> a, Moving<F> b, Moving<F> t) {
  return {mix(a.value, b.value, t.value), mix(a.change, b.change, t.value) + (b.value - a.value) * t.change};
}

template <class F>
Moving<F> fade(Moving<F> t) {
  const F rise = t.value * (1.0f - t.value);
  return {fade(t.value), (rise * rise) * (t.change * 30.0f)};
}

/// `gradient` of changes: it is linear.
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

/// A channel of the noise around a point that moves by d.
template <class F>
F channel_change(const Square<F>& square, int bit, vec<F, 2> d) {
  const F dx = d[0];
  const F dy = d[1];
  const F x1 = square.x - 1.0f;
  const F y1 = square.y - 1.0f;
  const auto corner = [&](int i, F x, F y) {
    const auto hash = bit == 0 ? square.hashes[i] : shift_right(square.hashes[i], bit);
    return Moving<F>{gradient(hash, x, y), gradient_change(hash, dx, dy)};
  };
  const Moving<F> across = fade(Moving<F>{square.x, dx});
  const Moving<F> near = mix(corner(0, square.x, square.y), corner(1, x1, square.y), across);
  const Moving<F> far = mix(corner(2, square.x, y1), corner(3, x1, y1), across);
  return mix(near, far, fade(Moving<F>{square.y, dy})).change * 0.6616f;
}

template <class F>
F channel_change(const Cube<F>& cube, int bit, vec<F, 3> d) {
  const F dx = d[0];
  const F dy = d[1];
  const F dz = d[2];
  const F x1 = cube.x - 1.0f;
  const F y1 = cube.y - 1.0f;
  const F z1 = cube.z - 1.0f;
  const Moving<F> across = fade(Moving<F>{cube.x, dx});
  const auto edge = [&](int i, F y, F z) {
    const auto corner = [&](int k, F x) {
      const auto hash = bit == 0 ? cube.hashes[k] : shift_right(cube.hashes[k], bit);
      return Moving<F>{gradient(hash, x, y, z), gradient_change(hash, dx, dy, dz)};
    };
    return mix(corner(i, cube.x), corner(i + 1, x1), across);
  };
  const Moving<F> down = fade(Moving<F>{cube.y, dy});
  const Moving<F> near = mix(edge(0, cube.y, cube.z), edge(2, y1, cube.z), down);
  const Moving<F> far = mix(edge(4, cube.y, z1), edge(6, y1, z1), down);
  return mix(near, far, fade(Moving<F>{cube.z, dz})).change * 0.982f;
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
