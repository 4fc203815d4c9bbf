// SPDX-License-Identifier: Apache-2.0
// What the reference backend computes: authored graphs, unrounded, over the visibility that all backends share.
#include <bit>

#include "backends/reference/backend.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::reference {
namespace {

std::optional<driver::Program> compile(const std::string& text, bool reference) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  options.reference = reference;
  const auto source = std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/of_a_test.json", text);
  auto program = driver::compile_function(source, options, diagnostics);
  EXPECT_TRUE(program) << diagnostics.text();
  return program;
}

/// A function of two floats, a and b.
std::vector<Real> evaluate_at(const std::string& nodes, const std::string& out, float a, float b) {
  const auto program = compile(R"({"isoshade": 1, "function": "f",
    "inputs": {"a": {"type": "float"}, "b": {"type": "float"}}, "nodes": {)" +
                                   nodes + R"(}, "outputs": {"out": ")" + out + R"("}})",
                               true);
  if (!program) return {};
  const int32_t inputs[] = {std::bit_cast<int32_t>(a), std::bit_cast<int32_t>(b)};
  return evaluate(*program, inputs, 1);
}

TEST(ReferenceBackend, KeepsDigitsThatFloatsLose) {
  const std::string nodes = R"("sum": {"type": "add", "in1": "a", "in2": "b"},
    "left": {"type": "subtract", "in1": "sum", "in2": "a"})";
  EXPECT_EQ(evaluate_at(nodes, "left", 1e20f, 1e-20f)[0], Real(1e-20f));
}

TEST(ReferenceBackend, ComputesFunctionsTo40Digits) {
  EXPECT_EQ(
      evaluate_at(R"("e": {"type": "exp", "in": "a"}, "s": {"type": "multiply", "in1": "e", "in2": "b"})",
                  "s", 1, 1)[0]
          .text(40),
      "2.718281828459045235360287471352662497757");
}

TEST(ReferenceBackend, RunsLoopsBranchesAndIntegers) {
  const std::string nodes = R"("i": {"type": "convert", "in": "a", "to": "integer"},
    "f": {"type": "convert", "in": "i", "to": "float"},
    "c": {"type": "ifgreater", "value1": "f", "value2": "b", "in1": "f", "in2": "b"})";
  EXPECT_EQ(evaluate_at(nodes, "c", 3.7f, 1)[0], Real(3));
  EXPECT_EQ(evaluate_at(nodes, "c", -3e38f, -3e9f)[0], Real(-2147483648.0));
}

TEST(ReferenceBackend, ReturnsTheBitsOfStoredFloats) {
  const auto program = compile(R"({"isoshade": 1, "function": "f", "inputs": {"p": {"type": "vector2"}},
    "nodes": {"n": {"type": "noise2d", "texcoord": "p"}}, "outputs": {"out": "n"}})",
                               true);
  ASSERT_TRUE(program);
  const int32_t inputs[] = {std::bit_cast<int32_t>(0.5f), std::bit_cast<int32_t>(0.25f)};
  std::vector<int32_t> words;
  support::Diagnostics diagnostics;
  ASSERT_TRUE(create()->evaluate(*program, inputs, 1, words, diagnostics));
  EXPECT_EQ(std::bit_cast<float>(words[0]), stored(evaluate(*program, inputs, 1)[0]));
}

/// The plan of a scene at a small size, for the reference or for the others.
render::Plan small_plan(const std::string& path, bool reference) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  render::PlanOptions options;
  const scene::Scene scene = equivalence::load(path);
  const bool is_slow = scene.posts.size() > 6;  // depth of field reads hundreds of places for each pixel
  options.width = is_slow ? 32 : 64;
  options.height = is_slow ? 18 : 36;
  options.compiler.library = &library;
  options.compiler.reference = reference;
  auto plan = render::plan_frame(scene, options, diagnostics);
  EXPECT_TRUE(plan) << diagnostics.text();
  return plan ? std::move(*plan) : render::Plan();
}

TEST(ReferenceBackend, MatchesTheInterpreterOnShippedScenesUpToRounding) {
  const auto reference = create();
  const auto interpreter = interpreter::create();
  for (const std::string& path : equivalence::shipped_scenes()) {
    const backends::Image exact = equivalence::draw(small_plan(path, true), *reference);
    const backends::Image rounded = equivalence::draw(small_plan(path, false), *interpreter);
    EXPECT_EQ(exact.depth, rounded.depth) << path;
    ASSERT_EQ(exact.rgba.size(), rounded.rgba.size());
    size_t far = 0;
    for (size_t i = 0; i < exact.rgba.size(); ++i)
      if (!(std::abs(exact.rgba[i] - rounded.rgba[i]) <= 1e-4f * std::max(1.0f, std::abs(exact.rgba[i]))))
        ++far;
    // Edges that a graph draws by comparison may fall on the other side of a pixel's centre.
    EXPECT_LE(far, exact.rgba.size() / 200) << path;
  }
}

TEST(ReferenceBackend, MatchesTheInterpreterAtEveryPixelOfMaterialBalls) {
  const std::string path = equivalence::scene_path("material_balls");
  const backends::Image exact = equivalence::draw(small_plan(path, true), *create());
  const backends::Image rounded = equivalence::draw(small_plan(path, false), *interpreter::create());
  for (size_t i = 0; i < exact.rgba.size(); ++i)
    ASSERT_LE(std::abs(exact.rgba[i] - rounded.rgba[i]), 0x1p-10f * std::max(1.0f, exact.rgba[i])) << i / 4;
}

TEST(ReferenceBackend, DrawsSeveralSamplesPerPixel) {
  scene::Scene scene = equivalence::load(equivalence::scene_path("material_balls"));
  scene.samples = 16;
  const backends::Image image = equivalence::draw(equivalence::plan(scene, 12, 7), *interpreter::create());
  render::PlanOptions options;
  options.width = 12;
  options.height = 7;
  check::Library library(ISOSHADE_GRAPHS "/library");
  options.compiler.library = &library;
  options.compiler.reference = true;
  support::Diagnostics diagnostics;
  const auto exact_plan = render::plan_frame(scene, options, diagnostics);
  ASSERT_TRUE(exact_plan) << diagnostics.text();
  const backends::Image exact = equivalence::draw(*exact_plan, *create());
  ASSERT_EQ(exact.rgba.size(), 12u * 7 * 4);
  for (size_t i = 0; i < exact.rgba.size(); ++i)
    ASSERT_LE(std::abs(exact.rgba[i] - image.rgba[i]), 0x1p-10f * std::max(1.0f, exact.rgba[i])) << i / 4;
}

TEST(ReferenceBackend, RejectsLargeImages) {
  render::Plan plan = small_plan(equivalence::scene_path("borders"), true);
  plan.frame.views.back().target.width = max_size + 1;
  support::Diagnostics diagnostics;
  backends::Image image;
  render::DrawStats stats;
  EXPECT_FALSE(render::render(plan, *create(), image, stats, diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, support::Id::device_limit);
}

}  // namespace
}  // namespace isoshade::reference
