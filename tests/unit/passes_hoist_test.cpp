// SPDX-License-Identifier: Apache-2.0
// What is the same for all pixels of a draw is computed once, and no bit changes.
#include "compiler/passes/hoist.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "compiler/functions/library.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/printer.h"
#include "compiler/ir/validator.h"
#include "compiler/passes/passes.h"
#include "tests/unit/ir_text.h"
#include "tests/unit/random_module.h"

namespace isoshade::passes {
namespace {

using ir::Module;
using ir::Opcode;
using Words = std::vector<uint32_t>;

constexpr uint32_t floats = 0, integers = 1, first_word = 100;

DrawRate rate_of(size_t parameter) {
  DrawRate rate;
  rate.parameter = parameter;
  rate.buffers = {floats};
  rate.floats = floats;
  rate.integers = integers;
  rate.first = first_word;
  return rate;
}

size_t operations_of(const ir::Function& function) {
  size_t count = 0;
  for (const ir::Block& block : function.blocks)
    count += static_cast<size_t>(std::ranges::count_if(block.instructions, [&](ir::InstructionId id) {
      const Opcode op = function.instructions[id].op;
      return ir::is_primitive(op) && op != Opcode::iadd;
    }));
  return count;
}

size_t operations_of(const Module& module) {
  size_t count = 0;
  for (const ir::Function& function : module.functions) count += operations_of(function);
  return count;
}

struct Hoisted {
  Module module;
  uint32_t kernel = 0;
  std::optional<DrawValues> values;
};

Hoisted hoisted(Module module, size_t parameter = 0) {
  Hoisted made{std::move(module), 0, {}};
  made.kernel = made.module.find("main");
  // A function of the library keeps parameters that its results do not depend on, and a call of it seems to vary.
  const bool has_library = std::ranges::any_of(made.module.functions, [](const auto& f) { return !f.library.empty(); });
  renumber(made.module);
  const DrawRate rate = rate_of(parameter);
  made.values = hoist(made.module, made.kernel, rate);
  EXPECT_EQ(ir::validate(made.module), "") << ir::print(made.module);
  EXPECT_EQ(made.values ? ir::validate(made.values->module) : "", "");
  EXPECT_EQ(has_library ? 0 : operations_at_draw_rate(made.module, made.kernel, rate), 0u) << ir::print(made.module);
  return made;
}

constexpr std::string_view buffers = "buffer objects: float\nbuffer object_integers: int\nbuffer lights: float\n\n";

Hoisted hoisted(const std::string& functions) { return hoisted(ir::parsed(std::string(buffers) + functions)); }

TEST(Hoist, MovesWhatDependsOnTheRecordAlone) {
  const Hoisted made = hoisted(R"(func @main(%record: int uniform, %x: float) -> (y: float) {
  %0 = load objects[%record]
  %1 = constant float 0x40000000
  %2 = fmul %0, %1
  %3 = fsqrt %2
  %4 = fadd %3, %x
  return %4
}
)");
  ASSERT_TRUE(made.values);
  EXPECT_EQ(made.values->words, 1u);
  EXPECT_EQ(operations_of(made.module), 1u) << ir::print(made.module);
  EXPECT_EQ(operations_of(made.values->module), 2u);
}

TEST(Hoist, LeavesAModuleInWhichAllVaries) {
  const std::string text = R"(func @main(%record: int uniform, %x: float) -> (y: float) {
  %0 = load objects[%record]
  %1 = fmul %0, %x
  return %1
}
)";
  const Hoisted made = hoisted(text);
  EXPECT_FALSE(made.values);
  Module before = ir::parsed(std::string(buffers) + text);
  renumber(before);
  EXPECT_EQ(ir::print(made.module), ir::print(before));
}

// A light is not the same for all draws, and where its record lies is no operation of the draw.
TEST(Hoist, LeavesWhatDependsOnOtherBuffers) {
  EXPECT_FALSE(hoisted(R"(func @main(%record: int uniform, %x: float) -> (y: float) {
  %0 = load lights[%record]
  %1 = fsqrt %0
  %2 = fmul %1, %x
  return %2
}
)").values);
}

TEST(Hoist, MovesOutOfBranchesLoopsAndCalls) {
  const Hoisted made = hoisted(R"(func @inner(%a: float uniform, %x: float) -> (y: float) {
  %0 = fsqrt %a
  %1 = fmul %0, %x
  return %1
}

func @main(%record: int uniform, %x: float) -> (y: float) {
  %0 = load objects[%record]
  %1 = constant float 0x00000000
  %2: int = constant int 3
  %3: bool = flt %x, %1
  %4 = branch %3 {
    %5 = fmul %0, %0
    %6 = fadd %5, %x
    yield %6
  } else {
    yield %x
  }
  %7 = loop %8 < %2, %9 = %4 {
    %10 = fneg %0
    %11 = call @inner(%10, %9)
    yield %11
  }
  return %7
}
)");
  ASSERT_TRUE(made.values);
  // The square, and the root of the negative one.
  EXPECT_EQ(made.values->words, 2u) << ir::print(made.values->module);
  EXPECT_EQ(operations_of(made.values->module), 3u);
  // A comparison, a sum, a product.
  EXPECT_EQ(operations_of(made.module), 3u) << ir::print(made.module);
}

TEST(Hoist, MovesALoopThatIsTheSameAsAWhole) {
  const Hoisted made = hoisted(R"(func @main(%record: int uniform, %x: float) -> (y: float) {
  %0 = load objects[%record]
  %1: int = constant int 3
  %2 = loop %3 < %1, %4 = %0 {
    %5 = itof %3
    %6 = fadd %4, %5
    yield %6
  }
  %7 = fmul %2, %x
  return %7
}
)");
  ASSERT_TRUE(made.values);
  EXPECT_EQ(made.values->words, 1u);
  EXPECT_EQ(operations_of(made.module), 1u) << ir::print(made.module);
}

TEST(Hoist, ChainsMayBeLong) {
  constexpr int length = 100'000;
  std::string text = "func @main(%record: int uniform, %x: float) -> (y: float) {\n  %v0 = load objects[%record]\n";
  for (int i = 1; i <= length; ++i)
    text += "  %v" + std::to_string(i) + " = fsqrt %v" + std::to_string(i - 1) + "\n";
  text += "  %y = fmul %v" + std::to_string(length) + ", %x\n  return %y\n}\n";
  const Hoisted made = hoisted(text);
  ASSERT_TRUE(made.values);
  EXPECT_EQ(operations_of(made.module), 1u);
  EXPECT_EQ(operations_of(made.values->module), size_t{length});
}

// Each function calls the next with all of its parameters, and again with one less that is the same: 2^14 sets of them.
TEST(Hoist, NestedFunctionsAreSplitWithinABudget) {
  constexpr int depth = 14;
  const auto list = [](const std::string& before, const std::string& after, int varying) {
    std::string text;
    for (int i = 0; i < depth; ++i)
      text += (i == 0 ? "" : ", ") + before + (i == varying ? std::string("x") : "a" + std::to_string(i)) + after;
    return text;
  };
  std::string text = "func @f" + std::to_string(depth) + "(" + list("%", ": float", -1) + ", %x: float) -> (y: float) {\n  %s0 = fsqrt %a0\n";
  for (int i = 1; i < depth; ++i)
    text += "  %r" + std::to_string(i) + " = fsqrt %a" + std::to_string(i) + "\n  %s" + std::to_string(i) + " = fadd %s" +
            std::to_string(i - 1) + ", %r" + std::to_string(i) + "\n";
  text += "  %y = fmul %s" + std::to_string(depth - 1) + ", %x\n  return %y\n}\n\n";
  for (int d = depth - 1; d >= 0; --d) {
    const std::string next = "call @f" + std::to_string(d + 1) + "(";
    text += "func @f" + std::to_string(d) + "(" + list("%", ": float", -1) + ", %x: float) -> (y: float) {\n  %y0 = " + next +
            list("%", "", -1) + ", %x)\n  %y1 = " + next + list("%", "", d) + ", %x)\n  %y = fadd %y0, %y1\n  return %y\n}\n\n";
  }
  text += "func @main(%record: int uniform, %x: float) -> (y: float) {\n  %v = load objects[%record]\n  %y = call @f0(";
  for (int i = 0; i < depth; ++i) text += "%v, ";
  text += "%x)\n  return %y\n}\n";
  Module module = ir::parsed(std::string(buffers) + text);
  uint32_t kernel = module.find("main");
  renumber(module);
  const auto values = hoist(module, kernel, rate_of(0));
  EXPECT_EQ(ir::validate(module), "");
  EXPECT_LT(module.functions.size(), 10'000u) << "not 2^15";
  EXPECT_LE(values ? values->words : 0, 256u);
}

/// What the module gives for arguments; the record is that of the first.
Words outcome(const Module& module, uint32_t kernel, const Words& arguments, const Words& memory) {
  ir::Interpreter interpreter(module, ir::Preconditions::report);
  interpreter.bind(floats, memory);
  interpreter.bind(integers, memory);
  size_t size = 0;
  for (const ir::Result& result : module.functions[kernel].results) size += result.type.width;
  Words results(size);
  EXPECT_TRUE(interpreter.run(kernel, arguments, results));
  return results;
}

TEST(Hoist, KeepsEveryBitOfRandomModules) {
  size_t moved = 0;
  for (uint64_t seed = 0; seed < 5000; ++seed) {
    ir::RandomModule random(seed);
    Module before = random.make({.library_calls = seed % 2 == 0, .loads = false});
    functions::expand(before, functions::tiers[seed % functions::tiers.size()]);
    fold(before);
    const Hoisted made = hoisted(before);
    if (!made.values) continue;
    moved += made.values->words;
    const uint32_t main = before.find("main");
    for (uint32_t input = 0; input < 12; ++input) {
      Words arguments = random.words(before.functions[main].parameters);
      arguments[0] = input % 6;
      Words memory(first_word + 6 + made.values->words + 1);
      const bool has_record = !made.values->module.functions[made.values->entry].parameters.empty();
      const Words record(has_record ? 1 : 0, arguments[0]);
      const Words values = outcome(made.values->module, made.values->entry, record, memory);
      ASSERT_EQ(values.size(), made.values->words);
      std::ranges::copy(values, memory.begin() + first_word + arguments[0]);
      ASSERT_EQ(outcome(before, main, arguments, memory), outcome(made.module, made.kernel, arguments, memory))
          << "seed " << seed << "\n"
          << ir::print(before) << "\nbecame\n\n"
          << ir::print(made.module) << "\nand\n\n"
          << ir::print(made.values->module);
    }
  }
  EXPECT_GT(moved, 1500u);
}

}  // namespace
}  // namespace isoshade::passes
