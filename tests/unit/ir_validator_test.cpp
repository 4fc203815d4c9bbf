// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <gtest/gtest.h>

#include "compiler/ir/builder.h"
#include "compiler/ir/validator.h"
#include "tests/unit/ir_text.h"

namespace isoshade::ir {
namespace {

// Function 0 has instructions 0 constant, 1 extract, 2 branch (blocks 1 with 3 and 2), 4 loop (block 3 with 5),
// 6 call, 7 load, 8 construct.
constexpr std::string_view sound = R"(
buffer b: float
buffer c: int
func @f(%n: int uniform, %x: float, %g.v: vec3, %g.w: vec3, %t: bool) -> (out: float, more: vec2) {
  %one = constant float 0x3f800000
  %z = extract %g.v, 2
  %side = branch %t {
    %sum = fadd %x, %z
    yield %sum
  } else {
    yield %one
  }
  %total = loop %i < %n, %carried = %side {
    %next = fmul %carried, %x
    yield %next
  }
  %called = call @g(%n, %total)
  %loaded = load b[%n]
  %pair: vec2 = construct %called, %loaded
  return %total, %pair
}
func @g(%n: int uniform, %x: float) -> (out: float) library "g"
)";

struct Breach {
  std::string_view says;
  std::function<void(Module&)> change;
};

Function& f(Module& m) { return m.functions[0]; }

TEST(Validator, AcceptsAValidModule) { EXPECT_EQ(validate(parsed(sound)), ""); }

TEST(Validator, ReportsTheFirstBreachOfEveryRule) {
  const std::vector<Breach> breaches{
      {"buffer 1: its name", [](Module& m) { m.buffers[0].name = "1"; }},
      {"two buffers", [](Module& m) { m.buffers[0].name = "c"; }},
      {"its elements", [](Module& m) { m.buffers[0].element = Scalar::boolean; }},
      {"function f-: its name", [](Module& m) { f(m).name = "f-"; }},
      {"two functions", [](Module& m) { m.functions[1].name = "f"; }},
      {"parameter x y: its name", [](Module& m) { f(m).parameters[1].name = "x y"; }},
      {"its group's name", [](Module& m) { f(m).parameters[1].group = "a.b"; }},
      {"parameter x: no such type", [](Module& m) { f(m).parameters[1].type = vector_type(5); }},
      {"parameter x: no such type",
       [](Module& m) {
         f(m).parameters[1].type = {Scalar::integer, 2};
       }},
      {"parameter v: there are two", [](Module& m) { f(m).parameters[3].name = "v"; }},
      {"its group is not consecutive", [](Module& m) { std::swap(f(m).parameters[1], f(m).parameters[2]); }},
      {"a group and a parameter", [](Module& m) { f(m).parameters[1].name = "g"; }},
      {"result : its name", [](Module& m) { f(m).results[0].name = ""; }},
      {"two results", [](Module& m) { f(m).results[0].name = "more"; }},
      {"result out: no such type", [](Module& m) { f(m).results[0].type.width = 0; }},
      {"origin 0", [](Module& m) { f(m).origins[0].line = 3; }},
      {"origin 0", [](Module& m) { f(m).origins.clear(); }},
      {"the node of origin 1", [](Module& m) { f(m).origins[1].node = "//"; }},
      {"names no origin", [](Module& m) { f(m).values[2].names = 99; }},
      {"wrong number of parameters", [](Module& m) { f(m).blocks[0].parameters.pop_back(); }},
      {"a block's parameter is no value", [](Module& m) { f(m).blocks[0].parameters[0] = 999; }},
      {"a block's parameter is already defined", [](Module& m) { f(m).blocks[0].parameters[1] = 0; }},
      {"a block's parameter has the wrong type",
       [](Module& m) { std::swap(f(m).blocks[0].parameters[0], f(m).blocks[0].parameters[1]); }},
      {"no such instruction", [](Module& m) { f(m).blocks[0].instructions[0] = 99; }},
      {"an instruction has two places", [](Module& m) { f(m).blocks[0].instructions[1] = 0; }},
      {"yields the wrong number", [](Module& m) { f(m).blocks[0].yields.pop_back(); }},
      {"a yielded value is not visible", [](Module& m) { f(m).blocks[0].yields[0] = 999; }},
      {"a yielded value is not visible",
       [](Module& m) { f(m).blocks[0].yields[0] = f(m).blocks[1].yields[0]; }},
      {"a yielded value has the wrong type", [](Module& m) { f(m).blocks[0].yields[0] = 2; }},
      {"(?): no such op", [](Module& m) { f(m).instructions[0].op = static_cast<Opcode>(200); }},
      {"its origin does not exist", [](Module& m) { f(m).instructions[0].origin = 99; }},
      {"its operands are out of range", [](Module& m) { f(m).instructions[1].first_operand = 999; }},
      {"its operands are out of range", [](Module& m) { f(m).instructions[1].operand_count = ~0u; }},
      {"its results are out of range", [](Module& m) { f(m).instructions[2].result_count = ~0u; }},
      {"operand 0 is not visible", [](Module& m) { f(m).operands_of(f(m).instructions[1])[0] = 999; }},
      {"operand 0 is not visible",
       [](Module& m) { f(m).operands_of(f(m).instructions[1])[0] = f(m).instructions[8].first_result; }},
      {"operand 1 is not visible",
       [](Module& m) { f(m).operands_of(f(m).instructions[8])[1] = f(m).instructions[3].first_result; }},
      {"a block too many", [](Module& m) { f(m).instructions[0].blocks[0] = 1; }},
      {"(loop): it has a block too many", [](Module& m) { f(m).instructions[4].blocks[1] = 1; }},
      {"takes no immediate", [](Module& m) { f(m).instructions[3].imm = 1; }},
      {"wrong number of results", [](Module& m) { f(m).instructions[3].result_count = 2; }},
      {"its result is already defined", [](Module& m) { f(m).instructions[3].first_result = 0; }},
      {"its result is no value", [](Module& m) { f(m).instructions[3].first_result = 999; }},
      {"its result has the wrong type",
       [](Module& m) { f(m).values[f(m).instructions[3].first_result].type = int_type; }},
      {"it takes no operand", [](Module& m) { f(m).instructions[0].operand_count = 1; }},
      {"a constant is a scalar",
       [](Module& m) { f(m).values[f(m).instructions[0].first_result].type = vector_type(2); }},
      {"a bool is 0 or 1",
       [](Module& m) { f(m).values[f(m).instructions[0].first_result].type = bool_type; }},
      {"NaN is 0x7fc00000", [](Module& m) { f(m).instructions[0].imm = 0xffc00000; }},
      {"never denormal", [](Module& m) { f(m).instructions[0].imm = 0x80000001; }},
      {"a vector has 2 to 4", [](Module& m) { f(m).instructions[8].operand_count = 1; }},
      {"components are floats", [](Module& m) { f(m).operands_of(f(m).instructions[8])[0] = 0; }},
      {"it takes a vector", [](Module& m) { f(m).operands_of(f(m).instructions[1])[0] = 1; }},
      {"no such component", [](Module& m) { f(m).instructions[1].imm = 3; }},
      {"(load): it takes an int", [](Module& m) { f(m).operands_of(f(m).instructions[7])[0] = 1; }},
      {"no such buffer", [](Module& m) { f(m).instructions[7].imm = 2; }},
      {"do not fit its rule", [](Module& m) { f(m).operands_of(f(m).instructions[3])[0] = 0; }},
      {"do not fit its rule", [](Module& m) { f(m).instructions[3].operand_count = 1; }},
      {"no such function", [](Module& m) { f(m).instructions[6].imm = 2; }},
      {"the arguments do not fit", [](Module& m) { m.functions[1].parameters[1].type = int_type; }},
      {"(branch): it takes a bool", [](Module& m) { f(m).operands_of(f(m).instructions[2])[0] = 0; }},
      {"(branch): no such block", [](Module& m) { f(m).instructions[2].blocks[1] = none; }},
      {"a block has two places", [](Module& m) { f(m).instructions[2].blocks[1] = 1; }},
      {"a block has two places", [](Module& m) { f(m).instructions[4].blocks[0] = 0; }},
      {"(branch): a block has the wrong number", [](Module& m) { f(m).blocks[2].parameters = {0}; }},
      {"(branch): a yielded value has the wrong type", [](Module& m) { f(m).blocks[2].yields = {0}; }},
      {"(loop): it takes an int count", [](Module& m) { f(m).operands_of(f(m).instructions[4])[0] = 1; }},
      {"(loop): a block has the wrong number", [](Module& m) { f(m).blocks[3].parameters.pop_back(); }},
      {"(loop): a yielded value has the wrong type", [](Module& m) { f(m).blocks[3].yields = {0}; }},
      {"(loop): its count is not uniform", [](Module& m) { f(m).parameters[0].uniform = false; }},
      {"is uniform, the argument is not", [](Module& m) { m.functions[1].parameters[1].uniform = true; }},
  };
  for (const Breach& breach : breaches) {
    Module module = parsed(sound);
    breach.change(module);
    const std::string message = validate(module);
    EXPECT_NE(message.find(breach.says), std::string::npos)
        << "expected: " << breach.says << "\ngot: " << message;
  }
}

TEST(Validator, RejectsRecursion) {
  EXPECT_EQ(validate(parsed(R"(
    func @f(%x: float) -> (out: float) { %y = call @g(%x) return %y }
    func @g(%x: float) -> (out: float) { %y = call @f(%x) return %y })")),
            "a function calls itself");
}

TEST(Validator, RejectsDeeplyNestedBlocks) {
  const auto nested = [](int depth) {
    Module module;
    module.functions.push_back({});
    Function& f = module.functions[0];
    f.name = "f";
    f.parameters.push_back({"c", bool_type, "", false});
    f.values.push_back({bool_type, 0});
    f.operands.push_back(0);
    f.blocks.resize(static_cast<size_t>(1 + 2 * depth));
    f.blocks[0].parameters = {0};
    for (uint32_t level = 0; level < static_cast<uint32_t>(depth); ++level) {
      Instruction branch;
      branch.op = Opcode::branch;
      branch.operand_count = 1;
      branch.first_result = 1;
      branch.result_count = 0;
      branch.blocks = {1 + 2 * level, 2 + 2 * level};
      f.instructions.push_back(branch);
      f.blocks[level == 0 ? 0 : 2 * level - 1].instructions = {level};
    }
    return validate(module);
  };
  EXPECT_EQ(nested(max_block_depth - 1), "");
  EXPECT_NE(nested(max_block_depth).find("blocks nest too deep"), std::string::npos);
  EXPECT_NE(nested(100000).find("blocks nest too deep"), std::string::npos);
}

TEST(BuilderDeathTest, AbortsOnNestingDeeperThanValid) {
  const auto nest = [](int branches) {
    Module module;
    module.functions.emplace_back();
    module.functions[0].name = "f";
    module.functions[0].parameters.push_back({"c", bool_type, "", false});
    Builder b(module, 0);
    const auto inner = [&](const auto& self, int rest) -> std::vector<ValueId> {
      if (rest == 0) return {};
      return b.branch(
          b.parameter(0), [&] { return self(self, rest - 1); }, [] { return std::vector<ValueId>(); });
    };
    inner(inner, branches);
    b.finish({});
    return validate(module);
  };
  EXPECT_EQ(nest(max_block_depth - 1), "");
  EXPECT_DEATH(nest(max_block_depth), "blocks nest too deep");
}

// Every word of a sound module replaced by others in turn: nothing may crash or be accepted and then crash.
TEST(Validator, SurvivesEveryCorruptedWord) {
  const Module module = parsed(sound);
  const uint32_t words[] = {0, 1, 2, 3, 7, 15, 99, 0x7fffffff, none};
  size_t rejected = 0;
  const auto probe = [&](auto change) {
    for (uint32_t word : words) {
      Module broken = module;
      change(broken, word);
      rejected += !validate(broken).empty();
    }
  };
  const Function& whole = module.functions[0];
  for (size_t i = 0; i < whole.instructions.size(); ++i) {
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].op = static_cast<Opcode>(word & 63); });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].imm = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].first_operand = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].operand_count = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].first_result = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].result_count = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].blocks[0] = word; });
    probe([i](Module& m, uint32_t word) { f(m).instructions[i].blocks[1] = word; });
  }
  for (size_t i = 0; i < whole.operands.size(); ++i)
    probe([i](Module& m, uint32_t word) { f(m).operands[i] = word; });
  for (size_t i = 0; i < whole.values.size(); ++i) {
    probe([i](Module& m, uint32_t word) { f(m).values[i].type.width = static_cast<uint8_t>(word); });
    probe([i](Module& m, uint32_t word) { f(m).values[i].type.scalar = static_cast<Scalar>(word); });
  }
  for (size_t i = 0; i < whole.blocks.size(); ++i) {
    probe([i](Module& m, uint32_t word) { f(m).blocks[i].parameters.push_back(word); });
    probe([i](Module& m, uint32_t word) { f(m).blocks[i].instructions.push_back(word); });
    probe([i](Module& m, uint32_t word) { f(m).blocks[i].yields.push_back(word); });
  }
  EXPECT_GT(rejected, 500u);
}

}  // namespace
}  // namespace isoshade::ir
