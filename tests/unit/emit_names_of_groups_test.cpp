// SPDX-License-Identifier: Apache-2.0
// Parameter groups, and functions that would take a name of the language's own.
#include <gtest/gtest.h>

#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/glsl/stages.h"
#include "tests/unit/ir_text.h"

namespace isoshade::emit {
namespace {

/// The eval shader of a module, which must compile.
std::string shader(const ir::Module& module) {
  const std::string text = glsl::stage(module, module.find("eval"), lower::Stage::eval, {"", "test"});
  support::Diagnostics diagnostics;
  EXPECT_TRUE(glsl::compile_spirv(text, glsl::ShaderKind::fragment, diagnostics)) << diagnostics.text() << text;
  return text;
}

// Once an argument was constructed in the call, glslang crashed here.
TEST(Groups, MayHaveFewerFieldsThanTheResult) {
  shader(ir::valid(R"(
func @two(%group.x: float) -> (a: float, b: float) {
  %a = fadd %group.x, %group.x
  %b = fmul %group.x, %group.x
  return %a, %b
}
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %a, %b = call @two(%x)
  %out = fadd %b, %b
  return %out
})"));
}

TEST(Groups, ShareAStructIfNameAndFieldsMatch) {
  const std::string text = shader(ir::valid(R"(
func @first(%group.x: float) -> (out: float) {
  return %group.x
}
func @second(%group.x: float) -> (out: float) {
  return %group.x
}
func @third(%group.x: float, %group.y: float) -> (out: float) {
  %out = fadd %group.x, %group.y
  return %out
}
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %a = call @first(%x)
  %b = call @second(%a)
  %out = call @third(%a, %b)
  return %out
})"));
  EXPECT_NE(text.find("float first(Group group)"), std::string::npos) << text;
  EXPECT_NE(text.find("float second(Group group)"), std::string::npos) << text;
  EXPECT_NE(text.find("float third(Group_1 group)"), std::string::npos) << text;
}

TEST(Names, FunctionNamedMainDoesNotClashWithTheShaderMain) {
  const ir::Module module = ir::valid(R"(
func @main(%x: float) -> (out: float) {
  %out = fadd %x, %x
  return %out
}
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %out = call @main(%x)
  return %out
})");
  EXPECT_NE(shader(module).find("float main_(float x)"), std::string::npos);
  EXPECT_NE(cpp::functions(module, module.find("eval")).find("F main_(F x)"), std::string::npos);
}

TEST(HiddenZero, IsDefinedOnlyWhereUsed) {
  const ir::Module with =
      ir::valid("func @eval(%row: int) -> (out: float) {\n  %out = hidden_zero\n  return %out\n}");
  const ir::Module without =
      ir::valid("func @eval(%row: int) -> (out: float) {\n  %out = itof %row\n  return %out\n}");
  EXPECT_NE(shader(with).find("#define ISO_ZERO iso_zero"), std::string::npos);
  EXPECT_NE(cpp::functions(with, 0).find("constexpr float ISO_ZERO"), std::string::npos);
  EXPECT_EQ(shader(without).find("ISO_ZERO"), std::string::npos);
  EXPECT_EQ(cpp::functions(without, 0).find("ISO_ZERO"), std::string::npos);
}

}  // namespace
}  // namespace isoshade::emit
