// SPDX-License-Identifier: Apache-2.0
// How large programs may be, and what their texts are when they are large.
#include <algorithm>
#include <gtest/gtest.h>

#include "compiler/driver/driver.h"
#include "compiler/driver/target_limits.h"
#include "compiler/targets/glsl/spirv.h"

namespace isoshade::driver {
namespace {

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

class Limits : public testing::Test {
 protected:
  Limits() { options.library = &library; }

  Program compile(const std::string& text) {
    const auto program =
        compile_function(std::make_shared<support::SourceFile>("f.json", text), options, diagnostics);
    EXPECT_TRUE(program) << diagnostics.text();
    return program.value_or(Program{});
  }

  /// A function of depth `depth`: each calls the one below for x and for x + 0.5.
  std::string twice(int depth) {
    library.add("library/f0.json",
                R"({"isoshade": 1, "function": "f0", "inputs": {"x": {"type": "float"}},
                    "nodes": {"a": {"type": "multiply", "in1": "x", "in2": "x"}}, "outputs": {"out": "a"}})");
    std::string text;
    for (int i = 1; i <= depth; ++i) {
      const std::string name = "f" + std::to_string(i), below = "f" + std::to_string(i - 1);
      text = R"({"isoshade": 1, "function": ")" + name + R"(", "inputs": {"x": {"type": "float"}}, "nodes": {
        "s": {"type": "add", "in1": "x", "in2": 0.5},
        "p": {"type": ")" +
             below + R"(", "x": "x"},
        "q": {"type": ")" +
             below + R"(", "x": "s"},
        "r": {"type": "subtract", "in1": "p", "in2": "q"}}, "outputs": {"out": "r"}})";
      library.add("library/" + name + ".json", text);
    }
    return text;
  }

  bool bears(const Program& program, Target target, Division division = Division::native) {
    return within_limits(program, target, division, diagnostics);
  }

  check::Library library{"library"};
   CompileOptions options;
  support::Diagnostics diagnostics;
};

/// A sum of many terms; in the last place the name of what is summed.
std::string sum(int terms) {
  std::string nodes = R"("a0": {"type": "multiply", "in1": "x", "in2": 3})";
  for (int i = 1; i < terms; ++i) {
    const std::string number = std::to_string(i);
    nodes += ", \"m" + number + R"(": {"type": "multiply", "in1": "x", "in2": "a)" + std::to_string(i - 1) +
             R"("}, "a)" + number + R"(": {"type": "add", "in1": "m)" + number + R"(", "in2": 0.5})";
  }
  return R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}}, "nodes": {)" + nodes +
         R"(}, "outputs": {"out": "a)" + std::to_string(terms - 1) + "\"}}";
}

TEST_F(Limits, RejectsProgramsThatExpandTooFarAtTheNode) {
  const Program program = compile(twice(16));
  EXPECT_FALSE(bears(program, Target::vulkan));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  const support::Diagnostic& report = diagnostics.all()[0];
  EXPECT_EQ(report.id, support::Id::too_large);
  EXPECT_EQ(report.where.line(), 3u) << diagnostics.text();
  EXPECT_EQ(report.where.file->text().substr(report.where.begin, 3), "\"p\"");
  EXPECT_NE(report.message.find("\"f16\""), std::string::npos);
  EXPECT_NE(report.message.find(" is 24576"), std::string::npos);
  EXPECT_NE(report.fix.find("--backend cpu"), std::string::npos);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].message.find("node \"p\""), std::string::npos);
}

TEST_F(Limits, EachTargetHasItsOwnLimit) {
  EXPECT_TRUE(bears(compile(twice(12)), Target::vulkan)) << diagnostics.text();
  const Program program = compile(twice(15));
  EXPECT_FALSE(bears(program, Target::vulkan));
  EXPECT_TRUE(bears(program, Target::interpreter));
  const Program larger = compile(twice(18));
  EXPECT_FALSE(bears(larger, Target::interpreter));
  EXPECT_TRUE(bears(larger, Target::cpu));
}

TEST_F(Limits, CppTextSizeIsLimited) {
  EXPECT_TRUE(bears(compile(sum(12'000)), Target::cpu)) << diagnostics.text();
  const Program program = compile(sum(20'000));
  EXPECT_FALSE(bears(program, Target::cpu));
  EXPECT_NE(diagnostics.all().back().message.find(" is 32768"), std::string::npos) << diagnostics.text();
  EXPECT_NE(diagnostics.all().back().fix.find("--backend interpreter"), std::string::npos);
  EXPECT_TRUE(bears(program, Target::interpreter)) << diagnostics.text();
}

TEST_F(Limits, ExactDivisionsCountTheirExpansion) {
  std::string text = sum(1000);
  for (size_t at = 0; (at = text.find("multiply", at)) != std::string::npos;) text.replace(at, 8, "divide");
  const Program program = compile(text);
  EXPECT_TRUE(bears(program, Target::vulkan));
  EXPECT_FALSE(bears(program, Target::vulkan, Division::exact));
}

TEST_F(Limits, LargeProgramsBecomeShortNoinlineCppFunctions) {
  const std::string deep = cpp(compile(twice(16)));
  EXPECT_GE(count(deep, "ISOSHADE_NOINLINE static"), 3u);
  const std::string text = cpp(compile(sum(5000)));
  EXPECT_GT(count(text, "ISOSHADE_NOINLINE static"), 100u);
  size_t longest = 0;
  for (size_t at = 0; (at = text.find(" {\n", at)) != std::string::npos; ++at) {
    const size_t end = text.find("\n}\n", at);
    if (end != std::string::npos) longest = std::max(longest, count(text.substr(at, end - at), ";"));
  }
  EXPECT_LT(longest, 80u);
}

TEST_F(Limits, SmallProgramsBecomeInlinedCpp) {
  EXPECT_EQ(count(cpp(compile(twice(8))), "noinline"), 0u);
  EXPECT_EQ(count(cpp(compile(sum(500))), "noinline"), 0u);
}

// SPIR-V takes 255 parameters of a function.
TEST_F(Limits, ManyInputsArePassedInStructs) {
  std::string inputs = R"("x0": {"type": "float"})",
              nodes = R"("a0": {"type": "add", "in1": "x0", "in2": 1})";
  constexpr int many = 1000;
  for (int i = 1; i < many; ++i) {
    const std::string number = std::to_string(i);
    inputs += ", \"x" + number + R"(": {"type": "float"})";
    nodes += ", \"a" + number + R"(": {"type": "add", "in1": "a)" + std::to_string(i - 1) +
             R"(", "in2": "x)" + number + "\"}";
  }
  const Program program =
      compile(R"({"isoshade": 1, "function": "f", "inputs": {)" + inputs + R"(}, "nodes": {)" + nodes +
              R"(}, "outputs": {"out": "a)" + std::to_string(many - 1) + "\"}}");
  const std::string text = glsl(program, Division::native);
  EXPECT_EQ(count(text, "struct Inputs"), 10u);
  EXPECT_TRUE(glsl::compile_spirv(text, glsl::ShaderKind::fragment, diagnostics)) << diagnostics.text();
}

}  // namespace
}  // namespace isoshade::driver
