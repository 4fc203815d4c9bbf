// SPDX-License-Identifier: Apache-2.0
#include <ctime>
#include <gtest/gtest.h>
#include <random>

#include "compiler/ir/builder.h"
#include "compiler/ir/printer.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "tests/unit/front_end.h"
#include "tests/unit/ir_text.h"
#include "tests/unit/random_module.h"

namespace isoshade::passes {
namespace {

using namespace ir;

TEST(Renumber, PrintedModulesParseBackEqual) {
  for (uint64_t seed = 0; seed < 500; ++seed) {
    Module module = RandomModule(seed).make();
    renumber(module);
    const Module reread = parsed(print(module));
    ASSERT_EQ(reread, module) << print(module);
    renumber(module);
    ASSERT_EQ(reread, module) << "renumbering twice differs";
  }
}

TEST(Derivatives, LeaveModulesWithoutDerivativesUnchanged) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const Module module = RandomModule(seed).make();
    Module after = module;
    derivatives(after);
    ASSERT_EQ(after, module);
  }
}

// Another order of a block's instructions in which operands still come first.
void shuffle(Function& f, BlockId block, std::mt19937& random) {
  std::vector<InstructionId>& list = f.blocks[block].instructions;
  for (InstructionId id : list)
    for (BlockId inner : f.instructions[id].blocks)
      if (inner != none) shuffle(f, inner, random);
  for (size_t swaps = 4 * list.size(); swaps != 0 && list.size() > 1; --swaps) {
    const size_t at = random() % (list.size() - 1);
    const Instruction& first = f.instructions[list[at]];
    const Instruction& second = f.instructions[list[at + 1]];
    if (second.blocks[0] != none) continue;  // what its blocks use from outside is not in its operands
    bool needs = false;
    for (ValueId operand : f.operands_of(second))
      needs = needs || (operand >= first.first_result && operand < first.first_result + first.result_count);
    if (!needs) std::swap(list[at], list[at + 1]);
  }
}

TEST(Renumber, IsIndependentOfBuildOrder) {
  for (uint32_t seed = 0; seed < 500; ++seed) {
    const Module module = RandomModule(seed).make();
    Module shuffled = module, canonical = module;
    std::mt19937 random(seed);
    for (Function& function : shuffled.functions) shuffle(function, 0, random);
    ASSERT_EQ(validate(shuffled), "");
    renumber(shuffled);
    renumber(canonical);
    ASSERT_EQ(print(shuffled), print(canonical));
  }
}

// No op of a function that a driver would fold inexactly.
void expect_nothing_foldable(const Function& f) {
  std::vector<const Instruction*> made(f.values.size(), nullptr);
  for (const Instruction& i : f.instructions)
    for (uint32_t k = 0; k < i.result_count; ++k) made[i.first_result + k] = &i;
  const auto known = [&](ValueId value, uint32_t c) -> std::optional<uint32_t> {
    if (made[value] != nullptr && made[value]->op == Opcode::construct)
      value = f.operands_of(*made[value])[c];
    if (made[value] == nullptr || made[value]->op != Opcode::constant) return std::nullopt;
    return made[value]->imm;
  };
  for (const Instruction& i : f.instructions) {
    if (i.op == Opcode::ftoi) {
      const Instruction* from = made[f.operands_of(i)[0]];
      EXPECT_TRUE(from == nullptr || from->op != Opcode::itof);
    }
    if (i.op != Opcode::fadd && i.op != Opcode::fsub && i.op != Opcode::fmul && i.op != Opcode::fdiv)
      continue;
    for (uint32_t c = 0; c < f.type(i.first_result).width; ++c) {
      const auto a = known(f.operands_of(i)[0], c), b = known(f.operands_of(i)[1], c);
      const bool zero = (a && *a << 1 == 0) || (b && *b << 1 == 0);
      const bool exact = i.op == Opcode::fadd ? a != 0u && b != 0u : i.op == Opcode::fsub && !a && b == 0u;
      EXPECT_FALSE(a && b) << name(i.op);
      EXPECT_FALSE(zero && !exact) << name(i.op);
    }
  }
}

// What is left of an effect whose parameter guards a division and a strength, as text.
std::string guarded_effect(const std::string& range) {
  FrontEnd front_end;
  Module module = front_end.lower(R"({"isoshade": 1, "effect": "e", "parameters": {
      "width": {"type": "float", "value": 1)" +
                                  range + R"(}}, "nodes": {
      "p": {"type": "position"},
      "above_0": {"type": "max", "in1": "width", "in2": 0.0009765625},
      "scaled": {"type": "divide", "in1": "p", "in2": "above_0"},
      "part": {"type": "clamp", "in": "width", "low": 0, "high": 1},
      "size": {"type": "absval", "in": "part"},
      "choice": {"type": "ifgreater", "value1": "size", "value2": 0, "in1": "scaled", "in2": "p"},
      "color": {"type": "convert", "in": "choice", "to": "color3"}},
      "passes": [{"name": "base", "color": "color"}]})");
  Entries entries{module.find("shade")};
  run(optimisations(), module, entries, functions::Tier::standard, {}, true);
  return print(module);
}

TEST(Decide, RemovesGuardsMadeRedundantByParameterRanges) {
  const auto has_guards = [](const std::string& text) {
    return text.find("select") != std::string::npos || text.find("branch") != std::string::npos ||
           text.find(" call ") != std::string::npos;
  };
  EXPECT_TRUE(has_guards(guarded_effect("")));
  EXPECT_TRUE(has_guards(guarded_effect(R"(, "min": 0, "max": 1)"))) << "it may be 0";
  const std::string positive = guarded_effect(R"(, "min": 0.125, "max": 1)");
  EXPECT_FALSE(has_guards(positive)) << positive;
}

TEST(HideFoldables, LeavesNothingForDriversToFold) {
  for (uint64_t seed = 0; seed < 500; ++seed) {
    Module module = RandomModule(seed).make({.library_calls = true});
    Entries entries{module.find("main")};
    run(optimisations(), module, entries, functions::Tier::standard, {}, true);
    for (const Function& function : module.functions) {
      EXPECT_FALSE(function.is_declaration());
      expect_nothing_foldable(function);
    }
    ASSERT_FALSE(HasFailure()) << "seed " << seed << "\n" << print(module);
  }
}

TEST(Pipeline, DumpsAfterEveryPassAndStatesReasons) {
  Module module = RandomModule(3).make();
  Entries entries{module.find("main")};
  size_t dumps = 0;
  run(optimisations(), module, entries, functions::Tier::standard,
      [&](std::string_view name, const Module&) { EXPECT_EQ(name, optimisations()[dumps++].name); });
  EXPECT_EQ(dumps, optimisations().size());
  for (const ModulePass& pass : optimisations()) EXPECT_FALSE(pass.reason.empty());
}

TEST(Specialize, BoundsModuleGrowth) {
  // Each of the nested functions calls the next twice, with two constants made of its own: 2^40 clones.
  std::string text =
      "func @main(%y: float) -> (out: float) { %k = constant float 0x40490fdb %r = call @f0(%k, %y) return "
      "%r }\n";
  for (int i = 0; i < 40; ++i) {
    const std::string callee = "call @f" + std::to_string(i + 1);
    text += "func @f" + std::to_string(i) + R"((%x: float, %y: float) -> (out: float) {
      %a = constant float 0x3f8ccccd
      %b = constant float 0x3f99999a
      %product = fmul %x, %a
      %first = fadd %product, %b
      %second = fmul %x, %b
      %p = )" +
            callee + "(%first, %y) %q = " + callee + "(%second, %p) return %q }\n";
  }
  text += "func @f40(%x: float, %y: float) -> (out: float) { %z = fmul %x, %y return %z }\n";
  Module module = valid(text);
  specialize(module);
  EXPECT_EQ(validate(module), "");
  size_t instructions = 0;
  for (const Function& function : module.functions) instructions += function.instructions.size();
  EXPECT_LT(instructions, 400'000u);
}

// A function of `size` instructions: long chains, few repeats.
Module large(int size) {
  Module module;
  Function function;
  function.name = "main";
  for (int i = 0; i < 4; ++i) function.parameters.push_back({"p" + std::to_string(i), float_type, "", false});
  function.results = {{"out", float_type}};
  module.functions.push_back(function);
  Builder b(module, 0);
  std::mt19937 random(1);
  std::vector<ValueId> values;
  for (size_t i = 0; i < 4; ++i) values.push_back(b.parameter(i));
  const Opcode ops[] = {Opcode::fadd, Opcode::fsub, Opcode::fmul, Opcode::fdiv};
  for (int i = 0; i < size; ++i) {
    const ValueId other =
        random() % 8 == 0 ? b.constant(static_cast<float>(random() % 4)) : values[random() % values.size()];
    values.push_back(b.op(ops[random() % 4], {values.back(), other}));
  }
  const ValueId results[] = {values.back()};
  b.finish(results);
  return module;
}

// Of the processor, which other programs on the machine do not count in.
double seconds_for(const Module& module) {
  double best = 1e9;
  for (int i = 0; i < 3; ++i) {
    Module copy = module;
    const std::clock_t start = std::clock();
    renumber(copy);
    fold(copy);
    cse(copy);
    hide_foldables(copy, {});
    renumber(copy);
    EXPECT_EQ(validate(copy), "");
    EXPECT_EQ(parsed(print(copy)), copy);
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

TEST(Passes, TimeIsNotQuadraticInSize) {
  const double small = seconds_for(large(10'000)), big = seconds_for(large(80'000));
  EXPECT_LT(big, 8 * small * 4) << "10,000 instructions: " << small << " s, 80,000: " << big << " s";
}

}  // namespace
}  // namespace isoshade::passes
