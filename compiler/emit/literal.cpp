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

bool is_finite(uint32_t bits) { return (bits & 0x7f800000u) != 0x7f800000u; }

}  // namespace isoshade::emit
