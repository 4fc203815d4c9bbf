// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <thread>

#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/glsl/stages.h"
#include "tests/unit/ir_text.h"

namespace isoshade::emit {
namespace {

std::string fragment(const std::string& statements) {
  return glsl::head() +
         "layout(std430, set = 0, binding = 0) readonly buffer inputs_block { float inputs[]; };\n"
         "layout(location = 0) out vec4 color;\n"
         "void main() {\n  float a = inputs[0];\n  float b = inputs[1];\n" +
         statements + "}\n";
}

std::vector<uint32_t> compile(const std::string& glsl, glsl::ShaderKind kind = glsl::ShaderKind::fragment) {
  support::Diagnostics diagnostics;
  const auto spirv = glsl::compile_spirv(glsl, kind, diagnostics);
  EXPECT_TRUE(spirv) << diagnostics.text();
  return spirv.value_or(std::vector<uint32_t>{});
}

/// The result ids of the instructions of an opcode, and the ids that are decorated NoContraction.
struct Operations {
  std::set<uint32_t> results, exact;

  Operations(const std::vector<uint32_t>& spirv, uint32_t opcode) {
    constexpr uint32_t op_decorate = 71, no_contraction = 42;
    for (size_t i = 5; i < spirv.size(); i += spirv[i] >> 16) {
      const uint32_t op = spirv[i] & 0xffff;
      if (op == opcode) results.insert(spirv[i + 2]);
      if (op == op_decorate && spirv[i + 2] == no_contraction) exact.insert(spirv[i + 1]);
    }
  }
  bool all_exact() const { return std::includes(exact.begin(), exact.end(), results.begin(), results.end()); }
};

TEST(CompileSpirv, TargetsVersion13) {
  const std::vector<uint32_t> spirv = compile(fragment("  color = vec4(a);\n"));
  ASSERT_GT(spirv.size(), 5u);
  EXPECT_EQ(spirv[0], 0x07230203u);
  EXPECT_EQ(spirv[1], 0x00010300u);
}

TEST(CompileSpirv, MarksPreciseOperationsNoContraction) {
  constexpr uint32_t op_fadd = 129, op_fmul = 133;
  const std::string body =
      "  precise float product = a * b;\n  precise float unused = a + a;\n"
      "  precise float sum = product + a;\n  color = vec4(sum);\n";
  const std::vector<uint32_t> spirv = compile(fragment(body));
  EXPECT_EQ(Operations(spirv, op_fmul).results.size(), 1u);
  EXPECT_EQ(Operations(spirv, op_fadd).results.size(), 2u) << "nothing is optimised away";
  EXPECT_TRUE(Operations(spirv, op_fmul).all_exact());
  EXPECT_TRUE(Operations(spirv, op_fadd).all_exact());
}

TEST(CompileSpirv, MarksAllOperationsNoContractionWithoutPrecise) {
  constexpr uint32_t op_fadd = 129, op_fsub = 131, op_fmul = 133, op_fdiv = 136;
  const std::vector<uint32_t> spirv = compile(fragment(
      "  vec2 v = vec2(a, b) * b;\n  color = vec4(a * b + a, a - b, a / b, v.x * v.y);\n  color += color;\n"));
  for (const uint32_t opcode : {op_fadd, op_fsub, op_fmul, op_fdiv}) {
    EXPECT_FALSE(Operations(spirv, opcode).results.empty()) << opcode;
    EXPECT_TRUE(Operations(spirv, opcode).all_exact()) << opcode;
  }
}

TEST(CompileSpirv, LetsDriversContractWhatPromisesNothing) {
  constexpr uint32_t op_fadd = 129, op_fmul = 133;
  const std::string text = fragment("  precise float sum = a * b + a;\n  color = vec4(sum);\n");
  support::Diagnostics diagnostics;
  for (const auto contract : {glsl::Contract::outside, glsl::Contract::free}) {
    const auto spirv = glsl::compile_spirv(text, glsl::ShaderKind::fragment, diagnostics, "a shader", contract);
    ASSERT_TRUE(spirv) << diagnostics.text();
    const Operations sums(*spirv, op_fadd), products(*spirv, op_fmul);
    EXPECT_EQ(sums.results.size() + products.results.size(), 2u);
    EXPECT_EQ(sums.exact.size(), contract == glsl::Contract::free ? 0u : 2u);
  }
}

// 2^200 paths lead from the last result back to the first: what follows each of them never ends.
TEST(CompileSpirv, CompilesLongChainsOfMultiResultFunctions) {
  std::string text =
      "func @two(%a: float, %b: float) -> (sum: float, difference: float) {\n"
      "  %s = fadd %a, %b\n  %d = fsub %a, %b\n  return %s, %d\n}\n"
      "func @eval(%row: int) -> (out: float) {\n  %a0 = itof %row\n  %b0 = fmul %a0, %a0\n";
  constexpr int depth = 200;
  for (int i = 0; i < depth; ++i) {
    const std::string from = std::to_string(i), to = std::to_string(i + 1);
    text.append("  %a" + to + ", %b" + to + " = call @two(%a" + from + ", %b" + from + ")\n");
  }
  const std::string last = std::to_string(depth);
  const ir::Module module =
      ir::valid(text + "  %out = fadd %a" + last + ", %b" + last + "\n  return %out\n}");
  constexpr uint32_t op_fadd = 129, op_function_call = 57;
  const std::vector<uint32_t> spirv =
      compile(glsl::stage(module, module.find("eval"), lower::Stage::eval, {"", "test"}));
  EXPECT_GE(Operations(spirv, op_function_call).results.size(), size_t{depth});
  EXPECT_EQ(Operations(spirv, op_fadd).results.size(), 2u);
  EXPECT_TRUE(Operations(spirv, op_fadd).all_exact());
}

TEST(CompileSpirv, ReportsTheFirstCompileError) {
  support::Diagnostics diagnostics;
  const std::string text = fragment("  color = vec4(roughnes);\n  color = 1;\n");
  EXPECT_FALSE(glsl::compile_spirv(text, glsl::ShaderKind::fragment, diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, support::Id::bad_shader);
  EXPECT_NE(diagnostics.text().find("roughnes"), std::string::npos) << diagnostics.text();
}

TEST(CompileSpirv, ErrorsNameTheProgram) {
  support::Diagnostics diagnostics;
  EXPECT_FALSE(glsl::compile_spirv(fragment("  color = length;\n"), glsl::ShaderKind::fragment, diagnostics,
                             "the pixel stage of \"fur\" (fur.json)"));
  EXPECT_NE(diagnostics.text().find("the pixel stage of \"fur\" (fur.json) does not compile"),
            std::string::npos)
      << diagnostics.text();
}

TEST(CompileSpirv, ReportsShadersOfTheWrongKind) {
  support::Diagnostics diagnostics;
  EXPECT_FALSE(glsl::compile_spirv(fragment("  gl_FragDepth = a;\n"), glsl::ShaderKind::vertex, diagnostics));
  EXPECT_TRUE(diagnostics.has_errors());
}

TEST(CompileSpirvDeathTest, AbortsWithoutSignedZeroInfNanPreserve) {
  support::Diagnostics diagnostics;
  EXPECT_DEATH(glsl::compile_spirv("#version 450\nvoid main() {}\n", glsl::ShaderKind::vertex, diagnostics),
               "SignedZeroInfNanPreserve");
}

TEST(CompileSpirv, IsDeterministicAcrossThreads) {
  const std::string text =
      fragment("  precise float s = a < b ? a : b;\n  color = vec4(s, sqrt(a), a / b, floor(b));\n");
  const std::vector<uint32_t> expected = compile(text);
  std::vector<std::vector<uint32_t>> made(4);
  std::vector<std::thread> threads;
  for (auto& words : made)
    threads.emplace_back([&words, &text] {
      for (int i = 0; i < 8; ++i) words = compile(text);
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& words : made) EXPECT_EQ(words, expected);
}

}  // namespace
}  // namespace isoshade::emit
