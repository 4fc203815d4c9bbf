// SPDX-License-Identifier: Apache-2.0
// A reflection is enough to bind a shader: programs around shipped documents, written from the JSON alone, compile, and
// their compilers lay out the structs as it says.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdlib.h>

#include "backends/cpu/compiler.h"
#include "compiler/driver/shader.h"
#include "compiler/reflect/reflect.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/targets.h"
#include "tests/unit/spirv_layout.h"

namespace isoshade::reflect {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const std::string graphs = ISOSHADE_GRAPHS;

struct Compiled {
  ordered_json reflection;
  std::string glsl, cpp;
};

Compiled compile(const std::string& document, const driver::ShaderOptions& shader_options = {}) {
  support::Diagnostics diagnostics;
  check::Library library(graphs + "/library");
  driver::CompileOptions options;
  options.library = &library;
  const support::Source source = graph::read_source(graphs + "/" + document, diagnostics);
  const auto shader = driver::compile_shader(source, options, shader_options, diagnostics);
  EXPECT_TRUE(shader) << diagnostics.text();
  if (!shader) return {};
  const auto reflection = reflect(*shader, {.files = library.files()}, diagnostics);
  EXPECT_TRUE(reflection) << diagnostics.text();
  return {ordered_json::parse(json(*reflection)), driver::text(*shader, *targets::find("glsl")),
          driver::text(*shader, *targets::find("cpp"))};
}

std::string text(const ordered_json& json) { return json.get<std::string>(); }

const ordered_json* struct_named(const ordered_json& reflection, const ordered_json& glsl_name) {
  for (const ordered_json& declared : reflection["structs"])
    if (declared["glsl"] == glsl_name) return &declared;
  return nullptr;
}

/// A shader that calls every function, with structs from blocks of a layout.
std::string fragment_shader(const Compiled& compiled, const std::string& layout) {
  const ordered_json& reflection = compiled.reflection;
  std::string out = glsl::head() + compiled.glsl;
  for (const ordered_json& function : reflection["host"]) {
    const std::string returns = text(function["returns"]);
    const std::string value = returns == "Light"       ? "isoshade_Light(vec3(0.0), vec3(0.0))"
                              : returns == "ImageSize" ? "isoshade_ImageSize(1, 1, 0)"
                                                       : returns + "(0)";
    out += (value.starts_with("isoshade_") ? "isoshade_" : "") + returns + " isoshade_" +
           text(function["name"]) + "(" + text(function["parameters"]) + ") { return " + value + "; }\n";
  }
  std::string before, calls;
  int binding = 0;
  for (const ordered_json& declared : reflection["structs"]) {
    if (declared["role"] == "results") continue;
    const std::string number = std::to_string(binding++), name = text(declared["glsl"]);
    out += "layout(" + layout + ", set = 0, binding = " + number + ") " +
           (layout == "std140" ? "uniform" : "readonly buffer") + " Block" + number + " { " + name +
           " many[2]; } block" + number + ";\n";
    before += "  " + name + " a_" + name + " = block" + number + ".many[1];\n";
  }
  int result = 0;
  for (const ordered_json& function : reflection["functions"]) {
    std::string arguments;
    for (const ordered_json& argument : function["arguments"]) {
      const bool is_struct = struct_named(reflection, argument["type"]) != nullptr;
      arguments += (arguments.empty() ? "" : ", ") +
                   (is_struct ? "a_" + text(argument["type"]) : text(argument["type"]) + "(1)");
    }
    calls += "  " + text(function["returns"]) + " r" + std::to_string(result++) + " = " +
             text(function["glsl"]) + "(" + arguments + ");\n";
  }
  return out + "layout(location = 0) out vec4 color;\nvoid main() {\n" + before + calls +
         "  color = vec4(1.0);\n}\n";
}

/// The same in C++, with an assertion for each statement on the layout.
std::string cpp_program(const Compiled& compiled) {
  const ordered_json& reflection = compiled.reflection;
  std::string out =
      "#include \"shader.h\"\n#include <cstddef>\nusing namespace isoshade::lanes;\n\nstruct Host {\n";
  const auto type_of = [&](const ordered_json& glsl, bool uniform) -> std::string {
    if (const ordered_json* declared = struct_named(reflection, glsl))
      return text((*declared)["cpp"]) + ((*declared)["role"] == "parameters" ? "" : "<float>");
    const std::string name = text(glsl);
    if (name == "Light") return "isoshade::Light<float>";
    if (name == "ImageSize") return "isoshade::ImageSize<int>";
    return name.starts_with("vec") || uniform ? name + (name.starts_with("vec") ? "<float>" : "") : name;
  };
  for (const ordered_json& function : reflection["host"])
    out += "  template <class... A> " + type_of(function["returns"], false) + " " + text(function["name"]) +
           "(A...) const { return {}; }\n";
  out += "};\n\n";
  const auto is = [&](const std::string& measured, const ordered_json& bytes) {
    out += "static_assert(" + measured + " == " + bytes.dump() + ");\n";
  };
  for (const ordered_json& declared : reflection["structs"]) {
    const std::string type = type_of(declared["glsl"], true);
    is("sizeof(" + type + ")", declared["bytes"]["cpp"]["size"]);
    is("alignof(" + type + ")", declared["bytes"]["cpp"]["alignment"]);
    for (const ordered_json& field : declared["fields"]) {
      is("offsetof(" + type + ", " + text(field["name"]) + ")", field["bytes"]["cpp"]["offset"]);
      is("sizeof(" + type + "::" + text(field["name"]) + ")", field["bytes"]["cpp"]["size"]);
      out += "static_assert(__is_same(decltype(" + type + "::" + text(field["name"]) + "), " +
             type_of(field["type"], true) + "));\n";
    }
  }
  int result = 0;
  out += "\nvoid program([[maybe_unused]] const Host& host) {\n";
  for (const ordered_json& function : reflection["functions"]) {
    std::string arguments = "host";
    for (const ordered_json& argument : function["arguments"])
      arguments += ", " + type_of(argument["type"], true) + "{}";
    if (function["role"] == "function") arguments = arguments.size() > 6 ? arguments.substr(6) : "";
    const std::string name = "r" + std::to_string(result++);
    out += "  " + type_of(function["returns"], true) + " " + name + " = " + text(function["cpp"]) +
           (function["role"] == "function" ? "<float>" : "") + "(" + arguments + ");\n  (void)" + name +
           ";\n";
  }
  return out + "}\n";
}

std::vector<std::string> shipped_documents() {
  std::vector<std::string> documents;
  for (const char* folder : {"materials", "effects", "effects/bloom", "library/brdf", "library/fog",
                             "library/material"})
    if (fs::exists(graphs + "/" + folder))
      for (const auto& entry : fs::directory_iterator(graphs + "/" + folder))
        if (entry.path().extension() == ".json")
          documents.push_back(std::string(folder) + "/" + entry.path().filename().string());
  std::ranges::sort(documents);
  return documents;
}

TEST(Binding, FragmentShadersWrittenFromReflectionsCompileWithTheirLayouts) {
  const std::vector<std::string> documents = shipped_documents();
  ASSERT_GT(documents.size(), 20u);
  for (const std::string& document : documents) {
    SCOPED_TRACE(document);
    const Compiled compiled = compile(document);
    for (const std::string layout : {"std430", "std140"}) {
      const std::string glsl = fragment_shader(compiled, layout);
      support::Diagnostics diagnostics;
      const auto spirv = glsl::compile_spirv(glsl, glsl::ShaderKind::fragment, diagnostics);
      ASSERT_TRUE(spirv) << diagnostics.text() << glsl;
      const testing::SpirvLayout made(*spirv);
      for (const ordered_json& declared : compiled.reflection["structs"]) {
        if (declared["role"] == "results") continue;
        const auto& offsets = made.offsets_of(text(declared["glsl"]));
        ASSERT_EQ(offsets.size(), declared["fields"].size()) << declared["glsl"];
        for (size_t i = 0; i < offsets.size(); ++i)
          EXPECT_EQ(offsets.at(static_cast<uint32_t>(i)), declared["fields"][i]["bytes"][layout]["offset"])
              << declared["fields"][i];
        EXPECT_EQ(made.stride_of(text(declared["glsl"])), declared["bytes"][layout]["size"])
            << declared["glsl"];
      }
    }
  }
}

TEST(Binding, CppProgramsWrittenFromReflectionsCompileWithTheirLayouts) {
  std::string pattern = (fs::temp_directory_path() / "isoshade_binding_XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  const auto write = [&](const std::string& name, std::string_view text) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
  };
  for (const cpu::Header& header : cpu::lanes_headers()) write(std::string(header.path), header.text);
  for (const char* document :
       {"materials/textured.json", "materials/moved_vertices.json", "effects/bloom/blur.json",
        "effects/height_fog.json", "library/brdf/ggx_d.json"}) {
    const Compiled compiled = compile(document);
    const std::string program = cpp_program(compiled);
    write("shader.h", compiled.cpp);
    write("program.cpp", program);
    const std::string command =
        "c++ -std=c++20 -Wall -Wextra -Werror -Wno-invalid-offsetof -fsyntax-only -I " + folder.string() +
        " " + (folder / "program.cpp").string();
    EXPECT_EQ(std::system(command.c_str()), 0) << document << "\n" << program;
  }
  fs::remove_all(folder);
}

TEST(Binding, PrefixIsThatOfEveryName) {
  const Compiled compiled = compile("materials/textured.json", {.prefix = "mine"});
  EXPECT_EQ(compiled.reflection["prefix"], "mine");
  for (const ordered_json& declared : compiled.reflection["structs"]) {
    EXPECT_TRUE(text(declared["glsl"]).starts_with("mine_"));
    EXPECT_TRUE(text(declared["cpp"]).starts_with("isoshade::shaders::mine::"));
  }
  for (const ordered_json& function : compiled.reflection["functions"]) {
    EXPECT_TRUE(text(function["glsl"]).starts_with("mine_"));
    EXPECT_TRUE(text(function["cpp"]).starts_with("isoshade::shaders::mine::"));
  }
}

}  // namespace
}  // namespace isoshade::reflect
