// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/op.h"

#include <iterator>

namespace isoshade::ir {

namespace {

// The column `cpp` as text, by arity.
#define CPP_1_prefix(sign) #sign "$0"
#define CPP_2_infix(sign) "$0 " #sign " $1"
#define CPP_1_call(function) #function "($0)"
#define CPP_2_call(function) #function "($0, $1)"
#define CPP_3_call(function) #function "($0, $1, $2)"

constexpr OpInfo rows[] = {
#define OP(name, arity, rule, glsl, cpp, precondition, range, change)           \
  {#name, arity, Rule::rule, glsl, CPP_##arity##_##cpp, Precondition::precondition, \
   RangeRule::range, ChangeRule::change},
#include "compiler/ir/ops.def"
};

constexpr std::string_view names[] = {
#define OP(name, ...) #name,
#define FORM(name, immediate, blocks) #name,
#include "compiler/ir/ops.def"
};

}  // namespace

const OpInfo& info(Opcode op) { return rows[static_cast<size_t>(op)]; }

std::string_view name(Opcode op) { return names[static_cast<size_t>(op)]; }

std::optional<Opcode> opcode_from_name(std::string_view text) {
  for (size_t i = 0; i < std::size(names); ++i)
    if (names[i] == text) return static_cast<Opcode>(i);
  return std::nullopt;
}

}  // namespace isoshade::ir
