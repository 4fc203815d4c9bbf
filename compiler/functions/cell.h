// SPDX-License-Identifier: Apache-2.0
// Hashes of the cells of the integer lattice, the basis of all noise functions. Integer arithmetic only, so identical
// on every machine; the hashes are those of Open Shading Language and MaterialX.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// A coordinate, split into the index of its cell and the fraction within the cell, in [0, 1].
template <class F>
struct InCell {
  int_of<F> cell;
  F fraction;
};

/// Splits a coordinate. Magnitudes from 2^31, infinities and NaN count as 0.
template <class F>
InCell<F> split_cell(F x) {
  const F within = select(abs(x) < 0x1p31f, x, F(0.0f));
  const F whole = floor(within);
  return {to_int(whole), within - whole};
}

template <class Int>
Int rotate_left(Int x, int amount) {
  return shift_left(x, amount) | shift_right(x, 32 - amount);
}

/// 32 pseudo-random bits from three integers.
/// Source: final() of Jenkins, "lookup3.c", 2006.
template <class Int>
Int mix_bits(Int a, Int b, Int c) {
  c = (c ^ b) - rotate_left(b, 14);
  a = (a ^ c) - rotate_left(c, 11);
  b = (b ^ a) - rotate_left(a, 25);
  c = (c ^ b) - rotate_left(b, 16);
  a = (a ^ c) - rotate_left(c, 4);
  b = (b ^ a) - rotate_left(a, 14);
  return (c ^ b) - rotate_left(b, 24);
}

/// The initial state of hashword() of "lookup3.c" for `count` numbers, with the initial value 13.
constexpr int hash_start(int count) { return static_cast<int>(0xdeadbeefu) + (count << 2) + 13; }

/// 32 pseudo-random bits of a cell.
template <class Int>
Int hash(Int x, Int y) {
  constexpr int start = hash_start(2);
  return mix_bits<Int>(x + start, y + start, start);
}
template <class Int>
Int hash(Int x, Int y, Int z) {
  constexpr int start = hash_start(3);
  return mix_bits<Int>(x + start, y + start, z + start);
}
/// The same with a third coordinate that is equal in all lanes.
template <class Int>
Int hash_channel(Int x, Int y, int channel) {
  constexpr int start = hash_start(3);
  return mix_bits<Int>(x + start, y + start, start + channel);
}

/// The upper 24 of 32 random bits as a number in [0, 1).
template <class Int>
auto unit_of_bits(Int bits) {
  return to_float(shift_right(bits, 8)) * 0x1p-24f;
}

/// A pseudo-random number in [0, 1) for each square of the unit grid.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 0 ULP.
template <class F>
F cellnoise2d(vec<F, 2> p) {
  return unit_of_bits(hash(split_cell(p[0]).cell, split_cell(p[1]).cell));
}

/// A pseudo-random number in [0, 1) for each cube of the unit grid.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0.
/// Error: 0 ULP.
template <class F>
F cellnoise3d(vec<F, 3> p) {
  return unit_of_bits(hash(split_cell(p[0]).cell, split_cell(p[1]).cell, split_cell(p[2]).cell));
}

}  // namespace isoshade::functions
