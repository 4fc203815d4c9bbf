// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/parse_number.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <system_error>

namespace isoshade::support {
namespace {

constexpr uint32_t sign_bit = 0x80000000u, infinity_bits = 0x7f800000u, nan_bits = 0x7fc00000u,
                   smallest_normal = 0x00800000u;

/// Whether a number outside the range of float is too small rather than too large. from_chars accepted `body`,
/// and it is not zero.
bool is_tiny(std::string_view body, bool hex) {
  const size_t mark = body.find_first_of(hex ? "pP" : "eE");
  const std::string_view mantissa = body.substr(0, mark);
  const auto point = static_cast<int64_t>(std::min(mantissa.find('.'), mantissa.size()));
  const auto first = static_cast<int64_t>(mantissa.find_first_not_of("0."));
  int64_t exponent = 0;
  if (mark != std::string_view::npos) {
    std::string_view digits = body.substr(mark + 1);
    if (digits.front() == '+') digits.remove_prefix(1);
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (result.ec == std::errc::result_out_of_range) return digits.front() == '-';
  }
  // The value is about radix^(point - first) * base^exponent, and far from 1. The text is far shorter than 2^59
  // bytes, so the product does not overflow.
  return exponent < -(point - first) * (hex ? 4 : 1);
}

}  // namespace

std::optional<float> parse_float(std::string_view text) {
  uint32_t sign = 0;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    if (text.front() == '-') sign = sign_bit;
    text.remove_prefix(1);
  }
  if (text == "nan") return std::bit_cast<float>(nan_bits);
  if (text == "inf") return std::bit_cast<float>(sign | infinity_bits);
  const bool hex = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
  if (hex) text.remove_prefix(2);
  // from_chars would also accept a second sign, "infinity" and "nan(...)".
  if (text.empty() || text.find_first_not_of(hex ? "0123456789abcdefABCDEF.pP+-" : "0123456789.eE+-") !=
                          std::string_view::npos) {
    return std::nullopt;
  }
  if (text.front() == '-' || text.front() == '+') return std::nullopt;

  float value = 0;
  const char* const end = text.data() + text.size();
  const auto result =
      std::from_chars(text.data(), end, value, hex ? std::chars_format::hex : std::chars_format::general);
  if (result.ptr != end || result.ec == std::errc::invalid_argument) return std::nullopt;
  uint32_t bits = std::bit_cast<uint32_t>(value);
  if (result.ec == std::errc::result_out_of_range) bits = is_tiny(text, hex) ? 0 : infinity_bits;
  if (bits < smallest_normal) bits = 0;
  return std::bit_cast<float>(sign | bits);
}

std::optional<float> parse_float_in_range(std::string_view text) {
  const std::optional<float> value = parse_float(text);
  const bool infinite = value && (std::bit_cast<uint32_t>(*value) & ~sign_bit) == infinity_bits;
  return infinite && !text.ends_with("inf") ? std::nullopt : value;
}

std::string format_float(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  if ((bits & ~sign_bit) > infinity_bits) return "nan";
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string text(buffer, result.ptr);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string format_hex_float(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint32_t magnitude = bits & ~sign_bit;
  if (magnitude >= infinity_bits) return format_float(value);
  // Not to_chars: its text for denormals is unspecified, and DAZ would lose them in a conversion to double.
  uint32_t fraction = magnitude & (smallest_normal - 1);
  int exponent = static_cast<int>(magnitude >> 23) - 127;
  if (magnitude != 0 && magnitude < smallest_normal) {
    const int shift = std::countl_zero(fraction) - 8;
    fraction = (fraction << shift) & (smallest_normal - 1);
    exponent = -126 - shift;
  }
  std::string text = bits & sign_bit ? "-0x" : "0x";
  text += magnitude == 0 ? '0' : '1';
  if (fraction != 0) {
    text += '.';
    for (fraction <<= 9; fraction != 0; fraction <<= 4) text += "0123456789abcdef"[fraction >> 28];
  }
  if (magnitude == 0) return text + "p+0";
  return text + (exponent < 0 ? "p-" : "p+") + std::to_string(exponent < 0 ? -exponent : exponent);
}

}  // namespace isoshade::support
