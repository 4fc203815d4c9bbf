// SPDX-License-Identifier: Apache-2.0
// What the bits of a float mean here: no value is denormal, and NaN is one value.
#pragma once

#include <cstdint>

namespace isoshade::ir {

inline constexpr uint32_t sign_bit = 0x80000000u;
inline constexpr uint32_t infinity_bits = 0x7f800000u;
inline constexpr uint32_t nan_bits = 0x7fc00000u;
inline constexpr uint32_t one_bits = 0x3f800000u;

constexpr bool is_nan(uint32_t bits) { return (bits & ~sign_bit) > infinity_bits; }
constexpr bool is_denormal(uint32_t bits) { return (bits & infinity_bits) == 0 && (bits & ~sign_bit) != 0; }
constexpr uint32_t flush_denormal(uint32_t bits) {
  return (bits & infinity_bits) == 0 ? bits & sign_bit : bits;
}
constexpr uint32_t canonical_nan(uint32_t bits) { return is_nan(bits) ? nan_bits : bits; }
/// The one form in which constants and stored words hold a float.
constexpr uint32_t canonical_float(uint32_t bits) { return canonical_nan(flush_denormal(bits)); }

}  // namespace isoshade::ir
