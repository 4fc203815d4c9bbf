// SPDX-License-Identifier: Apache-2.0
// Between records in memory and lanes: reads and writes W records of four words, or of two, as one register a word. For
// files that are compiled for one instruction set, see tile_lanes.h.
#pragma once

#include <cstdint>
#include <utility>

#include "runtime/lanes/lanes.h"

namespace isoshade::raster::detail {

typedef int Quad __attribute__((vector_size(16)));
typedef long long Pair __attribute__((vector_size(16)));

template <int W>
using Raw = typename lanes::Vectors<W>::Ints;

// Shuffles of two registers: element i of the result is element pattern[i % 4] of each group of four; 4 to 7 count in
// the second register.
template <int W, int p0, int p1, int p2, int p3, int... i>
ISOSHADE_INLINE Raw<W> shuffle_groups(Raw<W> a, Raw<W> b, std::integer_sequence<int, i...>) {
  constexpr int pattern[4] = {p0, p1, p2, p3};
  return __builtin_shufflevector(a, b, (pattern[i % 4] & 3) + (i & ~3) + (pattern[i % 4] >= 4 ? W : 0)...);
}
template <int W, int p0, int p1, int p2, int p3>
ISOSHADE_INLINE Raw<W> shuffle_groups(Raw<W> a, Raw<W> b) {
  return shuffle_groups<W, p0, p1, p2, p3>(a, b, std::make_integer_sequence<int, W>());
}

/// A register of the quads that quad(0), quad(1), ... return.
template <int W, class QuadAt>
ISOSHADE_INLINE Raw<W> join(const QuadAt& quad) {
  if constexpr (W == 4) {
    return quad(0);
  } else if constexpr (W == 8) {
    return __builtin_shufflevector(quad(0), quad(1), 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    return __builtin_shufflevector(
        join<W / 2>(quad), join<W / 2>([&](int i) __attribute__((always_inline)) { return quad(i + W / 8); }), 0, 1, 2, 3,
        4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
}

template <int W, int... i>
ISOSHADE_INLINE void store_quads(Raw<W> a, const auto& place, std::integer_sequence<int, i...>) {
  const auto store = [&]<int g>(std::integral_constant<int, g>) __attribute__((always_inline)) {
    const Quad quad = __builtin_shufflevector(a, a, 4 * g, 4 * g + 1, 4 * g + 2, 4 * g + 3);
    __builtin_memcpy(place(4 * g), &quad, sizeof quad);
  };
  (store(std::integral_constant<int, i>()), ...);
}

/// Turns the four registers: word k of record 4g + j in element 4g + j of register k <-> in element 4g + k of register j.
template <int W>
ISOSHADE_INLINE void transpose(Raw<W> (&r)[4]) {
  const Raw<W> low01 = shuffle_groups<W, 0, 4, 1, 5>(r[0], r[1]), high01 = shuffle_groups<W, 2, 6, 3, 7>(r[0], r[1]);
  const Raw<W> low23 = shuffle_groups<W, 0, 4, 1, 5>(r[2], r[3]), high23 = shuffle_groups<W, 2, 6, 3, 7>(r[2], r[3]);
  r[0] = shuffle_groups<W, 0, 1, 4, 5>(low01, low23);
  r[1] = shuffle_groups<W, 2, 3, 6, 7>(low01, low23);
  r[2] = shuffle_groups<W, 0, 1, 4, 5>(high01, high23);
  r[3] = shuffle_groups<W, 2, 3, 6, 7>(high01, high23);
}

/// The four words at record(i) for each lane i, each word as a register. `record` returns a pointer.
template <int W, class RecordAt>
ISOSHADE_INLINE void load_quads(const RecordAt& record, lanes::Int<W, 1> (&words)[4]) {
  Raw<W> rows[4];
  for (int j = 0; j < 4; ++j)
    rows[j] = join<W>([&](int g) __attribute__((always_inline)) {
      Quad quad;
      __builtin_memcpy(&quad, record(4 * g + j), sizeof quad);
      return quad;
    });
  transpose<W>(rows);
  for (int k = 0; k < 4; ++k) words[k] = lanes::Int<W, 1>::of(rows[k]);
}

/// Writes the four words of each lane i to record(i).
template <int W, class RecordAt>
ISOSHADE_INLINE void store_quads(const lanes::Int<W, 1> (&words)[4], const RecordAt& record) {
  Raw<W> rows[4] = {words[0].raw, words[1].raw, words[2].raw, words[3].raw};
  transpose<W>(rows);
  for (int j = 0; j < 4; ++j)
    store_quads<W>(
        rows[j], [&](int i) __attribute__((always_inline)) { return record(i + j); },
        std::make_integer_sequence<int, W / 4>());
}

/// The two words at record(i) for each lane i.
template <int W, class RecordAt>
ISOSHADE_INLINE void load_pairs(const RecordAt& record, lanes::Int<W, 1>& first, lanes::Int<W, 1>& second) {
  Raw<W> rows[2];  // of each group of four records the first two, the last two
  for (int j = 0; j < 2; ++j)
    rows[j] = join<W>([&](int g) __attribute__((always_inline)) {
      long long a, b;
      __builtin_memcpy(&a, record(4 * g + 2 * j), sizeof a);
      __builtin_memcpy(&b, record(4 * g + 2 * j + 1), sizeof b);
      return (Quad)Pair{a, b};
    });
  first = lanes::Int<W, 1>::of(shuffle_groups<W, 0, 2, 4, 6>(rows[0], rows[1]));
  second = lanes::Int<W, 1>::of(shuffle_groups<W, 1, 3, 5, 7>(rows[0], rows[1]));
}

}  // namespace isoshade::raster::detail
