// SPDX-License-Identifier: Apache-2.0
// The batched interpreter gives the bits of the scalar one.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>

#include "backends/interpreter/backend.h"
#include "backends/interpreter/draft.h"
#include "backends/interpreter/stages.h"
#include "compiler/ir/builder.h"
#include "compiler/ir/validator.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"
#include "tests/unit/scalar_interpreter.h"

namespace isoshade::interpreter {
namespace {

using driver::Program;
using ir::Opcode;
using ir::ValueId;
using Values = std::vector<ValueId>;

/// The eval program of a function of a float and an int, with the results that `body` gives.
template <class Body>
Program program_of(std::vector<ir::Type> results, const Body& body) {
  Program program;
  program.stage = driver::Stage::eval;
  program.name = "test";
  program.module = lower::frame_module();
  ir::Function function;
  function.name = "test";
  function.parameters = {{"x", ir::float_type, "", false}, {"n", ir::int_type, "", false}};
  program.inputs = {{"x", "float", 1, {}, {}, {}}, {"n", "integer", 1, {}, {}, {}}};
  for (const ir::Type type : results) {
    const std::string name = "r" + std::to_string(function.results.size());
    function.results.push_back({name, type});
    program.results.push_back({name, type == ir::bool_type ? "boolean" : "float", type.width, {}, {}, {}});
  }
  program.module.functions.push_back(std::move(function));
  ir::Builder b(program.module, 0);
  b.finish(body(b, b.parameter(0), b.parameter(1)));
  program.entry = lower::add_eval_kernel(program.module, 0);
  EXPECT_EQ(ir::validate(program.module), "");
  return program;
}

void expect_the_same_bits(const Program& program) {
  // Neither a multiple of any number of lanes nor of a batch; what differs between neighbours, and what does not.
  constexpr size_t rows = 1013;
  std::vector<int32_t> inputs;
  for (size_t i = 0; i < rows; ++i) {
    inputs.push_back(std::bit_cast<int32_t>(static_cast<float>(i % 100) * 0.75f - 20));
    inputs.push_back(static_cast<int32_t>(i < 500 ? i * 7 % 13 : i / 64) - 2);
  }
  support::Diagnostics diagnostics;
  std::vector<int32_t> expected, results;
  ASSERT_TRUE(create_scalar()->evaluate(program, inputs, rows, expected, diagnostics)) << diagnostics.text();
  for (const int lanes : {4, 8, 16}) {
    if (lanes > Code::widest_lanes()) continue;
    ASSERT_TRUE(create(2, lanes)->evaluate(program, inputs, rows, results, diagnostics)) << diagnostics.text();
    EXPECT_EQ(results, expected) << lanes << " lanes";
  }
}

TEST(Code, CarriesOnWhatAnotherValueWas) {
  // Fibonacci's numbers.
  expect_the_same_bits(program_of({ir::float_type, ir::float_type}, [](ir::Builder& b, ValueId x, ValueId) {
    return b.loop(b.constant(10), std::array{x, b.constant(1.0f)}, [&](ValueId, std::span<const ValueId> c) {
      return Values{c[1], b.op(Opcode::fadd, {c[0], c[1]})};
    });
  }));
}

TEST(Code, CarriesScalarsAndLanesThroughNestedLoops) {
  expect_the_same_bits(program_of({ir::float_type, ir::float_type}, [](ir::Builder& b, ValueId x, ValueId) {
    return b.loop(b.constant(4), std::array{b.constant(1.0f), x}, [&](ValueId index, std::span<const ValueId> c) {
      const auto inner = b.loop(b.constant(3), std::array{c[0], b.constant(0.0f)},
                                [&](ValueId, std::span<const ValueId> d) {
                                  return Values{b.op(Opcode::fadd, {d[0], b.op(Opcode::itof, {index})}),
                                                b.op(Opcode::fadd, {d[1], d[0]})};
                                });
      return Values{b.op(Opcode::fmul, {inner[0], b.constant(0.5f)}), b.op(Opcode::fadd, {c[1], inner[1]})};
    });
  }));
}

TEST(Code, RunsSidesOfBranchesForTheLanesThatWantThem) {
  expect_the_same_bits(program_of({ir::float_type, ir::bool_type}, [](ir::Builder& b, ValueId x, ValueId n) {
    const ValueId zero = b.constant(0.0f);
    const auto outer = b.loop(b.constant(7), std::array{x, b.op(Opcode::flt, {x, zero})}, [&](ValueId index, std::span<const ValueId> c) {
      return b.branch(
          b.op(Opcode::flt, {c[0], b.constant(3.0f)}),
          [&] {
            const auto nested = b.branch(
                b.op(Opcode::ilt, {n, index}),
                [&] { return Values{b.op(Opcode::fadd, {c[0], b.constant(2.5f)})}; }, [&] { return Values{c[0]}; });
            return Values{nested[0], b.op(Opcode::bnot, {c[1]})};
          },
          [&] {
            const auto more = b.loop(b.constant(3), std::array{c[0]}, [&](ValueId, std::span<const ValueId> d) {
              return Values{b.op(Opcode::fsub, {d[0], b.op(Opcode::fmul, {x, b.constant(0.25f)})})};
            });
            return Values{more[0], c[1]};
          });
    });
    return Values{outer[0], outer[1]};
  }));
}

TEST(Code, LeavesValuesAloneThatALoopChangesInPlace) {
  // The sum is read after a product that could be computed later, and again by the next turn.
  expect_the_same_bits(program_of({ir::float_type, ir::float_type}, [](ir::Builder& b, ValueId x, ValueId) {
    return b.loop(b.constant(5), std::array{x, x}, [&](ValueId, std::span<const ValueId> c) {
      const ValueId product = b.op(Opcode::fmul, {c[0], b.constant(1.25f)});
      const ValueId next = b.op(Opcode::fadd, {c[0], c[1]});
      return Values{next, b.op(Opcode::fsub, {product, c[1]})};
    });
  }));
}

TEST(Code, CarriesOnBitsOfAnotherValue) {
  // Reinterpreting bits is no step: what is carried on is the other value itself.
  expect_the_same_bits(program_of({ir::float_type, ir::float_type}, [](ir::Builder& b, ValueId x, ValueId n) {
    return b.loop(b.constant(5), std::array{x, b.op(Opcode::itof, {n})}, [&](ValueId, std::span<const ValueId> c) {
      const ValueId bits = b.op(Opcode::fbits, {c[1]});
      const ValueId other = b.op(Opcode::bitsf_normal, {b.op(Opcode::fbits_nonnan, {c[0]})});
      return Values{b.op(Opcode::bitsf, {b.op(Opcode::ixor, {bits, b.constant(64)})}), other};
    });
  }));
}

/// Rotations and differences of exclusive ors, as in hashes, with operands in either order.
Values hashed(ir::Builder& b, ValueId n) {
  const auto rotated = [&](ValueId x, int amount, bool left_first) {
    const ValueId left = b.op(Opcode::ishl, {x, b.constant(amount)}), right = b.op(Opcode::ishr, {x, b.constant(32 - amount)});
    return left_first ? b.op(Opcode::ior, {left, right}) : b.op(Opcode::ior, {right, left});
  };
  const ValueId mixed = b.op(Opcode::isub, {b.op(Opcode::ixor, {n, b.constant(77)}), rotated(n, 14, true)});
  const ValueId again = b.op(Opcode::isub, {rotated(mixed, 5, false), b.op(Opcode::ixor, {n, mixed})});
  return {b.op(Opcode::iand, {b.constant(INT32_MIN), b.op(Opcode::ishl, {again, b.constant(30)})}), again};
}

TEST(Code, ComputesTheSameHashes) {
  expect_the_same_bits(
      program_of({ir::int_type, ir::int_type}, [](ir::Builder& b, ValueId, ValueId n) { return hashed(b, n); }));
}

TEST(Code, WorksOnProgramsOfConstantsAlone) {
  expect_the_same_bits(program_of({ir::float_type, ir::bool_type}, [](ir::Builder& b, ValueId, ValueId) {
    const ValueId root = b.op(Opcode::fsqrt, {b.constant(-1.0f)});
    return Values{root, b.op(Opcode::feq, {root, root})};
  }));
}

TEST(Draft, FusesPairsAndRemovesWhatNothingReads) {
  const Program program = program_of({ir::float_type}, [](ir::Builder& b, ValueId x, ValueId n) {
    b.op(Opcode::fdiv, {x, b.op(Opcode::itof, {n})});
    return Values{b.op(Opcode::fadd, {b.op(Opcode::fmul, {x, x}), b.constant(1.0f)})};
  });
  Draft draft = decode(program.module, program.entry, 1);
  simplify(draft);
  size_t fused = 0;
  for (const DraftStep& step : draft.steps) {
    fused += step.shape.kind == Kind::fused;
    EXPECT_FALSE(step.shape.kind == Kind::primitive && step.shape.op == Opcode::fdiv);
  }
  EXPECT_EQ(fused, 1u);
}

TEST(Draft, FusesTheIntegerStepsOfHashes) {
  const Program program =
      program_of({ir::int_type, ir::int_type}, [](ir::Builder& b, ValueId, ValueId n) { return hashed(b, n); });
  Draft draft = decode(program.module, program.entry, 2);
  simplify(draft);
  // Not a difference whose second operand is an exclusive or.
  EXPECT_EQ(std::ranges::count(draft.steps, Kind::fused, [](const DraftStep& step) { return step.shape.kind; }), 4);
}

TEST(Draft, ValuesShareRegistersWhenTheirLifetimesDoNotOverlap) {
  const Program program = program_of({ir::float_type}, [](ir::Builder& b, ValueId x, ValueId) {
    ValueId value = x;
    for (int i = 0; i < 100; ++i) value = b.op(Opcode::fdiv, {b.op(Opcode::fsqrt, {value}), x});
    return Values{value};
  });
  EXPECT_LE(Stages(program).code().register_count(), 3u);
}

}  // namespace
}  // namespace isoshade::interpreter
