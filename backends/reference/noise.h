// SPDX-License-Identifier: Apache-2.0
// Noise functions as their sources define them, over any number type: hashes over words, sums over corners.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "backends/reference/geometry.h"

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

/// Coordinates from 2^31 on in magnitude, infinities and NaN count as 0.
template <class R>
R within_cells(R x) {
  return abs(x) < 0x1p31 ? x : R(0);
}
template <class R, int N>
Vector<R, N> within_cells(Vector<R, N> p) {
  return vector<N>([&](int i) { return within_cells(p[i]); });
}
template <class R>
int64_t cell_of(R x) {
  return static_cast<int64_t>(floor(within_cells(x)));
}
template <class R>
R unit_of(uint32_t bits) {
  return R(bits >> 8) * 0x1p-24;
}

template <class R>
R cellnoise2d(Vector<R, 2> p) {
  return unit_of<R>(hash_words<2>({cell_of(p[0]), cell_of(p[1])}));
}
template <class R>
R cellnoise3d(Vector<R, 3> p) {
  return unit_of<R>(hash_words<3>({cell_of(p[0]), cell_of(p[1]), cell_of(p[2])}));
}

template <class R>
R fade(R t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

constexpr int plane_gradients[8][2] = {{1, 2}, {-1, 2}, {1, -2}, {-1, -2},
                                       {2, 1}, {2, -1}, {-2, 1}, {-2, -1}};
constexpr int space_gradients[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1}};

/// Perlin's noise in three channels: the sum over the corners of the point's cell.
template <class R, int N>
Vector<R, 3> gradient_noise(Vector<R, N> p, R scale) {
  p = within_cells(p);
  Vector<R, 3> sum{};
  for (int corner = 0; corner < 1 << N; ++corner) {
    std::array<int64_t, N> at;
    Vector<R, N> offset;
    R weight = scale;
    for (int i = 0; i < N; ++i) {
      at[i] = cell_of(p[i]) + (corner >> i & 1);
      offset.c[i] = p[i] - R(at[i]);
      weight *= fade(R(1 - abs(offset[i])));
    }
    const uint32_t hash = hash_words<N>(at);
    for (int channel = 0; channel < 3; ++channel) {
      const uint32_t bits = hash >> 8 * channel;
      R product = 0;
      for (int i = 0; i < N; ++i)
        product += offset[i] * (N == 2 ? plane_gradients[bits & 7][i % 2] : space_gradients[bits & 15][i]);
      sum.c[channel] += weight * product;
    }
  }
  return sum;
}
template <class R>
Vector<R, 3> noise2d(Vector<R, 2> p) {
  return gradient_noise(p, R(6616) / 10000);
}
template <class R>
Vector<R, 3> noise3d(Vector<R, 3> p) {
  return gradient_noise(p, R(982) / 1000);
}

/// The sum of term(point, amplitude, index) over the octaves.
template <class R, class Term>
Vector<R, 3> sum_octaves(Vector<R, 3> p, R octaves, R lacunarity, R diminish, Term term) {
  Vector<R, 3> sum{};
  R amplitude = 1;
  for (int i = 0; i < 16 && i < octaves; ++i) {
    sum = sum + term(p, amplitude, i);
    amplitude *= diminish;
    p = p * lacunarity;
  }
  return sum;
}
template <class R>
Vector<R, 3> fractal3d(Vector<R, 3> p, R octaves, R lacunarity, R diminish) {
  return sum_octaves(p, octaves, lacunarity, diminish,
                     [](Vector<R, 3> at, R amplitude, int) { return noise3d(at) * amplitude; });
}
template <class R>
Vector<R, 3> fractal3d_magnitude(Vector<R, 3> p, R octaves, R lacunarity, R diminish) {
  return sum_octaves(p, octaves, lacunarity, diminish, [](Vector<R, 3> at, R amplitude, int i) {
    return Vector<R, 3>{{1, 1, 1}} * (amplitude * (1 + i * length(at)));
  });
}

/// The three least distances to the feature points of nine squares.
template <class R>
Vector<R, 3> worleynoise2d(Vector<R, 2> p, R jitter) {
  const R none = R(1) / R(0);
  if (jitter != jitter) return {{none, none, none}};
  p = within_cells(p);
  std::array<R, 9> distances;
  for (int i = 0; i < 9; ++i) {
    const int64_t x = cell_of(p[0]) + i % 3 - 1, y = cell_of(p[1]) + i / 3 - 1;
    const auto moved = [&](int64_t cell, int64_t axis) {
      return R(cell) + (unit_of<R>(hash_words<3>({x, y, axis})) - 0.5) * jitter + 0.5;
    };
    const Vector<R, 2> point{{moved(x, 0), moved(y, 1)}};
    distances[i] = length(point - p);
  }
  std::sort(distances.begin(), distances.end());
  return {{distances[0], distances[1], distances[2]}};
}

template <class R>
R ones(R) {
  return 1;
}
template <class R>
Vector<R, 3> ones(Vector<R, 3>) {
  return {{1, 1, 1}};
}

}  // namespace isoshade::reference
