// SPDX-License-Identifier: Apache-2.0
// Programs made at random, rich in what drivers and compilers fold: the same bits on the scalar interpreter without
// any skip, and with all skips on the batched interpreter, on Vulkan and in C++. With ISOSHADE_FULL set there are many more; ISOSHADE_SEEDS=first,last runs those of a report again.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "compiler/driver/driver.h"
#include "compiler/ir/builder.h"
#include "compiler/ir/validator.h"
#include "compiler/lower/stages.h"
#include "compiler/targets/cpp/cpp.h"
#include "tests/conformance/cases.h"
#include "tests/unit/random_module.h"
#include "tests/equivalence/seeds.h"
#include "tests/unit/scalar_interpreter.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::equivalence {
namespace {

using ir::ValueId;

constexpr size_t rows = 2000;
constexpr size_t max_words = 32;  ///< of a program on Vulkan

/// Several random modules behind one kernel, and whose seed each result word is of.
struct RandomProgram {
  driver::Program program;
  driver::Program whole;  ///< the same without any skip
  std::vector<uint64_t> seed_of;
};

/// The functions of one random module, its names made its own; returns the index of what was `main`.
uint32_t add_random_functions(ir::Module& module, uint64_t seed, ir::RandomModule& random) {
  const size_t first = module.functions.size();
  random.add_to(module, {.library_calls = seed % 2 == 1, .loads = false, .defined = true});
  const uint32_t main = module.find("main");
  for (size_t i = first; i < module.functions.size(); ++i)
    if (module.functions[i].library.empty())
      module.functions[i].name = "m" + std::to_string(seed) + "_" + module.functions[i].name;
  return main;
}

size_t words(const ir::Function& function) {
  size_t sum = 0;
  for (const ir::Result& result : function.results) sum += result.type.width;
  return sum;
}

/// The modules of the seeds from `seed` on that have room in one program; moves `seed` behind them.
RandomProgram make_program(uint64_t& seed, uint64_t last) {
  ir::Module module = lower::frame_module();
  std::vector<std::pair<uint32_t, uint64_t>> mains;
  std::vector<ir::RandomModule> randoms;
  size_t used = 0;
  for (; seed < last; ++seed) {
    ir::Module more = module;
    ir::RandomModule random(seed);
    const uint32_t main = add_random_functions(more, seed, random);
    if (used + words(more.functions[main]) > max_words) break;
    used += words(more.functions[main]);
    module = std::move(more);
    mains.emplace_back(main, seed);
    randoms.push_back(random);
  }

  ir::Function function;
  function.name = "all";
  for (const char* name : {"a", "b", "c"}) function.parameters.push_back({name, ir::float_type, "", false});
  for (const char* name : {"i", "j"}) function.parameters.push_back({name, ir::int_type, "", false});
  RandomProgram made;
  for (const auto& [main, of] : mains)
    for (const ir::Result& result : module.functions[main].results) {
      function.results.push_back({"r" + std::to_string(function.results.size()), result.type});
      made.seed_of.insert(made.seed_of.end(), result.type.width, of);
    }
  module.functions.push_back(function);
  ir::Builder b(module, static_cast<uint32_t>(module.functions.size() - 1));
  std::vector<ValueId> results;
  for (size_t m = 0; m < mains.size(); ++m) {
    ir::RandomModule& random = randoms[m];
    const auto any_float = [&] { return b.parameter(random.below(3)); };
    std::vector<ValueId> arguments{b.constant(static_cast<int32_t>(mains[m].second % 4))};
    const std::vector<ir::Parameter> parameters = module.functions[mains[m].first].parameters;
    for (size_t k = 1; k < parameters.size(); ++k) {
      const ir::Type type = parameters[k].type;
      if (type == ir::bool_type) {
        arguments.push_back(b.op(ir::Opcode::flt, {any_float(), any_float()}));
      } else if (type == ir::int_type) {
        arguments.push_back(b.parameter(3 + random.below(2)));
      } else {
        std::vector<ValueId> components;
        for (int c = 0; c < type.width; ++c) components.push_back(any_float());
        arguments.push_back(b.construct(components));
      }
    }
    for (ValueId result : b.call(mains[m].first, arguments)) results.push_back(result);
  }
  b.finish(results);
  EXPECT_EQ(ir::validate(module), "");
  const auto kernel = static_cast<uint32_t>(module.functions.size() - 1);
  made.whole = driver::finish_eval(module, kernel, "random", functions::Tier::standard, interface::Skips::none());
  made.program = driver::finish_eval(std::move(module), kernel, "random");
  return made;
}

/// Every so many rows of the conformance suite's inputs.
const std::vector<int32_t>& table() {
  static const std::vector<int32_t> chosen = [] {
    constexpr size_t all_rows = 100'000, words = conformance::input_words;
    const std::vector<int32_t> all = conformance::inputs(all_rows);
    std::vector<int32_t> some;
    for (size_t row = 0; row < rows; ++row) {
      const auto begin = all.begin() + static_cast<ptrdiff_t>(row * (all_rows / rows) * words);
      some.insert(some.end(), begin, begin + words);
    }
    return some;
  }();
  return chosen;
}

std::vector<int32_t> evaluate(backends::Backend& backend, const driver::Program& program) {
  support::Diagnostics diagnostics;
  std::vector<int32_t> results;
  EXPECT_TRUE(backend.evaluate(program, table(), rows, results, diagnostics)) << diagnostics.text();
  return results;
}

/// `make_backend` makes a backend, whose programs stay with it: it is made anew now and then.
template <class MakeBackend>
void expect_same_bits(Seeds seeds, MakeBackend make_backend) {
  constexpr int programs_per_backend = 200;
  const auto scalar = interpreter::create_scalar();
  std::unique_ptr<backends::Backend> owner;
  int number = 0;
  for (uint64_t seed = seeds.first; seed < seeds.last;) {
    if (number++ % programs_per_backend == 0) {
      owner.reset();
      support::Diagnostics diagnostics;
      owner = make_backend(diagnostics);
      ASSERT_NE(owner, nullptr) << diagnostics.text();
    }
    backends::Backend& backend = *owner;
    const RandomProgram made = make_program(seed, seeds.last);
    const std::vector<int32_t> expected = evaluate(*scalar, made.whole);
    const std::vector<int32_t> results = evaluate(backend, made.program);
    ASSERT_EQ(results.size(), expected.size());
    uint64_t reported = ~uint64_t{0};
    for (size_t i = 0; i < results.size(); ++i) {
      const uint64_t of = made.seed_of[i % made.seed_of.size()];
      if (results[i] == expected[i] || of == reported) continue;
      reported = of;
      const int32_t* in = table().data() + i / made.seed_of.size() * conformance::input_words;
      ADD_FAILURE() << backend.description() << ", seed " << of << ", word " << i % made.seed_of.size()
                    << " for " << std::hex << in[0] << " " << in[1] << " " << in[2] << " " << in[3] << " "
                    << in[4] << ": " << results[i] << ", expected " << expected[i];
    }
  }
}

#ifdef ISOSHADE_VULKAN
void expect_same_bits_on_vulkan(Seeds seeds, driver::Division division, vulkan::EvalStage stage) {
  expect_same_bits(seeds, [&](support::Diagnostics& diagnostics) {
    vulkan::VulkanOptions options;
    options.division = division;
    options.eval_stage = stage;
    return vulkan::create(options, diagnostics);
  });
}

TEST(RandomPrograms, AreIdenticalOnVulkan) {
  expect_same_bits_on_vulkan(seeds(300, 20'000), driver::Division::native, vulkan::EvalStage::fragment);
}

TEST(RandomPrograms, AreIdenticalOnVulkanWithExactDivision) {
  expect_same_bits_on_vulkan(seeds(60, 2'000), driver::Division::exact, vulkan::EvalStage::fragment);
}

TEST(RandomPrograms, AreIdenticalInVertexShaders) {
  expect_same_bits_on_vulkan(seeds(100, 2'000), driver::Division::native, vulkan::EvalStage::vertex);
}
#endif

/// More operations than cpp::large_program, of which late ones read early ones: a loop and a branch among them.
driver::Program large_program() {
  ir::RandomModule random(1);
  ir::Module module = lower::frame_module();
  ir::Function function;
  function.name = "large";
  for (const char* name : {"a", "b", "c"}) function.parameters.push_back({name, ir::float_type, "", false});
  for (const char* name : {"i", "j"}) function.parameters.push_back({name, ir::int_type, "", false});
  function.results = {{"sum", ir::float_type}, {"last", ir::vector_type(3)}};
  module.functions.push_back(function);
  ir::Builder b(module, 0);
  std::vector<ValueId> made{b.parameter(0), b.parameter(1), b.parameter(2)};
  const auto any = [&] { return made[random.below(static_cast<uint32_t>(made.size()))]; };
  constexpr std::array operations{ir::Opcode::fadd, ir::Opcode::fsub, ir::Opcode::fmul};
  const auto operate = [&](ValueId x, ValueId y) { return b.op(operations[random.below(3)], {x, y}); };
  ValueId count = b.constant(1);
  while (made.size() < cpp::large_program / 2 + 300) {
    made.push_back(operate(any(), made[made.size() - 1 - random.below(3)]));
    if (made.size() % 1000 == 0) count = b.op(ir::Opcode::iadd, {count, b.constant(1)});
    if (made.size() % 1000 == 500)
      made.push_back(b.branch(b.op(ir::Opcode::flt, {any(), any()}), [&] { return std::vector{operate(any(), any())}; },
                              [&] { return std::vector{operate(any(), any())}; })[0]);
    if (made.size() % 2000 == 600)
      made.push_back(b.loop(count, std::array{any()}, [&](ValueId, std::span<const ValueId> carried) {
        return std::vector{operate(carried[0], any())};
      })[0]);
  }
  ValueId sum = made[0];
  for (const ValueId value : made) sum = b.op(ir::Opcode::fadd, {sum, value});
  b.finish(std::array{sum, b.construct(std::array{made[made.size() - 1], made[made.size() - 2], any()})});
  EXPECT_EQ(ir::validate(module), "");
  return driver::finish_eval(std::move(module), 0, "large");
}

// They are cut into parts that call each other.
TEST(RandomPrograms, LargeProgramsAreIdenticalInCpp) {
  const driver::Program program = large_program();
  EXPECT_NE(driver::cpp(program).find("large_part_1"), std::string::npos);
  support::Diagnostics diagnostics;
  const auto cpu = cpu::create({}, diagnostics);
  ASSERT_NE(cpu, nullptr) << diagnostics.text();
  const std::vector<int32_t> expected = evaluate(*interpreter::create_scalar(), program);
  EXPECT_EQ(evaluate(*cpu, program), expected);
  EXPECT_EQ(evaluate(*interpreter::create(), program), expected);
}

class InterpreterLanes : public testing::TestWithParam<int> {};

TEST_P(InterpreterLanes, RunRandomProgramsIdentically) {
  if (GetParam() > interpreter::Code::widest_lanes()) GTEST_SKIP() << "this machine has no such registers";
  expect_same_bits(seeds(400, 20'000), [](support::Diagnostics&) { return interpreter::create(1, GetParam()); });
}

INSTANTIATE_TEST_SUITE_P(RandomPrograms, InterpreterLanes, testing::Values(4, 8, 16),
                         [](const auto& info) { return std::to_string(info.param); });

TEST(RandomPrograms, AreIdenticalInCpp) {
  expect_same_bits(seeds(12, 1'000),
                   [](support::Diagnostics& diagnostics) { return cpu::create({}, diagnostics); });
}

}  // namespace
}  // namespace isoshade::equivalence
