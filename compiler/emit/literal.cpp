// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/literal.h"

#include <bit>
#include <charconv>

namespace isoshade::emit {

std::string decimal(uint32_t bits) {
  char buffer[32];
  // The shortest text that reads back as this float has at most 9 digits.
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, std::bit_cast<float>(bits)).ptr;
  std::string text(buffer, end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string hexadecimal(uint32_t bits) {
  char buffer[16] = {'0', 'x'};
  return std::string(buffer, std::to_chars(buffer + 2, buffer + sizeof buffer, bits, 16).ptr);
}

std::string integer(uint32_t bits, bool is_mask) {
  constexpr int32_t most_decimal = 0xffff;
  const auto value = static_cast<int32_t>(bits);
  if (value >= -most_decimal && value <= most_decimal && !(is_mask && value > 9)) return std::to_string(value);
  return value >= 0 ? hexadecimal(bits) : "int(" + hexadecimal(bits) + "u)";
}

bool is_finite(uint32_t bits) { return (bits & 0x7f800000u) != 0x7f800000u; }

}  // namespace isoshade::emit
