// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/op.h"

#include <iterator>

namespace isoshade::ir {

namespace {

constexpr OpInfo rows[] = {
#define OP(name, arity, rule, cpp, precondition, range, change) \
  {#name, arity, Rule::rule, Precondition::precondition, RangeRule::range, ChangeRule::change},
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
