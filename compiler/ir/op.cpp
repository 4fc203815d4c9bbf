// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/op.h"

#include <array>

namespace isoshade::ir {

namespace {

constexpr std::array<OpInfo, primitive_count> rows{{
#define OP(name, arity, rule, glsl, cpp, precondition) \
  {#name, arity, Rule::rule, glsl, cpp, Precondition::precondition},
#include "compiler/ir/ops.def"
}};

constexpr std::array<std::string_view, 10> structural_names{
    "constant", "construct", "extract", "hidden_zero", "load", "call", "branch", "loop", "ddx", "ddy"};

}  // namespace

const OpInfo& info(Opcode op) { return rows[static_cast<size_t>(op)]; }

std::string_view name(Opcode op) {
  const auto index = static_cast<size_t>(op);
  return index < primitive_count ? rows[index].name : structural_names[index - primitive_count];
}

std::optional<Opcode> opcode_from_name(std::string_view text) {
  for (size_t i = 0; i < primitive_count + structural_names.size(); ++i)
    if (name(static_cast<Opcode>(i)) == text) return static_cast<Opcode>(i);
  return std::nullopt;
}

}  // namespace isoshade::ir
