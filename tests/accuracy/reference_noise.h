// SPDX-License-Identifier: Apache-2.0
// Noises as their sources define them, with 64 bits of significand: hashes over words, sums over corners.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "tests/accuracy/reference.h"

namespace isoshade::reference {

/// hashword() of Jenkins's "lookup3.c", for up to three words and the initial value 13.
template <size_t N>
uint32_t hash_words(std::array<int64_t, N> words) {
  std::array<uint32_t, 3> s;
  s.fill(0xdeadbeefu + 4 * static_cast<uint32_t>(N) + 13);
  for (size_t i = 0; i < N; ++i) s[i] += static_cast<uint32_t>(words[i]);
  uint32_t &a = s[0], &b = s[1], &c = s[2];
  const auto step = [](uint32_t& to, uint32_t from, int r) { to = (to ^ from) - std::rotl(from, r); };
  step(c, b, 14), step(a, c, 11), step(b, a, 25), step(c, b, 16), step(a, c, 4), step(b, a, 14),
      step(c, b, 24);
  return c;
}

inline int64_t cell_of(Real x) { return static_cast<int64_t>(floor(x)); }
inline Real unit_of(uint32_t bits) { return static_cast<Real>(bits >> 8) * 0x1p-24L; }

inline Real cellnoise2d(Vector<2> p) { return unit_of(hash_words<2>({cell_of(p[0]), cell_of(p[1])})); }
inline Real cellnoise3d(Vector<3> p) {
  return unit_of(hash_words<3>({cell_of(p[0]), cell_of(p[1]), cell_of(p[2])}));
}

inline Real fade(Real t) { return t * t * t * (t * (t * 6 - 15) + 10); }

constexpr int plane_gradients[8][2] = {{1, 2}, {-1, 2}, {1, -2}, {-1, -2},
                                       {2, 1}, {2, -1}, {-2, 1}, {-2, -1}};
constexpr int space_gradients[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1}};

/// Perlin's noise in three channels: the sum over the corners of the point's cell.
template <int N>
Vector<3> gradient_noise(Vector<N> p, Real scale) {
  Vector<3> sum{};
  for (int corner = 0; corner < 1 << N; ++corner) {
    std::array<int64_t, N> at;
    Vector<N> offset;
    Real weight = scale;
    for (int i = 0; i < N; ++i) {
      at[i] = cell_of(p[i]) + (corner >> i & 1);
      offset.c[i] = p[i] - static_cast<Real>(at[i]);
      weight *= fade(1 - abs(offset[i]));
    }
    const uint32_t hash = hash_words<N>(at);
    for (int channel = 0; channel < 3; ++channel) {
      const uint32_t bits = hash >> 8 * channel;
      Real product = 0;
      for (int i = 0; i < N; ++i)
        product += offset[i] * (N == 2 ? plane_gradients[bits & 7][i % 2] : space_gradients[bits & 15][i]);
      sum.c[channel] += weight * product;
    }
  }
  return sum;
}
inline Vector<3> noise2d(Vector<2> p) { return gradient_noise(p, 0.6616L); }
inline Vector<3> noise3d(Vector<3> p) { return gradient_noise(p, 0.982L); }

/// The sum of term(point, amplitude, index) over the octaves.
template <class Term>
Vector<3> sum_octaves(Vector<3> p, Real octaves, Real lacunarity, Real diminish, Term term) {
  Vector<3> sum{};
  Real amplitude = 1;
  for (int i = 0; i < std::min<Real>(octaves, 16); ++i) {
    sum = sum + term(p, amplitude, i);
    amplitude *= diminish;
    p = p * lacunarity;
  }
  return sum;
}
inline Vector<3> fractal3d(Vector<3> p, Real octaves, Real lacunarity, Real diminish) {
  return sum_octaves(p, octaves, lacunarity, diminish,
                     [](Vector<3> at, Real amplitude, int) { return noise3d(at) * amplitude; });
}
inline Vector<3> fractal3d_magnitude(Vector<3> p, Real octaves, Real lacunarity, Real diminish) {
  return sum_octaves(p, octaves, lacunarity, diminish, [](Vector<3> at, Real amplitude, int i) {
    return Vector<3>{{1, 1, 1}} * (amplitude * (1 + i * length(at)));
  });
}

/// The three least distances to the feature points of nine squares.
inline Vector<3> worleynoise2d(Vector<2> p, Real jitter) {
  std::array<Real, 9> distances;
  for (int i = 0; i < 9; ++i) {
    const int64_t x = cell_of(p[0]) + i % 3 - 1, y = cell_of(p[1]) + i / 3 - 1;
    const Vector<2> point{
        {static_cast<Real>(x) + (unit_of(hash_words<3>({x, y, 0})) - 0.5L) * jitter + 0.5L,
         static_cast<Real>(y) + (unit_of(hash_words<3>({x, y, 1})) - 0.5L) * jitter + 0.5L}};
    distances[i] = length(point - p);
  }
  std::ranges::sort(distances);
  return {{distances[0], distances[1], distances[2]}};
}

inline Real ones(Real) { return 1; }
inline Vector<3> ones(Vector<3>) { return {{1, 1, 1}}; }

}  // namespace isoshade::reference
