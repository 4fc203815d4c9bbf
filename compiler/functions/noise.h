// SPDX-License-Identifier: Apache-2.0
// Gradient noise. Perlin, "Improving noise", 2002; gradients, hashes and scales are those of Open Shading Language and
// MaterialX. Three channels use three bytes of one hash.
#pragma once

#include <tuple>

#include "compiler/functions/blending.h"
#include "compiler/functions/cell.h"

namespace isoshade::functions {

/// 6t^5 - 15t^4 + 10t^3: rises from 0 to 1, with zero first and second derivatives at both ends. Expanded about
/// t = 0.5, where the terms do not cancel, which is ten times as accurate.
template <class F>
F fade(F t) {
  const F s = t - 0.5f;
  const F z = s * s;
  return ((z * 6.0f - 5.0f) * z + 1.875f) * s + 0.5f;
}

/// x, negated if this bit of the hash is set. x must not be NaN.
template <class F>
F negate_by_bit(F x, int_of<F> hash, int bit) {
  return from_bits_normal(bits_nonnan(x) ^ (shift_left(hash, 31 - bit) & sign_bit));
}

/// The dot product of (x, y) with one of (+-1, +-2) and (+-2, +-1), chosen by the lowest 3 bits.
template <class F>
F gradient(int_of<F> hash, F x, F y) {
  const auto flat = (hash & 4) == 0;
  const F once = select(flat, x, y);
  const F twice = select(flat, y, x) * 2.0f;
  return negate_by_bit(once, hash, 0) + negate_by_bit(twice, hash, 1);
}

/// The dot product of (x, y, z) with one of the 12 vectors to the midpoints of a cube's edges, chosen by the lowest 4
/// bits (four vectors have two codes).
template <class F>
F gradient(int_of<F> hash, F x, F y, F z) {
  const F first = select((hash & 8) == 0, x, y);
  const F other = select((hash & 13) == 12, x, z);
  const F second = select((hash & 12) == 0, y, other);
  return negate_by_bit(first, hash, 0) + negate_by_bit(second, hash, 1);
}

/// The grid cell around a point in the plane; corners in the order 00, 10, 01, 11 (x first).
template <class F>
struct Square {
  int_of<F> hashes[4];
  F x, y;

  explicit Square(vec<F, 2> p) : Square(split_cell(p[0]), split_cell(p[1])) {}

  /// The noise channel whose gradients use the hash from this bit.
  F channel(int bit) const {
    const F x1 = x - 1.0f;
    const F y1 = y - 1.0f;
    const auto corner = [&](int i, F dx, F dy) {
      return gradient(bit == 0 ? hashes[i] : shift_right(hashes[i], bit), dx, dy);
    };
    const F across = fade(x);
    const F near = mix(corner(0, x, y), corner(1, x1, y), across);
    const F far = mix(corner(2, x, y1), corner(3, x1, y1), across);
    return mix(near, far, fade(y)) * 0.6616f;
  }

 private:
  Square(InCell<F> a, InCell<F> b)
      : hashes{hash(a.cell, b.cell), hash(a.cell + 1, b.cell), hash(a.cell, b.cell + 1),
               hash(a.cell + 1, b.cell + 1)},
        x(a.fraction),
        y(b.fraction) {}
};

/// The grid cell around a point in space; bits 0, 1 and 2 of a corner's index are its x, y and z.
template <class F>
struct Cube {
  using Int = int_of<F>;

  Int hashes[8];
  F x, y, z;

  explicit Cube(vec<F, 3> p) : Cube(split_cell(p[0]), split_cell(p[1]), split_cell(p[2])) {}

  /// The noise channel whose gradients use the hash from this bit.
  F channel(int bit) const {
    const F x1 = x - 1.0f;
    const F y1 = y - 1.0f;
    const F z1 = z - 1.0f;
    const F across = fade(x);
    const auto edge = [&](int i, F dy, F dz) {
      const auto corner = [&](int k, F dx) {
        return gradient(bit == 0 ? hashes[k] : shift_right(hashes[k], bit), dx, dy, dz);
      };
      return mix(corner(i, x), corner(i + 1, x1), across);
    };
    const F down = fade(y);
    const F near = mix(edge(0, y, z), edge(2, y1, z), down);
    const F far = mix(edge(4, y, z1), edge(6, y1, z1), down);
    return mix(near, far, fade(z)) * 0.982f;
  }

 private:
  Cube(InCell<F> a, InCell<F> b, InCell<F> c) : Cube(a, b, c, a.cell + 1, b.cell + 1, c.cell + 1) {}
  Cube(InCell<F> a, InCell<F> b, InCell<F> c, Int a1, Int b1, Int c1)
      : hashes{hash(a.cell, b.cell, c.cell), hash(a1, b.cell, c.cell), hash(a.cell, b1, c.cell),
               hash(a1, b1, c.cell),         hash(a.cell, b.cell, c1), hash(a1, b.cell, c1),
               hash(a.cell, b1, c1),         hash(a1, b1, c1)},
        x(a.fraction),
        y(b.fraction),
        z(c.fraction) {}
};

/// Gradient noise in the plane: smooth, roughly in [-1, 1], 0 at integer coordinates.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 2 ULP of 1.
template <class F>
F noise2d(vec<F, 2> p) {
  return Square<F>(p).channel(0);
}

/// Gradient noise in the plane with three channels; the first is noise2d.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 2 ULP of 1, in each component.
template <class F>
vec<F, 3> noise2d_vector3(vec<F, 2> p) {
  const Square<F> square(p);
  return {square.channel(0), square.channel(8), square.channel(16)};
}

/// Gradient noise in space: smooth, roughly in [-1, 1], 0 at integer coordinates.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 2 ULP of 1.
template <class F>
F noise3d(vec<F, 3> p) {
  return Cube<F>(p).channel(0);
}

/// Gradient noise in space with three channels; the first is noise3d.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 2 ULP of 1, in each component.
template <class F>
vec<F, 3> noise3d_vector3(vec<F, 3> p) {
  const Cube<F> cube(p);
  return {cube.channel(0), cube.channel(8), cube.channel(16)};
}

inline constexpr int most_octaves = 16;

/// The sum of `octaves` terms: noise3d(p) + diminish * noise3d(lacunarity * p) + diminish^2 * noise3d(lacunarity^2 * p)
/// + ...
/// Domain: all floats. `octaves` is rounded up and limited to 16; 0 or NaN octaves give 0. Scaled coordinates from 2^31
/// count as 0; an infinite or NaN amplitude gives NaN.
/// Error: 2 ULP of the sum of |diminish^i| (1 + i |p_i|), where p_i is the i-th octave's point.
template <class F>
F fractal3d(vec<F, 3> p, F octaves, F lacunarity, F diminish) {
  using Int = int_of<F>;
  const auto octave = [&](Int i, F sum, F amplitude, vec<F, 3> at) {
    return branch(
        to_float(i) < octaves,
        [&] {
          return std::tuple(sum + noise3d(at) * amplitude, amplitude * diminish, at * splat<3>(lacunarity));
        },
        [&] { return std::tuple(sum, amplitude, at); });
  };
  // -0 + x is x, for every x.
  const F sum = std::get<0>(loop(Int(most_octaves), octave, F(-0.0f), F(1.0f), p));
  return select(octaves > 0.0f, sum, F(0.0f));
}

/// fractal3d with three channels.
/// Domain: all floats. `octaves` is rounded up and limited to 16; 0 or NaN octaves give 0. Scaled coordinates from 2^31
/// count as 0; an infinite or NaN amplitude gives NaN.
/// Error: 2 ULP of the sum of |diminish^i| (1 + i |p_i|), where p_i is the i-th octave's point.
template <class F>
vec<F, 3> fractal3d_vector3(vec<F, 3> p, F octaves, F lacunarity, F diminish) {
  using Int = int_of<F>;
  const auto octave = [&](Int i, F x, F y, F z, F amplitude, vec<F, 3> at) {
    return branch(
        to_float(i) < octaves,
        [&] {
          const vec<F, 3> noise = noise3d_vector3(at);
          return std::tuple(x + noise[0] * amplitude, y + noise[1] * amplitude, z + noise[2] * amplitude,
                            amplitude * diminish, at * splat<3>(lacunarity));
        },
        [&] { return std::tuple(x, y, z, amplitude, at); });
  };
  const auto sums = loop(Int(most_octaves), octave, F(-0.0f), F(-0.0f), F(-0.0f), F(1.0f), p);
  const auto some = [&](F sum) { return select(octaves > 0.0f, sum, F(0.0f)); };
  return {some(std::get<0>(sums)), some(std::get<1>(sums)), some(std::get<2>(sums))};
}

}  // namespace isoshade::functions
