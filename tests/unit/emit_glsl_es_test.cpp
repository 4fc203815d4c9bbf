// SPDX-License-Identifier: Apache-2.0
// The functions of a module in GLSL ES 3.00: glslang takes them, and they are the GLSL but for what GLSL ES lacks.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <unistd.h>

#include "compiler/emit/printer.h"
#include "compiler/passes/pipeline.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/targets.h"
#include "tests/unit/ir_text.h"
#include "tests/unit/random_module.h"

namespace isoshade::emit {
namespace {

/// The functions of a module in a language, with all ops that the language lacks replaced.
std::string functions_in(TargetId id, ir::Module module, uint32_t entry) {
  const Target& target = targets::get(id);
  if (!has_op(id, ir::Opcode::imulhi)) {
    passes::Entries entries{entry};
    passes::run(passes::multiplication_lowering(), module, entries, functions::Tier::standard);
    entry = entries[0];
  }
  std::vector<FunctionText> texts;
  return print_functions(module, entry, *target.language(module, entry), texts);
}

/// What glslangValidator says of a GLSL ES fragment shader around functions; empty where it accepts it.
std::string said_of(const std::string& functions) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("isoshade-es-" + std::to_string(getpid()) + ".frag")).string();
  std::ofstream(path) << "#version 300 es\n"
                      << targets::get(TargetId::glsl_es).head << "#define ISO_ZERO 0.0\n"
                      << functions << "out vec4 color;\nvoid main() { color = vec4(1.0); }\n";
  std::string said;
  FILE* pipe = popen(("glslangValidator " + path + " 2>&1").c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) said += buffer;
  const bool accepted = pclose(pipe) == 0;
  std::filesystem::remove(path);
  return accepted ? "" : said;
}

TEST(GlslEs, HasNoPreciseAndNoProductsOf64Bits) {
  const ir::Module module = ir::valid(R"(
func @f(%a: float, %i: int, %j: int) -> (x: float, high: int) {
  %1 = fmul %a, %a
  %2 = fadd %1, %a
  %3: int = imulhi %i, %j
  %4: int = umulhi %i, %j
  %5 = iadd %3, %4
  return %2, %5
})");
  const std::string glsl = functions_in(TargetId::glsl, module, 0), es = functions_in(TargetId::glsl_es, module, 0);
  EXPECT_NE(glsl.find("precise"), std::string::npos);
  EXPECT_NE(glsl.find("imulExtended"), std::string::npos);
  EXPECT_NE(glsl.find("umulExtended"), std::string::npos);
  EXPECT_EQ(es.find("precise"), std::string::npos) << es;
  EXPECT_EQ(es.find("mulExtended"), std::string::npos) << es;
  EXPECT_EQ(said_of(es), "") << es;
}

TEST(GlslEs, IsTheGlslWithoutPrecise) {
  const ir::Module module = ir::valid(R"(
func @f(%v: vec3, %a: float, %i: int) -> (out: vec3, bits: int) {
  %1 = fdiv %v, %v
  %2 = fneg %1
  %3: int = fbits %a
  %4: int = ishr %3, %i
  %5 = flt %a, %a
  %6 = select %5, %1, %2
  return %6, %4
})");
  const std::string glsl = functions_in(TargetId::glsl, module, 0);
  EXPECT_EQ(std::regex_replace(glsl, std::regex("precise "), ""), functions_in(TargetId::glsl_es, module, 0));
}

TEST(GlslEs, CompilesForRandomModules) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    ir::RandomModule::Options options;
    options.loads = false;
    const ir::Module module = ir::RandomModule(seed).make(options);
    const std::string text = functions_in(TargetId::glsl_es, module, module.find("main"));
    EXPECT_EQ(said_of(text), "") << "seed " << seed << "\n" << text;
  }
}

TEST(Targets, AreFoundByTheirNames) {
  EXPECT_EQ(targets::all().size(), target_count);
  for (const Target* target : targets::all()) {
    EXPECT_EQ(targets::find(target->name), target);
    EXPECT_EQ(&targets::get(target->id), target);
    if (target->binary != nullptr) {
      EXPECT_EQ(targets::find_binary(target->binary->name), target);
    }
    EXPECT_EQ(target->kernel == nullptr, target->kernel_extension == nullptr);
  }
  EXPECT_EQ(targets::find("spirv"), nullptr);
  EXPECT_EQ(targets::find_binary("spirv"), &targets::get(TargetId::glsl));
  EXPECT_EQ(targets::find("hlsl"), nullptr);
}

}  // namespace
}  // namespace isoshade::emit
