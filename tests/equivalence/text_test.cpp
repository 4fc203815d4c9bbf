// SPDX-License-Identifier: Apache-2.0
// The texts that users read and compile: they compile as they stand, read alike, name nodes and lines, and hold
// nothing that the graph does not need.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <sstream>

#include "compiler/check/library.h"
#include "compiler/check/stage_needs.h"
#include "compiler/driver/driver.h"
#include "compiler/interface/host.h"
#include "compiler/targets/glsl/spirv.h"
#include "tests/unit/temporary_folder.h"

namespace isoshade::equivalence {
namespace {

namespace fs = std::filesystem;

struct Texts {
  std::string name;
  driver::Stage stage;
  std::string glsl, exact, cpp;
};

std::vector<fs::path> documents(const char* folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(ISOSHADE_GRAPHS) / folder))
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// The programs of all shipped functions that can be evaluated by themselves, of effects and of posts, by folder and
/// name.
const std::vector<Texts>& shipped() {
  static const std::vector<Texts> all = [] {
    std::vector<Texts> texts;
    support::Diagnostics diagnostics;
    check::Library library(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = &library;
    const auto add = [&](const std::string& name, const driver::Program& program) {
      texts.push_back({name, program.stage, driver::glsl(program, driver::Division::native),
                       driver::glsl(program, driver::Division::exact), driver::cpp(program)});
    };
    for (const char* folder : {"library", "source_forms", "effects", "materials", "textures"}) {
      for (const fs::path& path : documents(folder)) {
        const support::Source source = graph::read_source(path.string(), diagnostics);
        const auto kind = driver::kind_of(source, diagnostics);
        const std::string place = path.parent_path().filename().string() + "_";
        if (kind == graph::DocumentKind::function) {
          support::Diagnostics unheard;
          const auto typed = driver::check_document(source, options, diagnostics);
          if (typed != nullptr && !check::stands_alone(*typed, unheard)) continue;
          if (const auto program = driver::compile_function(source, options, diagnostics))
            add(place + program->name, *program);
        } else if (kind == graph::DocumentKind::post) {
          if (const auto post = driver::compile_post(source, options, diagnostics))
            add(place + post->name, post->program);
        } else if (kind == graph::DocumentKind::effect) {
          const auto effect = driver::compile_effect(source, options, diagnostics);
          if (!effect) continue;
          for (const driver::EffectPass& pass : effect->passes) {
            add(place + effect->name + "_" + pass.name + "_vertex", pass.vertex);
            add(place + effect->name + "_" + pass.name + "_pixel", pass.pixel);
            if (pass.cutout) add(place + effect->name + "_" + pass.name + "_cutout", *pass.cutout);
          }
        }
      }
    }
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
    return texts;
  }();
  return all;
}

void expect_success(const std::string& command) {
  EXPECT_EQ(std::system((command + " >&2").c_str()), 0) << command;
}

/// All first groups of a pattern's matches, in order.
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    found.push_back((*it)[1]);
  return found;
}

const std::string function_head =
    "(?:^|\n)(?:ISOSHADE_INLINE |precise )?[A-Za-z_0-9]+(?:<F>)? ([a-zA-Z_0-9]+)\\([^\n;]*\\) \\{";

TEST(Text, GlslCompilesUnmodified) {
  const testing::TemporaryFolder folder;
  std::string files;
  for (const Texts& texts : shipped()) {
    const std::string ending = texts.stage == driver::Stage::vertex ? ".vert" : ".frag";
    files += " " + folder.write(texts.name + ending, texts.glsl).string();
    files += " " + folder.write(texts.name + "_exact" + ending, texts.exact).string();
  }
  ASSERT_FALSE(files.empty());
  // One file a run: -V of several would link them into one program.
  std::istringstream paths(files);
  for (std::string path; paths >> path;)
    expect_success("glslangValidator -V " + path + " -o " + path + ".spv");
}

TEST(Text, CppCompilesWithoutWarningsInBothCompilers) {
  const testing::TemporaryFolder folder;
  for (const Texts& texts : shipped()) {
    const std::string path = folder.write(texts.name + ".cpp", texts.cpp).string();
    for (const char* compiler : {"g++", "clang++"})
      expect_success(std::string(compiler) +
                     " -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " ISOSHADE_ROOT "/include " + path);
  }
}

TEST(Text, CompilesForProgramsWithoutInputs) {
  support::Diagnostics diagnostics;
  check::Library library("");
  driver::CompileOptions options;
  options.library = &library;
  const auto source = [](const std::string& text) {
    return std::make_shared<support::SourceFile>("a.json", R"({"isoshade": 1, )" + text + "}");
  };
  const std::string nodes = R"("nodes": {"c": {"type": "constant", "value": [1, 2, 3], "to": "color3"},
    "p": {"type": "constant", "value": [1, 2, 3]}})";
  const auto effect = driver::compile_effect(
      source(R"("effect": "e", "passes": [{"name": "p", "color": "c", "position": "p"}], )" + nodes), options,
      diagnostics);
  const auto post = driver::compile_post(source(R"("post": "s", "outputs": {"color": "c"}, )" + nodes),
                                         options, diagnostics);
  const auto function = driver::compile_function(
      source(R"("function": "f", "outputs": {"out": "c", "other": "p"}, )" + nodes), options, diagnostics);
  ASSERT_TRUE(effect && post && function) << diagnostics.text();
  const testing::TemporaryFolder folder;
  for (const driver::Program* program :
       {&effect->passes[0].vertex, &effect->passes[0].pixel, &post->program, &*function}) {
    const std::string path =
        folder.write(std::string(lower::name(program->stage)) + ".cpp", driver::cpp(*program)).string();
    for (const char* compiler : {"g++", "clang++"})
      for (const char* lanes : {"", " -DISOSHADE_LANES=4"})
        expect_success(std::string(compiler) + lanes +
                       " -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " ISOSHADE_ROOT "/include " + path);
  }
}

TEST(Text, CompilesWithReservedWordsAsNames) {
  // Keywords and macros of both languages, and what the texts around functions say, some with forms of their own.
  const std::vector<std::string> names = {"main",
                                          "template",
                                          "precise",
                                          "gl_Position",
                                          "GL_EXT_ray_query",
                                          "VULKAN",
                                          "active",
                                          "mat2x3",
                                          "dmat4x4",
                                          "image2DArray",
                                          "usampler2DRect",
                                          "itextureCube",
                                          "subpassInputMS",
                                          "spirv_type",
                                          "pervertexEXT",
                                          "workgroupcoherent",
                                          "minInvocationsAMD",
                                          "dFdxFine",
                                          "floatBitsToUint",
                                          "ISOSHADE_LANES",
                                          "Lanes",
                                          "batch",
                                          "inputs_block",
                                          "result_0",
                                          "__LINE__",
                                          "a__b",
                                          "a_b",
                                          "_a_b",
                                          "linux",
                                          "and",
                                          "isoshade_eval",
                                          "EOF"};
  support::Diagnostics diagnostics;
  check::Library library("");
  std::string nodes, previous = "x";
  for (const std::string& name : names) {
    // A function, its input, its node and an output of this name; and in the caller a node.
    library.add("odd/" + name + ".json",
                R"({"isoshade": 1, "function": ")" + name + R"(", "inputs": {")" + name +
                    R"(": {"type": "float"}}, "nodes": {"n": {"type": "sin", "in": ")" + name +
                    R"("}}, "outputs": {"out": "n", ")" + name + R"(": "n"}})");
    nodes += (nodes.empty() ? "\"" : ", \"") + name + R"(": {"type": ")" + name + R"(.json", ")" + name +
             "\": \"" + previous + "\"}";
    previous = name + ".out";
  }
  const std::string text =
      R"({"isoshade": 1, "function": "odd", "inputs": {"x": {"type": "float"}}, "nodes": {)" + nodes +
      R"(}, "outputs": {"out": ")" + previous + "\"}}";
  driver::CompileOptions options;
  options.library = &library;
  const auto program = driver::compile_function(std::make_shared<support::SourceFile>("odd/odd.json", text),
                                                options, diagnostics);
  ASSERT_TRUE(program) << diagnostics.text();
  const testing::TemporaryFolder folder;
  const std::string glsl =
      folder.write("odd.frag", driver::glsl(*program, driver::Division::native)).string();
  expect_success("glslangValidator -V " + glsl + " -o " + glsl + ".spv");
  const std::string cpp = folder.write("odd.cpp", driver::cpp(*program)).string();
  for (const char* compiler : {"g++", "clang++"})
    expect_success(std::string(compiler) +
                   " -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " ISOSHADE_ROOT "/include " + cpp);
}

TEST(Text, DocumentTextCannotInjectCode) {
  // What would be code, end a comment or join lines, wherever a document or its path has text.
  const std::string evil =
      R"(*/ \n#error evil\n#include <evil.h>\n// \\\n #pragma evil ??/\n \u2028 evil();)";
  const std::string path = "odd/\n#error evil\n*/ ?\?/\n\\\n.json";
  support::Diagnostics diagnostics;
  check::Library library("");
  library.add(path.substr(0, path.rfind('/')) + "/part.json",
              R"({"isoshade": 1, "function": "part", "doc": ")" + evil +
                  R"(", "inputs": {"x": {"type": "float", "doc": ")" + evil +
                  R"("}}, "nodes": {"n": {"type": "sin", "in": "x", "doc": ")" + evil +
                  R"("}}, "outputs": {"out": "n"}})");
  const std::string text =
      R"({"isoshade": 1, "function": "f", "doc": ")" + evil + R"(", "extras": {")" + evil + R"(": ")" + evil +
      R"("}, "inputs": {"x": {"type": "float"}}, "nodes": {"a": {"type": "part.json", "x": "x"},
      "n": {"type": "expression", "code": "a +\n\t1.0e0 \n", "a": "a", "doc": ")" +
      evil + R"("}}, "outputs": {"out": "n"}})";
  driver::CompileOptions options;
  options.library = &library;
  const auto program =
      driver::compile_function(std::make_shared<support::SourceFile>(path, text), options, diagnostics);
  ASSERT_TRUE(program) << diagnostics.text();
  const testing::TemporaryFolder folder;
  const std::string glsl = driver::glsl(*program, driver::Division::native), cpp = driver::cpp(*program);
  const std::string shader = folder.write("evil.frag", glsl).string();
  expect_success("glslangValidator -V " + shader + " -o " + shader + ".spv");
  const std::string header = folder.write("evil.cpp", cpp).string();
  for (const char* compiler : {"g++ -trigraphs", "clang++ -trigraphs"})
    expect_success(std::string(compiler) +
                   " -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " ISOSHADE_ROOT "/include " + header);
  for (const std::string& written : {glsl, cpp}) {
    std::istringstream lines(written);
    for (std::string line; std::getline(lines, line);) {
      const size_t comment = line.find("//");
      EXPECT_EQ(line.substr(0, comment).find("evil"), std::string::npos) << line;
      EXPECT_FALSE(line.ends_with("\\") || line.ends_with("?"
                                                          "?/"))
          << line;
    }
  }
}

TEST(Text, HasTheSameStructureInBothLanguages) {
  size_t compared = 0;
  for (const Texts& texts : shipped()) {
    // In C++ the functions of large programs are cut into parts.
    if (texts.cpp.find("// A large program") != std::string::npos) continue;
    ++compared;
    SCOPED_TRACE(texts.name);
    // The same functions in the same order, and the same nodes of the same lines.
    std::vector<std::string> glsl = matches(texts.glsl, function_head);
    std::erase_if(glsl, [](const std::string& name) { return name == "canonical" || name == "main"; });
    EXPECT_EQ(glsl, matches(texts.cpp, function_head));
    const auto body = [](const std::string& text, const std::string& end) {
      return text.substr(0, std::min(text.find(end), text.find("\nvoid main() {")));
    };
    const auto comments = [&](const std::string& text, const std::string& end) {
      std::vector<std::string> all = matches(body(text, end), "(?:\n *|; +)(// [^\n]*)");
      std::erase_if(all, [](const std::string& comment) {
        return comment.ends_with("from drivers, which would fold arithmetic with them.") ||
               comment.starts_with("// SignedZeroInfNanPreserve") ||
               comment.find("generated by isoshade") != std::string::npos ||
               comment.starts_with("// A large program");
      });
      return all;
    };
    EXPECT_EQ(comments(texts.glsl, "// The bits of a float"),
              comments(texts.cpp, "namespace isoshade_program\n\nstruct"));
    // The same names get values in the same order; but for the high word of a product, which is no expression in
    // GLSL but an out parameter.
    const std::string definition =
        "\n +(?:const |precise )?(?:[A-Za-z_0-9]+(?:<[A-Za-z]+>)?) ([a-z_A-Z0-9]+) = "
        "(?!(?:unsigned_)?mul_hi)";
    EXPECT_EQ(matches(body(texts.glsl, "// The bits of a float"), definition),
              matches(body(texts.cpp, "namespace isoshade_program\n\nstruct"), definition));
  }
  EXPECT_GT(compared, shipped().size() / 2);
}

TEST(Text, CallsNodesByTheirIds) {
  const auto material = std::ranges::find(shipped(), "materials_cook_torrance_base_pixel", &Texts::name);
  ASSERT_NE(material, shipped().end());
  EXPECT_FALSE(matches(material->glsl, "(draw_f0)").empty()) << "computed once for a draw";
  for (const char* node : {"kd", "one_light", "direct", "reflectance", "sky_specular", "color"})
    for (const std::string* text : {&material->glsl, &material->cpp})
      EXPECT_EQ(matches(*text, std::string("[^\n]* (") + node + ") = ").size() >= 1, true) << node;
}

TEST(Text, PreciseReachesEveryOperation) {
  for (const Texts& texts : shipped()) {
    SCOPED_TRACE(texts.name);
    const auto kind =
        texts.stage == driver::Stage::vertex ? glsl::ShaderKind::vertex : glsl::ShaderKind::fragment;
    for (const std::string* text : {&texts.glsl, &texts.exact}) {
      support::Diagnostics diagnostics;
      EXPECT_EQ(glsl::count_contractible(*text, kind, diagnostics), 0u) << diagnostics.text();
    }
  }
}

TEST(Text, ContainsNoUnusedFunctionsOrBuffers) {
  for (const Texts& texts : shipped()) {
    SCOPED_TRACE(texts.name);
    for (const std::string* text : {&texts.glsl, &texts.exact, &texts.cpp}) {
      for (const std::string& function : matches(*text, function_head)) {
        if (function == "main") continue;
        EXPECT_GE(matches(*text, "[^A-Za-z_0-9](" + function + ")(?:<[A-Za-z]+>)?\\(").size(), 2u)
            << function;
      }
      for (const std::string& buffer : matches(*text, "readonly buffer [a-z_]+ \\{ [a-z]+ ([a-z]+)\\[\\]"))
        EXPECT_GE(matches(*text, "(" + buffer + ")\\[[a-z0-9]").size(), 1u) << buffer;
    }
  }
}

TEST(Manual, ListsWhatShadersAskOfTheirHost) {
  std::stringstream manual;
  manual << std::ifstream(ISOSHADE_GRAPHS "/README.md").rdbuf();
  for (size_t i = 0; i < interface::host_call_count; ++i) {
    const interface::HostRow& asked = interface::row(static_cast<interface::HostCall>(i));
    const std::string line = "| `" + std::string(asked.result) + " " + std::string(asked.name) + "(" +
                             std::string(asked.parameters) + ")` | " + std::string(asked.doc) + " |\n";
    EXPECT_NE(manual.str().find(line), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace isoshade::equivalence
