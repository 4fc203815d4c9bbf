// SPDX-License-Identifier: Apache-2.0
// The promise of every pass: no bit of any result changes, whatever the module and the inputs.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>

#include "compiler/functions/library.h"
#include "compiler/ir/builder.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/printer.h"
#include "compiler/ir/validator.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "tests/unit/random_module.h"

namespace isoshade::passes {
namespace {

using ir::Module;
using ir::RandomModule;
using Words = std::vector<uint32_t>;

constexpr int inputs_per_module = 24;

// A number that a parameter may be.
uint32_t within(const ir::Parameter& parameter, RandomModule& random) {
  const float least = *parameter.least, most = *parameter.most;
  const std::array some{least, most, -0.0f, 0.0f, least / 2 + most / 2, std::nextafter(least, most)};
  const float value = some[random.below(some.size())];
  return std::bit_cast<uint32_t>(value >= least && value <= most ? value : least);
}

// What the module's `main` gives on random inputs.
std::vector<Words> outcomes(const Module& module, uint64_t seed) {
  RandomModule random(seed);
  const uint32_t main = module.find("main");
  const ir::Function& function = module.functions[main];
  const Words floats = random.buffer_words(5), ints = random.buffer_words(7);
  ir::Interpreter interpreter(module, ir::Preconditions::report);
  interpreter.bind(0, floats);
  interpreter.bind(1, ints);
  size_t size = 0;
  for (const ir::Result& result : function.results) size += result.type.width;
  std::vector<Words> all;
  for (int i = 0; i < inputs_per_module; ++i) {
    all.emplace_back(size);
    Words words = random.words(function.parameters);
    for (size_t p = 0, word = 0; p < function.parameters.size(); word += function.parameters[p++].type.width)
      for (uint32_t c = 0; c < function.parameters[p].type.width; ++c)
        if (function.parameters[p].least) words[word + c] = within(function.parameters[p], random);
    EXPECT_TRUE(interpreter.run(main, words, all.back()));
  }
  return all;
}

functions::Tier tier_of(uint64_t seed) { return functions::tiers[seed % functions::tiers.size()]; }

Module with_bodies(Module module, uint64_t seed) {
  functions::expand(module, tier_of(seed));
  return module;
}

template <class Change>
void expect_same_bits(int modules, bool library_calls, Change change) {
  for (uint64_t seed = 0; seed < static_cast<uint64_t>(modules); ++seed) {
    const Module before = RandomModule(seed).make({.library_calls = library_calls});
    ASSERT_EQ(ir::validate(before), "") << ir::print(before);
    Module after = before;
    change(after, seed);
    ASSERT_EQ(ir::validate(after), "") << "seed " << seed << "\n" << ir::print(before) << ir::print(after);
    const uint64_t input_seed = seed + 1'000'000;
    ASSERT_EQ(outcomes(with_bodies(before, seed), input_seed), outcomes(with_bodies(after, seed), input_seed))
        << "seed " << seed << "\n"
        << ir::print(before) << "\nbecame\n\n"
        << ir::print(after);
  }
}

TEST(PassesKeepEveryBit, Renumber) {
  expect_same_bits(1500, false, [](Module& m, uint64_t) { renumber(m); });
}

TEST(PassesKeepEveryBit, Cse) {
  expect_same_bits(1500, false, [](Module& m, uint64_t) { cse(m); });
}

TEST(PassesKeepEveryBit, Fold) {
  expect_same_bits(3000, false, [](Module& m, uint64_t) { fold(m); });
}

TEST(PassesKeepEveryBit, FoldOfLibraryCalls) {
  expect_same_bits(1000, true, [](Module& m, uint64_t seed) { fold(m, tier_of(seed)); });
}

TEST(PassesKeepEveryBit, Decide) {
  constexpr std::array ends{-1e30f, -1.0f, -0.0f, 0.0f, 1e-3f, 0.5f, 1.0f, 2.0f, 1e30f};
  int changed = 0;
  for (uint64_t seed = 0; seed < 2000; ++seed) {
    RandomModule random(seed);
    Module before = random.make({.library_calls = true});
    ir::Function& main = before.functions[before.find("main")];
    main.document = "test.json";
    for (ir::Parameter& parameter : main.parameters) {
      const float a = ends[random.below(ends.size())], b = ends[random.below(ends.size())];
      if (!parameter.type.is_float() || random.below(5) == 0) continue;
      parameter.least = std::min(a, b);
      parameter.most = std::max(a, b);
    }
    before = with_bodies(before, seed);
    Module after = before;
    decide(after, tier_of(seed));
    ASSERT_EQ(ir::validate(after), "") << ir::print(before);
    changed += ir::print(before) != ir::print(after);
    ASSERT_EQ(outcomes(before, seed), outcomes(after, seed)) << "seed " << seed << "\n"
                                                             << ir::print(before) << "\nbecame\n\n"
                                                             << ir::print(after);
  }
  EXPECT_GT(changed, 200);
}

/// A tree of operations with many choices: most values are used once, and some by both sides.
class RandomChoices {
 public:
  explicit RandomChoices(uint64_t seed) : random_(seed), builder_(declared(module_), 0) {}

  Module make() {
    for (size_t i = 0; i < 3; ++i) seen_.push_back(builder_.parameter(i));
    for (int i = 0; i < 3; ++i) conditions_.push_back(builder_.op(ir::Opcode::flt, {any(seen_), any(seen_)}));
    conditions_.push_back(builder_.parameter(3));
    builder_.finish(std::array{grow(6), grow(5)});
    return std::move(module_);
  }

 private:
  static Module& declared(Module& module) {
    module.buffers = {{"floats", ir::Scalar::floating}, {"ints", ir::Scalar::integer}};  // which outcomes() binds
    ir::Function& main = module.functions.emplace_back();
    main.name = "main";
    for (const char* name : {"x", "y", "z"}) main.parameters.push_back({name, ir::float_type, "", false});
    main.parameters.push_back({"c", ir::bool_type, "", true});
    main.parameters.push_back({"n", ir::int_type, "", true});
    main.results = {{"a", ir::float_type}, {"b", ir::float_type}};
    return module;
  }
  ir::ValueId any(const std::vector<ir::ValueId>& of) { return of[random_.below(static_cast<uint32_t>(of.size()))]; }

  ir::ValueId grow(int depth) {
    if (depth == 0 || random_.below(8) == 0) return any(seen_);
    const ir::ValueId made = made_of(depth - 1);
    if (!inside_ && random_.below(4) == 0) seen_.push_back(made);
    return made;
  }
  ir::ValueId made_of(int depth) {
    constexpr std::array ops{ir::Opcode::fadd, ir::Opcode::fsub, ir::Opcode::fmul, ir::Opcode::fdiv};
    const uint32_t kind = random_.below(10);
    if (kind < 4) return builder_.op(ir::Opcode::select, {any(conditions_), grow(depth), grow(depth)});
    if (kind == 4) return nested([&] { return branch(depth); });
    if (kind == 5) return nested([&] { return loop(depth); });
    return builder_.op(ops[random_.below(4)], {grow(depth), grow(depth)});
  }
  template <class Make>
  ir::ValueId nested(Make make) {
    const bool outer = std::exchange(inside_, true);
    const ir::ValueId made = make();
    inside_ = outer;
    return made;
  }
  ir::ValueId branch(int depth) {
    const auto side = [&] { return std::vector{grow(depth)}; };
    return builder_.branch(any(conditions_), side, side)[0];
  }
  ir::ValueId loop(int depth) {
    const std::array initial{grow(depth)};
    const ir::ValueId count = builder_.op(ir::Opcode::iand, {builder_.parameter(4), builder_.constant(3)});
    return builder_.loop(count, initial, [&](ir::ValueId, std::span<const ir::ValueId> carried) {
      return std::vector{builder_.op(ir::Opcode::select, {any(conditions_), grow(depth), carried[0]})};
    })[0];
  }

  RandomModule random_;
  Module module_;
  ir::Builder builder_;
  std::vector<ir::ValueId> seen_, conditions_;
  bool inside_ = false;  ///< of a block whose values are not seen outside
};

TEST(PassesKeepEveryBit, SinkAndFold) {
  size_t made = 0;
  for (uint64_t seed = 0; seed < 1500; ++seed) {
    const Module before = RandomChoices(seed).make();
    ASSERT_EQ(ir::validate(before), "") << ir::print(before);
    Module after = before;
    made += sink(after, {1 + seed % 5, 1 + seed % 3});
    ASSERT_EQ(ir::validate(after), "") << "seed " << seed << "\n" << ir::print(before);
    if (seed % 2 == 0) fold(after);
    if (seed % 4 == 0) renumber(after);
    ASSERT_EQ(ir::validate(after), "") << "seed " << seed << "\n" << ir::print(before);
    ASSERT_EQ(outcomes(before, seed), outcomes(after, seed)) << "seed " << seed << "\n" << ir::print(before)
                                                             << "\nbecame\n\n" << ir::print(after);
  }
  EXPECT_GT(made, 3000u);
}

TEST(PassesKeepEveryBit, Sink) {
  expect_same_bits(1500, false, [](Module& m, uint64_t seed) { sink(m, {1 + seed % 4, 1}); });
}

TEST(PassesKeepEveryBit, HideFoldables) {
  expect_same_bits(3000, false, [](Module& m, uint64_t) { hide_foldables(m, {}); });
}

TEST(PassesKeepEveryBit, CutLong) {
  size_t parts = 0;
  expect_same_bits(2000, false, [&](Module& m, uint64_t seed) {
    const size_t functions = m.functions.size();
    cut_long(m, 2 + seed % 8);
    parts += m.functions.size() - functions;
  });
  EXPECT_GT(parts, 2000u);
}

/// Adds a parameter that is not read to each function but `main`, and a call's argument for it: its first one or a constant.
void add_unread_parameters(Module& module) {
  const auto is_main = [](const ir::Function& f) { return f.name == "main"; };
  for (ir::Function& f : module.functions) {
    if (f.is_declaration() || is_main(f)) continue;
    f.parameters.push_back({"unread", ir::float_type, "", false});
    f.values.push_back({ir::float_type, 0});
    f.blocks[0].parameters.push_back(static_cast<ir::ValueId>(f.values.size() - 1));
  }
  for (ir::Function& f : module.functions)
    for (ir::Block& block : f.blocks)
      for (size_t i = 0; i < block.instructions.size(); ++i) {
        const ir::InstructionId id = block.instructions[i];
        if (f.instructions[id].op != ir::Opcode::call || module.functions[f.instructions[id].imm].is_declaration()) continue;
        ir::Instruction constant;
        constant.op = ir::Opcode::constant;
        constant.first_result = static_cast<ir::ValueId>(f.values.size());
        f.values.push_back({ir::float_type, 0});
        f.instructions.push_back(constant);
        block.instructions.insert(block.instructions.begin() + static_cast<std::ptrdiff_t>(i++),
                                  static_cast<ir::InstructionId>(f.instructions.size() - 1));
        ir::Instruction& call = f.instructions[id];
        const auto first = static_cast<uint32_t>(f.operands.size());
        for (uint32_t k = 0; k < call.operand_count; ++k) f.operands.push_back(f.operands[call.first_operand + k]);
        f.operands.push_back(constant.first_result);
        call.first_operand = first;
        ++call.operand_count;
      }
}

TEST(PassesKeepEveryBit, DropUnread) {
  size_t functions = 0, returned = 0, kept = 0;
  expect_same_bits(1500, false, [&](Module& m, uint64_t seed) {
    cut_long(m, 2 + seed % 8);
    add_unread_parameters(m);
    renumber(m);
    std::vector<uint32_t> entries{m.find("main")};
    dce(m, entries);
    for (const ir::Function& f : m.functions) returned += f.results.size();
    drop_unread(m, entries);
    for (const ir::Function& f : m.functions) {
      functions += 1;
      kept += f.results.size();
      for (const ir::Parameter& parameter : f.parameters) EXPECT_NE(parameter.name, "unread");
    }
    EXPECT_EQ(m.functions[entries[0]].name, "main");
  });
  EXPECT_GT(functions, 3000u);
  EXPECT_LE(kept, returned);
}

size_t count_wide_products(const Module& module) {
  size_t count = 0;
  for (const ir::Function& function : module.functions)
    count += static_cast<size_t>(std::ranges::count_if(function.instructions, [](const ir::Instruction& made) {
      return made.op == ir::Opcode::imulhi || made.op == ir::Opcode::umulhi;
    }));
  return count;
}

TEST(PassesKeepEveryBit, MultiplyByHalves) {
  size_t replaced = 0;
  expect_same_bits(1000, false, [&](Module& m, uint64_t) {
    replaced += count_wide_products(m);
    Entries entries{m.find("main")};
    run(multiplication_lowering(), m, entries, functions::Tier::standard);
    EXPECT_EQ(count_wide_products(m), 0u);
  });
  EXPECT_GT(replaced, 300u);
}

// All pairs of words near a power of two or a carry, and random pairs.
TEST(PassesKeepEveryBit, MultiplyByHalvesOnEdgesAndRandomWords) {
  Module before;
  const std::array ops{ir::Opcode::imulhi, ir::Opcode::umulhi};
  ir::Function main;
  main.name = "main";
  for (const char* name : {"x", "y"}) main.parameters.push_back({name, ir::int_type, "", false});
  for (const char* name : {"high", "unsigned_high"}) main.results.push_back({name, ir::int_type});
  before.functions.push_back(main);
  ir::Builder builder(before, 0);
  std::vector<ir::ValueId> results;
  for (const ir::Opcode op : ops) results.push_back(builder.op(op, {builder.parameter(0), builder.parameter(1)}));
  builder.finish(results);
  Module after = before;
  Entries entries{0};
  run(multiplication_lowering(), after, entries, functions::Tier::standard);
  EXPECT_EQ(count_wide_products(after), 0u);

  ir::Interpreter by_op(before, ir::Preconditions::report), by_halves(after, ir::Preconditions::report);
  const auto expect_same = [&](uint32_t x, uint32_t y) {
    const Words words{x, y};
    Words expected(2), made(2);
    ASSERT_TRUE(by_op.run(0, words, expected) && by_halves.run(entries[0], words, made));
    ASSERT_EQ(made, expected) << std::hex << x << " " << y;
  };
  Words edges{0};
  for (int bit = 0; bit < 32; ++bit)
    for (const uint32_t near : {-1u, 0u, 1u})
      for (const uint32_t sign : {0u, ~0u}) edges.push_back(((1u << bit) + near) ^ sign);
  for (const uint32_t x : edges)
    for (const uint32_t y : edges) expect_same(x, y);
  RandomModule random(1);
  const auto word = [&] { return static_cast<uint32_t>(random.below(1u << 16) << 16 | random.below(1u << 16)); };
  for (int i = 0; i < 50'000; ++i) expect_same(word(), word());
}

TEST(PassesKeepEveryBit, AnySequence) {
  expect_same_bits(3000, false, [](Module& m, uint64_t seed) {
    RandomModule random(seed + 77);
    for (int i = 0; i < 8; ++i) {
      Entries entries{m.find("main")};
      switch (random.below(7)) {
        case 0: renumber(m); break;
        case 1: cse(m); break;
        case 2: fold(m); break;
        case 3: hide_foldables(m, {}); break;
        case 4: renumber(m), drop_unread(m, entries.functions); break;
        case 5: sink(m, {2, 1}); break;
        default: renumber(m), dce(m, entries.functions);
      }
      ASSERT_EQ(ir::validate(m), "");
    }
  });
}

TEST(PassesKeepEveryBit, BothPipelines) {
  expect_same_bits(1000, true, [](Module& m, uint64_t seed) {
    Entries entries{m.find("main")};
    interface::Skips skips;
    skips.set(interface::Skip::branches, seed % 2 == 0);
    skips.set(interface::Skip::ranges, seed % 3 == 0);
    run(optimisations(), m, entries, tier_of(seed), {}, true, skips);
    EXPECT_EQ(m.functions[entries[0]].name, "main");
    run(division_lowering(), m, entries, tier_of(seed), {}, true);
    for (const ir::Function& function : m.functions)
      for (const ir::Instruction& instruction : function.instructions)
        EXPECT_TRUE(instruction.op != ir::Opcode::fdiv && instruction.op != ir::Opcode::fsqrt);
  });
}

}  // namespace
}  // namespace isoshade::passes
