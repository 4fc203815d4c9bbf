// SPDX-License-Identifier: Apache-2.0
// Long functions, cut into parts.
#include <algorithm>
#include <gtest/gtest.h>

#include "compiler/ir/printer.h"
#include "compiler/passes/passes.h"
#include "tests/unit/ir_text.h"

namespace isoshade::passes {
namespace {

using ir::Module;

size_t longest_block(const Module& module) {
  size_t longest = 0;
  for (const ir::Function& function : module.functions)
    for (const ir::Block& block : function.blocks) {
      size_t count = 0;
      for (const ir::InstructionId id : block.instructions)
        count += function.instructions[id].op != ir::Opcode::constant ? 1 : 0;
      longest = std::max(longest, count);
    }
  return longest;
}

/// x + x * 1 + x * 1 + ..., one term after another.
std::string sum(int terms) {
  std::string text =
      "func @f(%x: float) -> (out: float) {\n  %one = constant float 0x3f800000\n  %s0 = fadd %x, %one\n";
  for (int i = 1; i < terms; ++i) {
    const std::string number = std::to_string(i);
    text += "  %m" + number + " = fmul %x, %s" + std::to_string(i - 1) + "\n  %s" + number + " = fadd %m" +
            number + ", %one\n";
  }
  return text + "  return %s" + std::to_string(terms - 1) + "\n}\n";
}

TEST(CutLong, LeavesNoLongBlock) {
  Module module = ir::valid(sum(5000));
  const Module before = module;
  cut_long(module, 50);
  EXPECT_EQ(ir::validate(module), "");
  EXPECT_LE(longest_block(module), 52u);
  EXPECT_GT(module.functions.size(), 5000u * 2 / 52);
  size_t instructions = 0;
  for (const ir::Function& function : module.functions)
    if (function.name != "f") instructions += function.instructions.size();
  EXPECT_LT(instructions, 2u * 2 * 5000) << "what is cut does not grow";
  for (const uint32_t x : {0x3e000000u, 0xbf000000u, 0x7f800000u})
    EXPECT_EQ(ir::run(module, {x}), ir::run(before, {x}));
}

TEST(CutLong, LeavesShortFunctionsUnchanged) {
  Module module = ir::valid(sum(20));
  const Module before = module;
  cut_long(module, 50);
  EXPECT_EQ(ir::print(module), ir::print(before));
}

TEST(CutLong, CutsInsideBranchesAndLoops) {
  std::string body;
  for (int i = 1; i <= 300; ++i)
    body += "        %s" + std::to_string(i) + " = fadd %s" + std::to_string(i - 1) + ", %x\n";
  Module module = ir::valid(R"(
    func @f(%x: float, %n: int uniform) -> (out: float) {
      %r = loop %i < %n, %s0 = %x {
)" + body + R"(
        yield %s300
      }
      return %r
    })");
  const Module before = module;
  cut_long(module, 50);
  EXPECT_EQ(ir::validate(module), "");
  EXPECT_LE(longest_block(module), 52u);
  EXPECT_EQ(ir::run(module, {0x3f800000u, 3}), ir::run(before, {0x3f800000u, 3}));
}

// C++ counts loops in plain ints: the count must not come out of a part that computes in lanes.
TEST(CutLong, LoopCountsStayUniform) {
  std::string text =
      "func @f(%x: float, %n: int uniform) -> (out: float) {\n  %s0 = fadd %x, %x\n  %n0: int = iadd %n, "
      "%n\n";
  for (int i = 1; i <= 200; ++i) {
    const std::string number = std::to_string(i), before = std::to_string(i - 1);
    text += "  %s" + number + " = fadd %s" + before + ", %x\n  %n" + number + ": int = iadd %n" + before +
            ", %n\n";
  }
  text += "  %r = loop %i < %n200, %t = %s200 {\n    %u = fadd %t, %x\n    yield %u\n  }\n  return %r\n}\n";
  Module module = ir::valid(text);
  cut_long(module, 50);
  EXPECT_EQ(ir::validate(module), "") << ir::print(module);
  bool uniform = false, varying = false;
  for (const ir::Function& function : module.functions) {
    if (function.name == "f") continue;
    for (const ir::Parameter& parameter : function.parameters)
      (parameter.type == ir::int_type ? uniform : varying) = true;
    const bool ints = function.results[0].type == ir::int_type;
    for (const ir::Parameter& parameter : function.parameters) EXPECT_EQ(parameter.uniform, ints);
  }
  EXPECT_TRUE(uniform && varying);
}

}  // namespace
}  // namespace isoshade::passes
