// SPDX-License-Identifier: Apache-2.0
// The layouts that reflection states are those that compilers make: glslang of blocks, C++ compilers of structs.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <stdlib.h>

#include "backends/cpu/compiler.h"
#include "compiler/interface/layout.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "tests/unit/spirv_layout.h"

namespace isoshade::interface {
namespace {

namespace fs = std::filesystem;

using Fields = std::vector<ir::Type>;

constexpr ir::Type all_types[] = {ir::bool_type,      ir::int_type,       ir::float_type,
                                  ir::vector_type(2), ir::vector_type(3), ir::vector_type(4)};

/// Every pair of types, and longer structs made at random.
std::vector<Fields> structs(size_t random_ones) {
  std::vector<Fields> all;
  for (const ir::Type first : all_types) {
    all.push_back({first});
    for (const ir::Type second : all_types) all.push_back({first, second});
  }
  std::mt19937 random(1);
  for (size_t i = 0; i < random_ones; ++i) {
    Fields& fields = all.emplace_back(3 + random() % 40);
    for (ir::Type& type : fields) type = all_types[random() % std::size(all_types)];
  }
  return all;
}

std::string field_name(size_t number) { return "f" + std::to_string(number); }

std::string declarations(const Fields& fields, const std::string& vector_suffix) {
  std::string text;
  for (size_t i = 0; i < fields.size(); ++i)
    text += "  " + std::string(ir::name(fields[i])) + (fields[i].width > 1 ? vector_suffix : "") + " " +
            field_name(i) + ";\n";
  return text;
}

/// What glslang makes of a block with a float, an array of the struct and a float behind it.
testing::SpirvLayout compiled(const Fields& fields, Layout layout) {
  const bool is_uniform = layout == Layout::std140;
  const std::string glsl = glsl::head() + "struct S {\n" + declarations(fields, "") + "};\nlayout(" +
                           (is_uniform ? "std140" : "std430") + ", set = 0, binding = 0) " +
                           (is_uniform ? "uniform" : "readonly buffer") +
                           " Block {\n  float before;\n  S many[3];\n  float behind;\n} block;\n"
                           "layout(location = 0) out vec4 color;\n"
                           "void main() { color = vec4(block.before, block.behind, float(block.many[1].f0" +
                           (fields[0].width > 1 ? ".x" : "") + "), 0.0); }\n";
  support::Diagnostics diagnostics;
  const auto spirv = glsl::compile_spirv(glsl, glsl::ShaderKind::fragment, diagnostics);
  EXPECT_TRUE(spirv) << diagnostics.text() << glsl;
  return testing::SpirvLayout(spirv.value_or(std::vector<uint32_t>(5)));
}

TEST(Layout, IsThatOfGlslangInBlocks) {
  for (const Layout layout : {Layout::std430, Layout::std140}) {
    for (const Fields& fields : structs(60)) {
      const StructLayout expected = lay_out(fields, layout);
      const testing::SpirvLayout made = compiled(fields, layout);
      const std::string text = declarations(fields, "");
      const auto members = made.offsets_of("S");
      ASSERT_EQ(members.size(), fields.size()) << text;
      for (size_t i = 0; i < fields.size(); ++i)
        EXPECT_EQ(members.at(static_cast<uint32_t>(i)), expected.offsets[i]) << i << " of\n" << text;
      EXPECT_EQ(made.stride_of("S"), expected.whole.size) << text;
      // The struct begins at the first multiple of its alignment behind the float before it.
      const auto block = made.offsets_of("Block");
      ASSERT_EQ(block.size(), 3u) << text;
      EXPECT_EQ(block.at(1), expected.whole.alignment) << text;
      EXPECT_EQ(block.at(2), expected.whole.alignment + 3 * expected.whole.size) << text;
    }
  }
}

/// A folder with the headers of lanes, and a program whose assertions hold if C++ has the layouts.
class CppLayout : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "isoshade_layout_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    std::string lanes;
    for (const cpu::Header& header : cpu::lanes_headers()) {
      write(std::string(header.path), header.text);
      if (header.path.ends_with("/lanes.h")) lanes = header.path;
    }
    std::string text = "#include <cstddef>\n#include \"" + lanes + "\"\nusing namespace isoshade::lanes;\n";
    size_t number = 0;
    for (const Fields& fields : structs(60)) {
      const StructLayout expected = lay_out(fields, Layout::cpp);
      const std::string name = "S" + std::to_string(number++);
      const auto is = [&](const std::string& measured, uint32_t bytes) {
        text += "static_assert(" + measured + " == " + std::to_string(bytes) + ");\n";
      };
      text += "struct " + name + " {\n" + declarations(fields, "<float>") + "};\n";
      for (size_t i = 0; i < fields.size(); ++i) {
        is("offsetof(" + name + ", " + field_name(i) + ")", expected.offsets[i]);
        is("sizeof(" + name + "::" + field_name(i) + ")", extent_of(fields[i], Layout::cpp).size);
      }
      is("sizeof(" + name + ")", expected.whole.size);
      is("alignof(" + name + ")", expected.whole.alignment);
    }
    write("program.cpp", text);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, std::string_view text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  bool compiles(const std::string& compiler) {
    const std::string command = compiler + " -std=c++20 -fsyntax-only -I " + folder_.string() + " " +
                                (folder_ / "program.cpp").string();
    return std::system(command.c_str()) == 0;
  }
  static bool exists(const std::string& compiler) {
    return std::system(("command -v " + compiler + " > /dev/null").c_str()) == 0;
  }

  fs::path folder_;
};

TEST_F(CppLayout, IsThatOfCompilersForThisMachine) {
  bool found = false;
  for (const char* compiler : {"g++", "clang++"}) {
    if (!exists(compiler)) continue;
    found = true;
    EXPECT_TRUE(compiles(compiler)) << compiler;
  }
  EXPECT_TRUE(found) << "there is neither g++ nor clang++";
}

TEST_F(CppLayout, DiffersWhereAnAssertionIsWrong) {
  std::ofstream(folder_ / "program.cpp", std::ios::app) << "static_assert(sizeof(S0) == 3);\n";
  EXPECT_FALSE(compiles("c++ 2> /dev/null"));
}

TEST_F(CppLayout, IsThatOfTheCompilerForAArch64) {
  const std::string compiler = "aarch64-linux-gnu-g++";
  if (!exists(compiler)) GTEST_SKIP() << compiler << " is not installed";
  EXPECT_TRUE(compiles(compiler + " -DISOSHADE_LANES=1"));
}

}  // namespace
}  // namespace isoshade::interface
