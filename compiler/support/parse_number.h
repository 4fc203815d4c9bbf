// SPDX-License-Identifier: Apache-2.0
// Text to float and back, identical on every machine: independent of locale and rounding mode, without going
// through double.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace isoshade::support {

/// Parses a decimal ("-1.5e-3", "+2", ".5", "5.") or hex ("0x1.8p+1") number, rounded once, ties to even.
/// Denormals flush to zero and overflow gives infinity, both with the sign kept. "nan" is the one NaN
/// (0x7fc00000); "inf" and "-inf" are the infinities. Returns nullopt for anything else, including
/// surrounding blanks.
std::optional<float> parse_float(std::string_view text);

/// The same, but returns nullopt for a number beyond the range of float: only "inf" and "-inf" are infinite.
std::optional<float> parse_float_in_range(std::string_view text);

/// The shortest decimal that parses back to `value`: at most 9 digits, always with a '.' or an exponent
/// ("1.0", "0.1", "1e-07"), so that it is a float literal in C++, GLSL and JSON; or "nan", "inf", "-inf".
std::string format_float(float value);

/// Exact, like C's %a: "0x1.8p+1", "-0x0p+0"; "nan", "inf", "-inf".
std::string format_hex_float(float value);

}  // namespace isoshade::support
