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
