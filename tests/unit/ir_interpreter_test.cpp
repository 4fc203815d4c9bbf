// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cfenv>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "compiler/ir/builder.h"
#include "compiler/ir/interpreter.h"
#include "tests/unit/ir_text.h"

namespace isoshade::ir {
namespace {

using Words = std::vector<uint32_t>;

constexpr uint32_t f(float value) { return std::bit_cast<uint32_t>(value); }
constexpr uint32_t i(int32_t value) { return static_cast<uint32_t>(value); }
constexpr uint32_t zero = 0, minus_zero = 0x80000000, inf = 0x7f800000, minus_inf = 0xff800000,
                   nan = 0x7fc00000;
constexpr uint32_t smallest = 0x00800000, denormal = 0x007fffff, minus_denormal = 0x80000001;
constexpr uint32_t most = 0x7fffffff, least = 0x80000000;

struct Case {
  Opcode op;
  Words operands;
  uint32_t expected;
};

// Worked out by hand from ops.def, not by evaluate.h.
const std::vector<Case> cases{
    {Opcode::fadd, {f(1), f(2)}, f(3)},
    {Opcode::fadd, {f(16777216), f(1)}, f(16777216)},
    {Opcode::fadd, {f(16777216), f(3)}, f(16777220)},
    {Opcode::fadd, {zero, minus_zero}, zero},
    {Opcode::fadd, {minus_zero, minus_zero}, minus_zero},
    {Opcode::fadd, {inf, minus_inf}, nan},
    {Opcode::fadd, {denormal, denormal}, zero},
    {Opcode::fadd, {0x00800001, 0x80800000}, zero},
    {Opcode::fadd, {0x80800001, 0x00800000}, minus_zero},
    {Opcode::fsub, {f(1), f(0x1p-25f)}, f(1)},
    {Opcode::fsub, {zero, zero}, zero},
    {Opcode::fsub, {minus_zero, zero}, minus_zero},
    {Opcode::fsub, {f(5), nan}, nan},
    {Opcode::fmul, {f(3), f(-2)}, f(-6)},
    {Opcode::fmul, {zero, inf}, nan},
    {Opcode::fmul, {zero, f(-1)}, minus_zero},
    {Opcode::fmul, {f(3e38f), f(10)}, inf},
    {Opcode::fmul, {smallest, f(0.5f)}, zero},
    {Opcode::fmul, {0x80800000, f(0.5f)}, minus_zero},
    {Opcode::fmul, {denormal, f(0x1p100f)}, zero},
    {Opcode::fmul, {0x0d7ff800, 0x32800400}, smallest},  // rounds up to normal: tiny only before rounding
    {Opcode::fdiv, {f(1), f(3)}, 0x3eaaaaab},
    {Opcode::fdiv, {f(1), minus_zero}, minus_inf},
    {Opcode::fdiv, {zero, zero}, nan},
    {Opcode::fdiv, {f(1), minus_denormal}, minus_inf},
    {Opcode::fdiv, {smallest, f(2)}, zero},
    {Opcode::fsqrt, {f(2)}, 0x3fb504f3},
    {Opcode::fsqrt, {minus_zero}, minus_zero},
    {Opcode::fsqrt, {f(-1)}, nan},
    {Opcode::fsqrt, {minus_denormal}, minus_zero},
    {Opcode::floor, {f(1.5f)}, f(1)},
    {Opcode::floor, {f(-0.5f)}, f(-1)},
    {Opcode::floor, {f(0.5f)}, zero},
    {Opcode::floor, {minus_zero}, minus_zero},
    {Opcode::floor, {f(-8388607.5f)}, f(-8388608)},
    {Opcode::floor, {f(-3e9f)}, f(-3e9f)},
    {Opcode::floor, {minus_inf}, minus_inf},
    {Opcode::floor, {nan}, nan},
    {Opcode::fneg, {zero}, minus_zero},
    {Opcode::fneg, {f(2)}, f(-2)},
    {Opcode::fneg, {nan}, nan},
    {Opcode::fabs, {minus_zero}, zero},
    {Opcode::fabs, {minus_inf}, inf},
    {Opcode::fabs, {0xffc00001}, nan},
    {Opcode::flt, {f(1), f(2)}, 1},
    {Opcode::flt, {minus_zero, zero}, 0},
    {Opcode::flt, {nan, f(1)}, 0},
    {Opcode::flt, {zero, denormal}, 0},
    {Opcode::fle, {zero, minus_zero}, 1},
    {Opcode::fle, {nan, nan}, 0},
    {Opcode::fgt, {inf, f(3e38f)}, 1},
    {Opcode::fgt, {f(1), nan}, 0},
    {Opcode::fge, {zero, minus_denormal}, 1},
    {Opcode::fge, {minus_inf, nan}, 0},
    {Opcode::feq, {zero, minus_zero}, 1},
    {Opcode::feq, {nan, nan}, 0},
    {Opcode::fne, {nan, nan}, 1},
    {Opcode::fne, {zero, minus_zero}, 0},
    {Opcode::select, {1, f(1), nan}, f(1)},
    {Opcode::select, {0, f(1), 0xffc12345}, nan},
    {Opcode::select, {0, f(1), minus_zero}, minus_zero},
    {Opcode::ftoi, {f(-1.9f)}, i(-1)},
    {Opcode::ftoi, {f(2147483520.0f)}, i(2147483520)},
    {Opcode::ftoi, {f(-2147483648.0f)}, least},
    {Opcode::itof, {i(16777217)}, f(16777216)},
    {Opcode::itof, {i(16777219)}, f(16777220)},
    {Opcode::itof, {least}, f(-2147483648.0f)},
    {Opcode::fbits, {f(1)}, 0x3f800000},
    {Opcode::fbits, {0xff800001}, nan},
    {Opcode::fbits, {minus_inf}, minus_inf},
    {Opcode::fbits, {minus_denormal}, minus_zero},
    {Opcode::fbits_nonnan, {minus_zero}, minus_zero},
    {Opcode::bitsf, {0x3f800000}, f(1)},
    {Opcode::bitsf, {denormal}, zero},
    {Opcode::bitsf, {minus_denormal}, minus_zero},
    {Opcode::bitsf, {0xff800001}, nan},
    {Opcode::bitsf_normal, {minus_zero}, minus_zero},
    {Opcode::bitsf_normal, {smallest}, smallest},
    {Opcode::iadd, {most, 1}, least},
    {Opcode::isub, {least, 1}, most},
    {Opcode::imul, {0x10001, 0x10001}, 0x20001},
    {Opcode::imul, {least, i(-1)}, least},
    {Opcode::imulhi, {i(-1), 1}, i(-1)},
    {Opcode::imulhi, {least, least}, 0x40000000},
    {Opcode::umulhi, {i(-1), i(-1)}, i(-2)},
    {Opcode::umulhi, {i(-1), 1}, 0},
    {Opcode::iand, {0x0ff0, 0x00ff}, 0x00f0},
    {Opcode::ior, {0x0ff0, 0x00ff}, 0x0fff},
    {Opcode::ixor, {0x0ff0, 0x00ff}, 0x0f0f},
    {Opcode::ishl, {3, 31}, least},
    {Opcode::ishl, {3, 0}, 3},
    {Opcode::ishr, {least, 31}, 1},
    {Opcode::isar, {least, 31}, i(-1)},
    {Opcode::ilt, {i(-1), 0}, 1},
    {Opcode::ilt, {0, 0}, 0},
    {Opcode::ile, {0, 0}, 1},
    {Opcode::ile, {1, least}, 0},
    {Opcode::igt, {most, least}, 1},
    {Opcode::igt, {0, 0}, 0},
    {Opcode::ige, {0, 0}, 1},
    {Opcode::ige, {least, 0}, 0},
    {Opcode::ieq, {least, least}, 1},
    {Opcode::ieq, {0, least}, 0},
    {Opcode::ine, {0, least}, 1},
    {Opcode::ine, {7, 7}, 0},
    {Opcode::ult, {most, least}, 1},
    {Opcode::ult, {i(-1), 0}, 0},
    {Opcode::band, {1, 1}, 1},
    {Opcode::band, {1, 0}, 0},
    {Opcode::bor, {1, 0}, 1},
    {Opcode::bor, {0, 0}, 0},
    {Opcode::bxor, {1, 1}, 0},
    {Opcode::bxor, {1, 0}, 1},
    {Opcode::bnot, {0}, 1},
    {Opcode::bnot, {1}, 0},
};

// What an op's operands are, and its result; floats for `choose`.
Type operand_type(Rule rule, size_t operand) {
  switch (rule) {
    case Rule::same:
    case Rule::compare:
    case Rule::to_int: return float_type;
    case Rule::choose: return operand == 0 ? bool_type : float_type;
    case Rule::logic: return bool_type;
    default: return int_type;
  }
}

std::string one_op(Opcode op) {
  const OpInfo& row = info(op);
  std::vector<Type> types;
  std::string parameters, operands;
  for (int k = 0; k < row.arity; ++k) {
    types.push_back(operand_type(row.rule, static_cast<size_t>(k)));
    const std::string separator = k == 0 ? "" : ", ", value = "%p" + std::to_string(k);
    parameters += separator + value + ": " + std::string(name(types.back()));
    operands += separator + value;
  }
  const std::string result(name(*result_type(op, types)));
  return "func @f(" + parameters + ") -> (out: " + result + ") { %r: " + result + " = " +
         std::string(row.name) + " " + operands + " return %r }";
}

TEST(Interpreter, EveryOpMatchesOpsDefOnSpecialValues) {
  std::set<Opcode> seen;
  for (const Case& c : cases) {
    seen.insert(c.op);
    EXPECT_EQ(run(valid(one_op(c.op)), c.operands)[0], c.expected)
        << name(c.op) << std::hex << " " << c.operands[0] << " " << c.operands.back();
  }
  for (int op = 0; op < primitive_count; ++op)
    EXPECT_TRUE(seen.contains(static_cast<Opcode>(op))) << "no case for " << name(static_cast<Opcode>(op));
}

TEST(Interpreter, ArithmeticOnVectorsIsComponentwise) {
  const Module module = valid(R"(
    func @f(%c: bool, %a: vec3, %b: vec3) -> (sum: vec3, chosen: vec3, one: float, made: vec2) {
      %sum: vec3 = fadd %a, %b
      %chosen: vec3 = select %c, %a, %b
      %one = extract %sum, 2
      %made: vec2 = construct %one, %one
      return %sum, %chosen, %one, %made
    })");
  EXPECT_EQ(run(module, {0, f(1), f(2), f(3), f(10), f(20), f(30)}),
            (Words{f(11), f(22), f(33), f(10), f(20), f(30), f(33), f(33), f(33)}));
}

TEST(Interpreter, RunsOnlyTheTakenSideOfABranch) {
  const Module module = valid(R"(
    func @f(%x: float, %in_range: bool) -> (out: int) {
      %r: int = branch %in_range {
        %i: int = ftoi %x
        yield %i
      } else {
        %none: int = constant int -1
        yield %none
      }
      return %r
    })");
  EXPECT_EQ(run(module, {f(7.5f), 1}), Words{7});
  EXPECT_EQ(run(module, {inf, 0}), Words{i(-1)});
}

TEST(Interpreter, LoopsUpdateCarriedValuesAtOnceAndCountFromZero) {
  const Module module = valid(R"(
    func @f(%n: int uniform, %a: float, %b: vec2) -> (a: float, b: vec2, c: vec2, indices: int) {
      %zero: int = constant int 0
      %ra, %rb: vec2, %rc: vec2, %rs: int = loop %i < %n, %x = %a, %y: vec2 = %b, %z: vec2 = %b, %s: int = %zero {
        %first = extract %z, 0
        %swapped: vec2 = construct %x, %first
        %t: int = iadd %s, %i
        yield %first, %z, %swapped, %t
      }
      return %ra, %rb, %rc, %rs
    })");
  EXPECT_EQ(run(module, {0, 1, 2, 3}).back(), 0u);
  EXPECT_EQ(run(module, {i(-5), f(1), f(2), f(3)}), (Words{f(1), f(2), f(3), f(2), f(3), 0}));
  EXPECT_EQ(run(module, {1, f(1), f(2), f(3)}), (Words{f(2), f(2), f(3), f(1), f(2), 0}));
  EXPECT_EQ(run(module, {3, f(1), f(2), f(3)}), (Words{f(2), f(2), f(1), f(1), f(2), 3}));
}

TEST(Interpreter, NestedLoopsRestart) {
  const Module module = valid(R"(
    func @f(%n: int uniform) -> (out: int) {
      %zero: int = constant int 0
      %one: int = constant int 1
      %total: int = loop %i < %n, %sum: int = %zero {
        %inner: int = loop %j < %i, %product: int = %one {
          %next: int = iadd %product, %product
          yield %next
        }
        %more: int = iadd %sum, %inner
        yield %more
      }
      return %total
    })");
  EXPECT_EQ(run(module, {5}), Words{1 + 2 + 4 + 8 + 16});
}

TEST(Interpreter, CalleesKeepNoStateBetweenCalls) {
  const Module module = valid(R"(
    func @f(%x: int) -> (out: int) {
      %a: int, %b: int = call @g(%x)
      %c: int, %d: int = call @g(%b)
      %all: int = iadd %a, %c
      %sum: int = iadd %all, %d
      return %sum
    }
    func @g(%x: int) -> (same: int, doubled: int) {
      %y: int = iadd %x, %x
      return %x, %y
    })");
  EXPECT_EQ(run(module, {5}), Words{5 + 10 + 20});
}

TEST(Interpreter, LoadsClampTheIndexAndFlushDenormals) {
  const Module module = valid(R"(
    buffer floats: float
    buffer ints: int
    func @f(%i: int) -> (x: float, y: int) {
      %x = load floats[%i]
      %y: int = load ints[%i]
      return %x, %y
    })");
  const Words floats{f(1), denormal, 0xffc00001}, ints{10, denormal};
  Interpreter interpreter(module);
  interpreter.bind(0, floats);
  interpreter.bind(1, ints);
  Words results(2);
  const auto at = [&](int32_t index) {
    const Words arguments{i(index)};
    EXPECT_TRUE(interpreter.run(0, arguments, results));
    return results;
  };
  EXPECT_EQ(at(0), (Words{f(1), 10}));
  EXPECT_EQ(at(1), (Words{zero, denormal}));
  EXPECT_EQ(at(2), (Words{nan, denormal}));
  EXPECT_EQ(at(-1), (Words{nan, denormal}));
}

TEST(Interpreter, CountsPreconditionBreachesOnRequest) {
  const auto breaches = [](Opcode op, const Words& operands) {
    const Module module = valid(one_op(op));
    Interpreter interpreter(module, Preconditions::report);
    Words results(1);
    EXPECT_TRUE(interpreter.run(0, operands, results));
    return interpreter.breaches();
  };
  EXPECT_EQ(breaches(Opcode::ftoi, {nan}), 1u);
  EXPECT_EQ(breaches(Opcode::ftoi, {f(2147483648.0f)}), 1u);
  EXPECT_EQ(breaches(Opcode::ftoi, {f(-2147483904.0f)}), 1u);
  EXPECT_EQ(breaches(Opcode::fbits_nonnan, {nan}), 1u);
  EXPECT_EQ(breaches(Opcode::bitsf_normal, {denormal}), 1u);
  EXPECT_EQ(breaches(Opcode::ishl, {1, 32}), 1u);
  EXPECT_EQ(breaches(Opcode::ishr, {1, i(-1)}), 1u);
  EXPECT_EQ(breaches(Opcode::isar, {40, 31}), 0u);

  const Module unbound =
      valid("buffer b: int func @f(%i: int) -> (x: int) { %x: int = load b[%i] return %x }");
  Interpreter interpreter(unbound, Preconditions::report);
  Words results(1);
  EXPECT_TRUE(interpreter.run(0, Words{0}, results));
  EXPECT_EQ(interpreter.breaches(), 1u);
}

TEST(InterpreterDeathTest, BreachPrintsItsFunction) {
  const Module module = valid(R"(
    func @outer(%x: float) -> (out: int) { %r: int = call @inner(%x) return %r }
    func @inner(%x: float) -> (out: int) { %whole: int = ftoi %x return %whole })");
  EXPECT_DEATH(run(module, {nan}), "precondition of %whole: int = ftoi %x\nin\nfunc @inner");
}

TEST(Interpreter, StopsAtItsStepLimit) {
  const Module module = valid(R"(
    func @f(%n: int uniform) -> (out: int) {
      %zero: int = constant int 0
      %r: int = loop %i < %n, %s: int = %zero { yield %i }
      return %r
    })");
  Interpreter interpreter(module);
  Words results(1);
  interpreter.limit_steps(1000);
  EXPECT_FALSE(interpreter.run(0, Words{most}, results));
  interpreter.limit_steps(1000);
  EXPECT_TRUE(interpreter.run(0, Words{10}, results));
  EXPECT_EQ(results[0], 9u);
}

TEST(Interpreter, IgnoresAndRestoresTheFloatModeOfTheCaller) {
  const Module module = valid(one_op(Opcode::fdiv));
  std::fesetround(FE_UPWARD);
  const Words result = run(module, {f(1), f(3)});
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(result, Words{0x3eaaaaab});
}

TEST(Interpreter, LongCallChainsDoNotOverflowTheStack) {
  constexpr int length = 20000;
  std::string text = "func @f0(%x: int) -> (out: int) { %y: int = call @f1(%x) return %y }\n";
  for (int k = 1; k < length; ++k)
    text += "func @f" + std::to_string(k) + "(%x: int) -> (out: int) { %y: int = call @f" +
            std::to_string(k + 1) + "(%x) return %y }\n";
  text +=
      "func @f" + std::to_string(length) + "(%x: int) -> (out: int) { %y: int = iadd %x, %x return %y }\n";
  EXPECT_EQ(run(valid(text), {21}), Words{42});
}

}  // namespace
}  // namespace isoshade::ir
