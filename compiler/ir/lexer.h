// SPDX-License-Identifier: Apache-2.0
// The tokens of text IR.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::ir {

struct Token {
  enum class Kind : uint8_t {
    end,
    word,      ///< a name or keyword
    value,     ///< %name, without the sign
    function,  ///< @name, without the sign
    number,    ///< decimal with an optional minus, or 0x and hex digits
    string,    ///< "...", escapes resolved
    mark,      ///< one of ( ) { } [ ] < , : ; = or ->
    bad,       ///< no token; the text says why
  };
  Kind kind = Kind::end;
  std::string text;
  uint32_t line = 1;
};

/// All tokens of a text; the last is `end`, or `bad` where reading stopped.
std::vector<Token> tokenise(std::string_view text);

/// [A-Za-z_][A-Za-z0-9_]*: what functions, parameters, results, buffers and nodes are called.
bool is_identifier(std::string_view text);

}  // namespace isoshade::ir
