// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace isoshade::emit {

/// A finite float in 9 significant digits, which determine it, with a point or an exponent: "0.5", "1e-30".
std::string decimal(uint32_t bits);

bool is_finite(uint32_t bits);

/// An int, as GLSL and C++ both read it: decimal where it is small, else its bits in hex; `is_mask`: what is combined
/// bit by bit.
std::string integer(uint32_t bits, bool is_mask = false);

/// "0x7f800000", without leading zeros.
std::string hexadecimal(uint32_t bits);

}  // namespace isoshade::emit
