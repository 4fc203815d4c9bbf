// SPDX-License-Identifier: Apache-2.0
// Text to float and back. The same on every machine: no locale, no rounding mode, no double in between.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace isoshade::support {

/// The float nearest to a decimal ("-1.5e-3", "+2", ".5", "5.") or hex ("0x1.8p+1") text, rounded once, ties
/// to even. A denormal becomes a zero of its sign; what is beyond the range becomes an infinity of its sign.
/// "nan" is the one NaN (0x7fc00000), "inf" and "-inf" are the infinities. Anything else, blanks too:
/// nothing.
std::optional<float> parse_float(std::string_view text);

/// The same where the text must say what it means: a number beyond the range of float is no number, and an infinity is
/// written "inf".
std::optional<float> parse_float_in_range(std::string_view text);

/// The shortest decimal that reads back as `value`, at most 9 digits, always with a '.' or an exponent
/// ("1.0", "0.1", "1e-07"), so that it is a float in C++, GLSL and JSON. "nan", "inf", "-inf".
std::string format_float(float value);

/// As C's %a: "0x1.8p+1", "-0x0p+0"; "nan", "inf", "-inf". Exact.
std::string format_hex_float(float value);

}  // namespace isoshade::support
