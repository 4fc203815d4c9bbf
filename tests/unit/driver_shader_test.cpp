// SPDX-License-Identifier: Apache-2.0
// Pure shaders among others: in one program, whatever documents are called.
#include <gtest/gtest.h>
#include <regex>

#include "compiler/driver/shader.h"
#include "compiler/emit/names.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/targets.h"

namespace isoshade::driver {
namespace {

const std::string graphs = ISOSHADE_GRAPHS;

/// A function of a name, as text.
std::string half(const std::string& name, const std::string& factor = "0.5") {
  return R"({"isoshade": 1, "function": ")" + name + R"(", "inputs": {"in": {"type": "float"}},
  "nodes": {"y": {"type": "multiply", "in1": "in", "in2": )" +
         factor + R"(}}, "outputs": {"out": "y"}})";
}

std::string compile(const support::Source& source, const ShaderOptions& options, const char* target,
                    support::Diagnostics& diagnostics) {
  check::Library library(graphs + "/library");
  CompileOptions compile_options;
  compile_options.library = &library;
  const auto shader = compile_shader(source, compile_options, options, diagnostics);
  return shader ? text(*shader, *targets::find(target)) : "";
}

std::string glsl_of(const std::string& document, const std::string& prefix = "") {
  support::Diagnostics diagnostics;
  const support::Source source = std::make_shared<support::SourceFile>("document.json", document);
  const std::string text = compile(source, {.prefix = prefix}, "glsl", diagnostics);
  EXPECT_NE(text, "") << diagnostics.text();
  return text;
}

/// Why a fragment shader of these texts, which evaluates `color`, does not compile; empty if it does.
std::string error_of(const std::string& texts, const std::string& color) {
  support::Diagnostics diagnostics;
  const std::string shader = glsl::head() + texts +
                             "layout(location = 0) out vec4 color;\nvoid main() { color = vec4(" + color +
                             "); }\n";
  return glsl::compile_spirv(shader, glsl::ShaderKind::fragment, diagnostics) ? "" : diagnostics.text();
}

TEST(PureShader, MayBeIncludedTwice) {
  const std::string glow = glsl_of(half("glow"));
  EXPECT_EQ(error_of(glow + glow, "glow(1.0)"), "");
}

TEST(PureShader, OfThePrefixOfAnotherIsRefusedByTheCompiler) {
  const std::string glow = glsl_of(half("glow")), other = glsl_of(half("glow_", "0.25"));
  EXPECT_NE(error_of(glow + other, "glow(1.0)").find("Two shaders begin their names with glow_"),
            std::string::npos)
      << error_of(glow + other, "glow(1.0)");
  EXPECT_EQ(error_of(glow + glsl_of(half("glow_", "0.25"), "other"), "glow(1.0) + other(1.0)"), "");
}

TEST(PureShader, DiffersFromOneInCapitals) {
  EXPECT_EQ(error_of(glsl_of(half("glow")) + glsl_of(half("Glow")), "glow(1.0) + Glow(1.0)"), "");
}

TEST(PureShader, TakesNoNameOfTheLibraryOrTheLanguage) {
  EXPECT_EQ(emit::prefix_of("glow"), "glow");
  EXPECT_EQ(emit::prefix_of("iso"), "n_iso");
  EXPECT_EQ(emit::prefix_of("iso_sin"), "n_iso_sin");
  EXPECT_EQ(emit::prefix_of("ISO_SIN"), "n_ISO_SIN");
  EXPECT_EQ(emit::prefix_of("isoshade"), "n_isoshade");
  EXPECT_EQ(emit::prefix_of("gl_"), "n_gl");
  EXPECT_EQ(emit::prefix_of("isotope"), "isotope");
}

TEST(PureShader, HasThePrefixThatWasAskedForOrNone) {
  for (const char* prefix : {"mine", "mine_"})
    EXPECT_NE(glsl_of(half("glow"), prefix).find("float mine"), std::string::npos) << prefix;
  for (const char* prefix : {"_mine", "my__own", "mine__", "gl_mine", "iso", "not a name"}) {
    support::Diagnostics diagnostics;
    const support::Source source = std::make_shared<support::SourceFile>("document.json", half("glow"));
    EXPECT_EQ(compile(source, {.prefix = prefix}, "glsl", diagnostics), "") << prefix;
    ASSERT_EQ(diagnostics.all().size(), 1u) << prefix;
    EXPECT_EQ(diagnostics.all()[0].id, support::Id::bad_id) << prefix;
  }
}

TEST(PureShader, FillsBooleanFieldsWithBooleansInCpp) {
  support::Diagnostics diagnostics;
  // Cut into parts that hand on booleans.
  const support::Source source = graph::read_source(graphs + "/effects/terrain.json", diagnostics);
  const std::string cpp = compile(source, {.prefix = "", .division = Division::exact}, "cpp", diagnostics);
  ASSERT_NE(cpp, "") << diagnostics.text();
  EXPECT_NE(cpp.find("bool_of<F>("), std::string::npos);
  const std::regex narrowed(R"(return \w+<F>\{([^;]*, )?[^,;(]* [&|] [^;]*;)");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(cpp, found, narrowed)) << found.str();
}

}  // namespace
}  // namespace isoshade::driver
