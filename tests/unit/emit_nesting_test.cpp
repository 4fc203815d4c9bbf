// SPDX-License-Identifier: Apache-2.0
// What is nested in emitted text, what gets a statement, and that `precise` reaches all of it.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "tests/unit/ir_text.h"
#include "tests/unit/random_module.h"

namespace isoshade::emit {
namespace {

/// The texts of the first function of a module and of all that it calls.
struct Texts {
  std::string glsl, cpp;
  explicit Texts(const ir::Module& module, uint32_t entry = 0)
      : glsl(glsl::functions(module, entry)), cpp(cpp::functions(module, entry)) {}
};

void expect_both(const Texts& texts, const std::string& in_glsl, const std::string& in_cpp) {
  EXPECT_NE(texts.glsl.find(in_glsl), std::string::npos) << texts.glsl;
  EXPECT_NE(texts.cpp.find(in_cpp), std::string::npos) << texts.cpp;
}
void expect_both(const Texts& texts, const std::string& text) { expect_both(texts, text, text); }

/// How many operations of the functions `precise` does not reach.
size_t contractible(const ir::Module& module, uint32_t entry) {
  std::string text = glsl::head();
  for (size_t i = 0; i < module.buffers.size(); ++i) {
    const std::string& name = module.buffers[i].name;
    const bool floats = module.buffers[i].element == ir::Scalar::floating;
    text += "layout(std430, set = 0, binding = " + std::to_string(i) + ") readonly buffer " + name +
            "_block { " + (floats ? "float " : "int ") + name + "[]; };\n";
  }
  text += glsl::functions(module, entry) + "\nvoid main() {}\n";
  support::Diagnostics diagnostics;
  const auto count = glsl::count_contractible(text, glsl::ShaderKind::fragment, diagnostics);
  EXPECT_TRUE(count) << diagnostics.text() << text;
  EXPECT_EQ(count.value_or(0), 0u) << text;
  return count.value_or(0);
}

TEST(Nesting, WritesBracketsOnlyWherePrecedenceNeedsThem) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: float, %b: float, %c: float) -> (out: float) {
  %1 = fadd %a, %b
  %2 = fmul %1, %c
  %3 = fmul %a, %c
  %4 = fadd %2, %3
  %5 = fsub %b, %c
  %6 = fsub %4, %5
  return %6
})")),
              "return (a + b) * c + a * c - (b - c);");
}

TEST(Nesting, BracketsWhatCompilersWarnOf) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: int, %b: int) -> (out: int) {
  %eight = constant int 8
  %mask = constant int 65280
  %1 = iadd %a, %b
  %2 = iand %1, %mask
  %3 = ior %2, %a
  %4 = isub %3, %eight
  return %4
})")),
              "return (((a + b) & 0xff00) | a) - 8;");
}

// The text of a logical shift ends in a bracket, but its second operand is no argument.
TEST(Nesting, BracketsAnOperandOfAnOperatorInsideACall) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: int, %b: int) -> (out: int) {
  %mask = constant int 31
  %1 = iand %b, %mask
  %2 = ishr %a, %1
  return %2
})")),
              "return int(uint(a) >> (b & 0x1f));", "return shift_right(a, b & 0x1f);");
}

TEST(Nesting, NamesWhatIsUsedTwiceByWhatItIs) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: float, %b: float) -> (out: float) {
  %1 = fmul %a, %b
  %2 = fadd %1, %1
  return %2
})")),
              "precise float product = a * b;\n  return product + product;",
              "const F product = a * b;\n  return product + product;");
}

TEST(Nesting, GivesEachNodeOfTheAuthorAStatement) {
  const Texts texts(ir::valid(R"(
func @f(%a: float, %b: float) -> (out: float) from "f.json" {
  %half = constant float 0x3f000000
  %sum = fadd %a, %b  ; sum:3
  %length = fmul %sum, %half  ; length:4
  return %length
})"));
  expect_both(texts, "precise float sum = a + b;\n  return sum * 0.5;  // length :4\n",
              "const F sum = a + b;\n  return sum * 0.5f;  // length :4\n");
  EXPECT_EQ(texts.glsl.find(":3"), std::string::npos) << "a comment that repeats the name\n" << texts.glsl;
}

TEST(Nesting, WritesAFunctionOfOneExpressionInOneLine) {
  expect_both(Texts(ir::valid("func @f(%a: float) -> (out: float) {\n  %1 = fadd %a, %a\n  return %1\n}")),
              "precise float f(float a) { return a + a; }\n", "ISOSHADE_INLINE F f(F a) { return a + a; }\n");
}

TEST(Nesting, NamesTheNodeWhoseIdIsTaken) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: float) -> (out: float) from "f.json" {
  %float = fadd %a, %a  ; float:3
  %out = fmul %float, %float
  return %out
})")),
              "float_ = a + a;  // float :3\n");
}

TEST(Nesting, PrintsWhatTheAuthorSaysOfANode) {
  ir::Module module = ir::valid(R"(
func @f(%a: float) -> (out: float) from "f.json" {
  %twice = fadd %a, %a  ; twice:3
  %out = fmul %twice, %twice
  return %out
})");
  for (ir::Origin& origin : module.functions[0].origins)
    if (origin.node == "twice") origin.doc = "both sides */ \n#error";
  expect_both(Texts(module), "  // both sides _/ _#error\n  precise float twice",
              "  // both sides _/ _#error\n  const F twice");
}

TEST(Nesting, WritesSplatsAsNumbersWhereAnOperatorTakesThem) {
  expect_both(Texts(ir::valid(R"(
func @f(%v: vec3, %a: float) -> (out: vec4) {
  %one = constant float 0x3f800000
  %ones = construct %one, %one, %one
  %all = construct %a, %a, %a
  %1 = fmul %v, %all
  %2 = fsub %ones, %1
  %x = extract %2, 0
  %y = extract %2, 1
  %z = extract %2, 2
  %3 = construct %x, %y, %z, %one
  return %3
})")),
              "precise vec3 difference = 1.0 - v * a;\n  return vec4(difference, 1.0);",
              "const vec3<F> difference = 1.0f - v * a;\n  return vec4<F>(difference, 1.0f);");
}

TEST(Nesting, DividesLongExpressions) {
  std::string text = "func @f(%alpha: float, %beta: float) -> (out: float) {\n  %0 = fadd %alpha, %beta\n";
  for (int i = 1; i < 60; ++i)
    text += "  %" + std::to_string(i) + " = fmul %" + std::to_string(i - 1) + ", %" +
            (i % 2 == 0 ? "alpha" : "beta") + "\n";
  const Texts texts(ir::valid(text + "  return %59\n}"));
  for (const std::string* written : {&texts.glsl, &texts.cpp}) {
    std::istringstream lines(*written);
    size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 110u) << line;
    EXPECT_LT(count, 20u) << *written;
  }
}

TEST(Nesting, KeepsAValueOutOfABlockThatMayRunOftener) {
  expect_both(Texts(ir::valid(R"(
func @f(%a: float, %count: int uniform) -> (out: float) {
  %once = fmul %a, %a
  %sum = loop %i < %count, %total = %a {
    %next = fadd %total, %once
    yield %next
  }
  return %sum
})")),
              "once = a * a;\n");
}

// The base of consecutive words may itself be a sum with a constant.
TEST(Nesting, WritesTheConstantOfAnIndexThatIsASum) {
  expect_both(Texts(ir::valid(R"(
buffer objects: float
func @f(%object: int) -> (first: vec2) {
  %1 = constant int 1
  %4 = constant int 4
  %camera = iadd %object, %4
  %next = iadd %camera, %1
  %x = load objects[%camera]
  %y = load objects[%next]
  %first = construct %x, %y
  return %first
})")),
              "int camera = object + 4;\n  return vec2(objects[camera], objects[camera + 1]);",
              "const int_of<F> camera = object + 4;\n  return vec2<F>(load(buffers.objects, camera), ");
}

TEST(Nesting, WritesTheConstantsOfNestedIndices) {
  expect_both(Texts(ir::valid(R"(
buffer objects: float
func @f(%object: int) -> (later: vec2) {
  %1 = constant int 1
  %3 = constant int 3
  %4 = constant int 4
  %camera = iadd %object, %4
  %a = iadd %camera, %3
  %b = iadd %camera, %4
  %x = load objects[%a]
  %y = load objects[%b]
  %later = construct %x, %y
  return %later
})")),
              "return objects2(object + 4 + 3);", "return objects2(buffers, object + 4 + 3);");
}

TEST(Nesting, BreaksTheLineBehindTheBracketOfACallWithALongArgument) {
  const std::string name(99, 'a');
  const std::string function = "func @" + name + "(%x: float) -> (out: float) {\n  %1 = fadd %x, %x\n  return %1\n}";
  expect_both(Texts(ir::valid("func @f(%" + name + ": float) -> (out: float) {\n  %1 = call @" + name + "(%" + name +
                              ")\n  return %1\n}\n" + function)),
              "(\n      " + name);
}

// A struct of an instance for one value holds one value, though its fields may vary elsewhere.
TEST(Nesting, PassesStructsOfOneValueToInstancesForOneValue) {
  const Texts texts(ir::valid(R"(
func @f(%a: float uniform, %b: float) -> (out: float) {
  %1 = call @g(%a)
  %2 = fadd %1, %b
  return %2
}
func @g(%inputs.x: float) -> (out: float) {
  %1 = fadd %inputs.x, %inputs.x
  return %1
})"));
  EXPECT_NE(texts.cpp.find("Inputs<float> inputs_;"), std::string::npos) << texts.cpp;
  EXPECT_NE(texts.cpp.find("g<float>(inputs_)"), std::string::npos) << texts.cpp;
}

TEST(Nesting, NamesTheWordsOfRecords) {
  ir::Module module = ir::valid(R"(
buffer objects: float
func @f(%object: int) -> (color: vec3, roughness: float, model: float) {
  %4 = constant int 4
  %5 = constant int 5
  %6 = constant int 6
  %7 = constant int 7
  %at4 = iadd %object, %4
  %at5 = iadd %object, %5
  %at6 = iadd %object, %6
  %at7 = iadd %object, %7
  %x = load objects[%at4]
  %y = load objects[%at5]
  %z = load objects[%at6]
  %color = construct %x, %y, %z
  %roughness = load objects[%at7]
  %model = load objects[%object]
  return %color, %roughness, %model
})");
  module.buffers[0].fields = {{"model", 0, 4}, {"base_color", 4, 3}, {"roughness", 7, 1}, {"unused", 8, 1}};
  const Texts texts(module);
  expect_both(texts, "const int model = 0, base_color = 4, roughness = 7;\n");
  expect_both(texts, "objects3(object + base_color)", "objects3(buffers, object + base_color)");
  expect_both(texts, "objects[object + roughness]", "load(buffers.objects, object + roughness)");
  expect_both(texts, "objects[object + model]", "load(buffers.objects, object + model)");
  EXPECT_EQ(texts.glsl.find("unused"), std::string::npos) << texts.glsl;
  EXPECT_EQ(contractible(module, 0), 0u);
}

TEST(Nesting, PreciseReachesIndicesConditionsCallsRecordsAndAssignments) {
  const ir::Module module = ir::valid(R"(
buffer table: float
func @f(%x: float, %y: float, %count: int uniform) -> (a: float, b: vec2) {
  %1 = fmul %x, %y
  %2 = ftoi %1
  %3 = load table[%2]
  %4 = fmul %x, %x
  %5 = flt %4, %y
  %6 = branch %5 {
    %7 = fmul %x, %3
    yield %7
  } else {
    %8 = fsub %x, %3
    yield %8
  }
  %9 = fadd %x, %y
  %10, %11 = call @two(%9, %6)
  %12 = fmul %10, %y
  %sum = loop %i < %count, %total = %12 {
    %13 = fmul %total, %y
    yield %13
  }
  %14 = fmul %y, %y
  %15 = call @one(%14)
  %16 = fmul %x, %11
  %17 = construct %16, %15
  return %sum, %17
}
func @two(%group.x: float, %y: float) -> (p: float, q: float) {
  %1 = fmul %group.x, %y
  %2 = fadd %group.x, %y
  return %1, %2
}
func @one(%x: float) -> (out: float) {
  %1 = fmul %x, %x
  return %1
})");
  EXPECT_EQ(contractible(module, 0), 0u);
}

TEST(Nesting, PreciseReachesEveryOperationOfRandomFunctions) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    ir::RandomModule random(seed);
    ir::RandomModule::Options options;
    options.loads = false;  // glslang takes no constant index that is out of range
    const ir::Module module = random.make(options);
    contractible(module, module.find("main"));
  }
}

}  // namespace
}  // namespace isoshade::emit
