// SPDX-License-Identifier: Apache-2.0
// The interpreter and compiled C++ run the same IR through the same steps by different means.
#include <array>
#include <bit>
#include <gtest/gtest.h>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"
#include "tests/unit/backend_frame.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::interpreter {
namespace {

using backends::Backend;
using backends::Image;
using backends::same_bits;
using backends::TestFrame;
using driver::Program;
using driver::Stage;
using ir::Opcode;
using lower::FrameBuffer;
using support::Diagnostics;

uint32_t new_function(ir::Module& module, const char* name, std::vector<ir::Parameter> parameters,
                      std::vector<ir::Result> results) {
  ir::Function function;
  function.name = name;
  function.parameters = std::move(parameters);
  function.results = std::move(results);
  module.functions.push_back(std::move(function));
  return static_cast<uint32_t>(module.functions.size() - 1);
}

Program vertex_program() {
  Program program;
  program.stage = Stage::vertex;
  program.module = lower::frame_module();
  program.entry = lower::add_vertex_kernel(program.module);
  return program;
}

/// The colour is (depth, x times a parameter, the square root of y - 20, lights / depth).
Program pixel_program() {
  Program program;
  program.stage = Stage::pixel;
  program.module = lower::frame_module();
  const uint32_t depth_kernel = lower::add_depth_kernel(program.module);
  program.entry = new_function(program.module, "pixel",
                               {{"x", ir::int_type, "", false},
                                {"y", ir::int_type, "", false},
                                {"triangle", ir::int_type, "", false},
                                {"object", ir::int_type, "", true},
                                {"light_count", ir::int_type, "", true}},
                               {{"color", ir::vector_type(4)}});
  ir::Builder b(program.module, program.entry);
  const std::array pixel = {b.parameter(0), b.parameter(1), b.parameter(2)};
  const ir::ValueId depth = b.call(depth_kernel, pixel).front();
  const ir::ValueId at =
      b.op(Opcode::iadd, {b.parameter(3), b.constant(int32_t{lower::object_word::parameters})});
  const ir::ValueId parameter = b.load(static_cast<uint32_t>(FrameBuffer::objects), at);
  const ir::ValueId scaled = b.op(Opcode::fmul, {b.op(Opcode::itof, {b.parameter(0)}), parameter});
  const ir::ValueId below = b.op(Opcode::fsub, {b.op(Opcode::itof, {b.parameter(1)}), b.constant(20.0f)});
  const ir::ValueId lights = b.op(Opcode::fdiv, {b.op(Opcode::itof, {b.parameter(4)}), depth});
  b.finish(std::array{b.construct(std::array{depth, scaled, b.op(Opcode::fsqrt, {below}), lights})});
  return program;
}

/// Two floats: their product and whether the first is less.
Program eval_program() {
  Program program;
  program.stage = Stage::eval;
  program.module = lower::frame_module();
  const uint32_t function = new_function(program.module, "compare",
                                         {{"a", ir::float_type, "", false}, {"b", ir::float_type, "", false}},
                                         {{"product", ir::float_type}, {"less", ir::bool_type}});
  ir::Builder b(program.module, function);
  b.finish(std::array{b.op(Opcode::fmul, {b.parameter(0), b.parameter(1)}),
                      b.op(Opcode::flt, {b.parameter(0), b.parameter(1)})});
  program.entry = lower::add_eval_kernel(program.module, function);
  program.inputs = {{"a", "float", 1, {}, {}, {}}, {"b", "float", 1, {}, {}, {}}};
  program.results = {{"product", "float", 1, {}, {}, {}}, {"less", "boolean", 1, {}, {}, {}}};
  return program;
}

class InterpreterAndCpu : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!cpu::lane_count(GetParam())->available()) GTEST_SKIP() << "this machine has no such registers";
    static const cpu::TestFolder cache;
    cpu::CpuOptions options;
    options.lanes = GetParam();
    options.cache = cache.path();
    Diagnostics diagnostics;
    compiled = cpu::create(options, diagnostics);
    ASSERT_TRUE(compiled) << diagnostics.text();
  }

  std::unique_ptr<Backend> compiled;
  std::unique_ptr<Backend> interpreted = create();
};

TEST_P(InterpreterAndCpu, DrawIdenticalImages) {
  const Program vertex = vertex_program(), pixel = pixel_program();
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{130, 70}}) {
    TestFrame test(width, height, 50);
    test.frame.programs = {&vertex, &pixel};
    const Image a = render(*interpreted, test), b = render(*compiled, test);
    EXPECT_TRUE(same_bits(a.rgba, b.rgba));
    EXPECT_TRUE(same_bits(a.depth, b.depth));
  }
}

TEST_P(InterpreterAndCpu, TransformToIdenticalPositions) {
  const Program vertex = vertex_program();
  TestFrame test(64, 64, 20);
  test.frame.programs = {&vertex};
  Diagnostics diagnostics;
  support::Array<float> a, b;
  ASSERT_TRUE(interpreted->transform(test.pass(), a, diagnostics)) << diagnostics.text();
  ASSERT_TRUE(compiled->transform(test.pass(), b, diagnostics)) << diagnostics.text();
  EXPECT_TRUE(same_bits(a, b));
}

TEST_P(InterpreterAndCpu, EvaluateIdenticalTables) {
  std::vector<int32_t> inputs;
  const float special[] = {0.0f, -0.0f, 1.0f, -3.5f, 1e-20f, 1e30f, __builtin_inff(), __builtin_nanf("")};
  for (const float x : special)
    for (const float y : special)
      inputs.insert(inputs.end(), {std::bit_cast<int32_t>(x), std::bit_cast<int32_t>(y)});
  const Program program = eval_program();
  Diagnostics diagnostics;
  std::vector<int32_t> a, b;
  ASSERT_TRUE(interpreted->evaluate(program, inputs, inputs.size() / 2, a, diagnostics))
      << diagnostics.text();
  ASSERT_TRUE(compiled->evaluate(program, inputs, inputs.size() / 2, b, diagnostics)) << diagnostics.text();
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.size(), inputs.size());
}

INSTANTIATE_TEST_SUITE_P(LaneCounts, InterpreterAndCpu, testing::Values("1", "4", "8", "16", "8x2", "16x2"),
                         [](const auto& info) { return std::string(info.param); });

TEST(InterpreterBackend, PixelProgramReadsTheStoredDepth) {
  const Program vertex = vertex_program(), pixel = pixel_program();
  TestFrame test(130, 70, 50);
  test.frame.programs = {&vertex, &pixel};
  const Image image = render(*create(), test);
  int visible = 0, without_root = 0;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const float* color = image.rgba.data() + 4 * i;
    if (image.depth[i] == 0) {
      EXPECT_EQ(std::memcmp(color, test.view().background, 16), 0);
      continue;
    }
    ++visible;
    EXPECT_EQ(std::bit_cast<uint32_t>(color[0]), std::bit_cast<uint32_t>(image.depth[i]));
    const bool is_nan = std::bit_cast<uint32_t>(color[2]) == 0x7fc00000u;
    EXPECT_EQ(is_nan, i / 130 < 20);
    without_root += is_nan;
  }
  EXPECT_GT(visible, 1000);
  EXPECT_GT(without_root, 10);
}

}  // namespace
}  // namespace isoshade::interpreter
