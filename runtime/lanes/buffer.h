// SPDX-License-Identifier: Apache-2.0
//
// Reading and writing memory: tables by index, and lanes side by side.
#ifndef ISOSHADE_LANES_BUFFER_H
#define ISOSHADE_LANES_BUFFER_H

#include "vector.h"

namespace isoshade::lanes {

/// A table of `size` floats, size >= 1. Not owned. Holds no denormals.
struct FloatBuffer {
  const float* data;
  int size;
};

/// A table of `size` ints, size >= 1. Not owned.
struct IntBuffer {
  const int* data;
  int size;
};

/// The index, or the last one where it is outside of [0, size), also below 0: lanes that take no part in a
/// branch may hold any index, and must not read outside.
template <class Ints>
ISOSHADE_INLINE Ints clamp_index(Ints index, int size) {
  return select(unsigned_less(index, size), index, Ints(size - 1));
}

ISOSHADE_INLINE float load(FloatBuffer buffer, int index) {
  return buffer.data[clamp_index(index, buffer.size)];
}
ISOSHADE_INLINE int load(IntBuffer buffer, int index) { return buffer.data[clamp_index(index, buffer.size)]; }

template <int W>
ISOSHADE_INLINE Float<W, 1> load(FloatBuffer buffer, Int<W, 1> index) {
  return Float<W, 1>::of(Register<W>::gather(buffer.data, clamp_index(index, buffer.size).raw));
}
template <int W>
ISOSHADE_INLINE Int<W, 1> load(IntBuffer buffer, Int<W, 1> index) {
  return Int<W, 1>::of(Register<W>::gather(buffer.data, clamp_index(index, buffer.size).raw));
}
template <int W>
ISOSHADE_INLINE Float<W, 2> load(FloatBuffer buffer, Int<W, 2> index) {
  return {load(buffer, index.low), load(buffer, index.high)};
}
template <int W>
ISOSHADE_INLINE Int<W, 2> load(IntBuffer buffer, Int<W, 2> index) {
  return {load(buffer, index.low), load(buffer, index.high)};
}

// Contiguous lanes. No alignment is needed.

ISOSHADE_INLINE void read(const float* from, float& to) { to = *from; }
ISOSHADE_INLINE void read(const int* from, int& to) { to = *from; }
template <int W>
ISOSHADE_INLINE void read(const float* from, Float<W, 1>& to) {
  __builtin_memcpy(&to.raw, from, sizeof(to.raw));
}
template <int W>
ISOSHADE_INLINE void read(const int* from, Int<W, 1>& to) {
  __builtin_memcpy(&to.raw, from, sizeof(to.raw));
}
template <int W>
ISOSHADE_INLINE void read(const float* from, Float<W, 2>& to) {
  read(from, to.low);
  read(from + W, to.high);
}
template <int W>
ISOSHADE_INLINE void read(const int* from, Int<W, 2>& to) {
  read(from, to.low);
  read(from + W, to.high);
}

/// lane_count<F> floats from here on, which are no denormals.
template <class F>
ISOSHADE_INLINE F load_lanes(const float* from) {
  F result;
  read(from, result);
  return result;
}
/// lane_count<Ints> ints from here on.
template <class Ints>
ISOSHADE_INLINE Ints load_lanes(const int* from) {
  Ints result;
  read(from, result);
  return result;
}

ISOSHADE_INLINE void store_lanes(int* to, int value) { *to = value; }
template <int W>
ISOSHADE_INLINE void store_lanes(int* to, Int<W, 1> value) {
  __builtin_memcpy(to, &value.raw, sizeof(value.raw));
}
template <int W>
ISOSHADE_INLINE void store_lanes(int* to, Int<W, 2> value) {
  store_lanes(to, value.low);
  store_lanes(to + W, value.high);
}

/// Stores floats; every NaN as 0x7fc00000, for no other NaN may leave the lanes.
ISOSHADE_INLINE void store_lanes(float* to, float value) { *to = from_bits_normal(bits(value)); }
template <int W>
ISOSHADE_INLINE void store_lanes(float* to, Float<W, 1> value) {
  const Int<W, 1> canonical = bits(value);
  __builtin_memcpy(to, &canonical.raw, sizeof(canonical.raw));
}
template <int W>
ISOSHADE_INLINE void store_lanes(float* to, Float<W, 2> value) {
  store_lanes(to, value.low);
  store_lanes(to + W, value.high);
}

/// Stores a pixel of four floats for each lane, one after the other, as store_lanes does.
ISOSHADE_INLINE void store_pixels(float* to, float r, float g, float b, float a) {
  store_lanes(to, r);
  store_lanes(to + 1, g);
  store_lanes(to + 2, b);
  store_lanes(to + 3, a);
}
template <int W>
ISOSHADE_INLINE void store_pixels(float* to, Float<W, 1> r, Float<W, 1> g, Float<W, 1> b, Float<W, 1> a) {
#if ISOSHADE_SHUFFLES
  using R = Register<W>;
  using Floats = typename R::Floats;
  const auto canonical = [](Float<W, 1> x) __attribute__((always_inline)) { return (Floats)bits(x).raw; };
  const Floats red = canonical(r), green = canonical(g), blue = canonical(b), alpha = canonical(a);
  const Floats low_rg = R::low_pairs(red, green), high_rg = R::high_pairs(red, green);
  const Floats low_ba = R::low_pairs(blue, alpha), high_ba = R::high_pairs(blue, alpha);
  // In each group of four lanes one pixel.
  const Floats pixels[4] = {R::low_halves(low_rg, low_ba), R::high_halves(low_rg, low_ba),
                            R::low_halves(high_rg, high_ba), R::high_halves(high_rg, high_ba)};
  for (int group = 0; group < W / 4; ++group)
    for (int pixel = 0; pixel < 4; ++pixel)
      __builtin_memcpy(to + 4 * (4 * group + pixel), reinterpret_cast<const char*>(&pixels[pixel]) + 16 * group, 16);
#else
  float words[4][W];
  store_lanes(words[0], r);
  store_lanes(words[1], g);
  store_lanes(words[2], b);
  store_lanes(words[3], a);
  for (int lane = 0; lane < W; ++lane)
    for (int word = 0; word < 4; ++word) to[4 * lane + word] = words[word][lane];
#endif
}
template <int W>
ISOSHADE_INLINE void store_pixels(float* to, Float<W, 2> r, Float<W, 2> g, Float<W, 2> b, Float<W, 2> a) {
  store_pixels(to, r.low, g.low, b.low, a.low);
  store_pixels(to + 4 * W, r.high, g.high, b.high, a.high);
}
/// The first `count` of them.
template <class F>
ISOSHADE_INLINE void store_pixels(float* to, F r, F g, F b, F a, int count) {
  if (count >= lane_count<F>) return store_pixels(to, r, g, b, a);
  float pixels[4 * lane_count<F>];
  store_pixels(pixels, r, g, b, a);
  for (int i = 0; i < 4 * count; ++i) to[i] = pixels[i];
}

ISOSHADE_INLINE void number_lanes(int& lanes) { lanes = 0; }
template <int W>
ISOSHADE_INLINE void number_lanes(Int<W, 1>& lanes) {
  lanes = Int<W, 1>::of(Register<W>::lane_index());
}
template <int W>
ISOSHADE_INLINE void number_lanes(Int<W, 2>& lanes) {
  number_lanes(lanes.low);
  lanes.high = lanes.low + W;
}

/// 0, 1, 2, ... lane_count<Ints> - 1; in the order of load_lanes.
template <class Ints>
ISOSHADE_INLINE Ints lane_index() {
  Ints result;
  number_lanes(result);
  return result;
}

}  // namespace isoshade::lanes

#endif
