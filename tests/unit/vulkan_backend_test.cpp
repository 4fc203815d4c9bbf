// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>

#include "backends/vulkan/limits.h"
#include "tests/unit/backend_frame.h"
#include "tests/unit/vulkan_shaders.h"

namespace isoshade::vulkan {
namespace {

using backends::Frame;
using backends::Image;
using driver::Stage;

int32_t bits(float x) { return std::bit_cast<int32_t>(x); }

// Vertex stages.

std::string transform_glsl() {
  return interface_glsl() + R"(
layout(std430, set = 0, binding = )" +
         std::to_string(output_binding) + R"() writeonly buffer clip_block { uvec4 clip[]; };
void main() {
  vec4 position = vec4(float(gl_VertexIndex), objects[push.object], vertices[8 * (gl_VertexIndex % 4)], view[push.projected]);
  clip[gl_VertexIndex - push.first + push.count] = floatBitsToUint(position);
  gl_PointSize = 1.0;
}
)";
}

/// Whether the device is treated as one with memory of its own, which the host fills by copies.
const auto memories = testing::Bool();
std::string name_of_memory(const testing::TestParamInfo<bool>& own) { return own.param ? "own_memory" : "shared_memory"; }

class VulkanTransform : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Memory, VulkanTransform, memories, name_of_memory);

TEST_P(VulkanTransform, ReturnsTheVerticesOfEachDrawInOrder) {
  HandWritten hand(Texts{{"move", transform_glsl()}}, EvalStage::fragment, GetParam());
  const driver::Program move = named("move", Stage::vertex);
  Frame frame;
  frame.programs = {&move};
  frame.vertices.resize(4 * 8);
  for (size_t i = 0; i < 4; ++i) frame.vertices[8 * i] = static_cast<float>(i) + 0.5f;
  frame.objects = {3.0f, 4.0f};
  backends::View& view = frame.views.emplace_back();
  view.words = {1.0f, -0.0f};
  view.draws.resize(3);
  view.draws[0].first_vertex = 1;
  view.draws[0].vertex_count = 2;
  view.draws[1].vertex_count = 1;
  view.draws[1].object = 1;
  view.draws[1].projected = 1;
  // More than one run of the device takes.
  view.draws[2].first_vertex = 3;
  view.draws[2].vertex_count = max_output_words / 4 + 7;
  support::Array<float> clip;
  ASSERT_TRUE(hand.backend->transform({frame, view}, clip, hand.diagnostics)) << hand.diagnostics.text();

  ASSERT_EQ(clip.size(), size_t{4} * (3 + view.draws[2].vertex_count));
  size_t place = 0;
  for (size_t d = 0; d < 3; ++d) {
    const backends::Draw& draw = view.draws[d];
    for (uint32_t v = 0; v < draw.vertex_count; ++v) {
      const uint32_t vertex = draw.first_vertex + v;
      const float expected[4] = {static_cast<float>(vertex), frame.objects[static_cast<size_t>(draw.object)],
                                 frame.vertices[size_t{8} * (vertex % 4)],
                                 view.words[static_cast<size_t>(draw.projected)]};
      ASSERT_EQ(std::memcmp(clip.data() + 4 * (place + v), expected, sizeof(expected)), 0)
          << "draw " << d << ", vertex " << v;
    }
    place += draw.vertex_count;
  }
}

// Frames.

std::string depth_glsl() {
  return interface_glsl() + R"(
layout(location = 0) flat in int triangle;
layout(location = 0) out int id;
void main() {
  gl_FragDepth = intBitsToFloat(triangles[16 * triangle + 10]);
  id = triangle + 1;
}
)";
}

/// Shows the pixel, the triangle and the lights.
std::string pixel_glsl(const std::string& alpha) {
  return interface_glsl() + R"(
layout(set = 0, binding = )" +
         std::to_string(ids_binding) + R"() uniform isampler2D ids;
layout(location = 0) out vec4 color;
void main() {
  int triangle = texelFetch(ids, ivec2(gl_FragCoord.xy), 0).x - 1;
  if (triangle < 0) discard;
  int object = triangles[16 * triangle + 3] >> )" +
         std::to_string(lower::triangle_flag::bits) + R"(;
  if (int(objects[object + )" + std::to_string(lower::object_word::program) +
         R"(]) != push.program) discard;
  color = vec4(gl_FragCoord.xy, float(triangle) + lights[push.light_count - 1], )" +
         alpha + ");\n}\n";
}

/// Rectangles of two triangles, each at one depth, and what they must give.
struct Rectangles {
  struct Item {
    int x0, y0, x1, y1;
    float depth;
    int program;
  };
  static constexpr int object_words = 40;

  driver::Program red = named("red", Stage::pixel), nan = named("nan", Stage::pixel);
  Frame frame;
  std::vector<int32_t> triangles;
  Image expected;

  Rectangles(int width, int height, const std::vector<Item>& items) {
    frame.views.resize(1);
    frame.views[0].target = {"the picture", width, height};
    frame.programs = {&red, &nan};
    frame.lights = {100.0f, 1000.0f};
    frame.light_count = 2;
    const float background[4] = {0.1f, -0.0f, 1e30f, 0.5f};
    std::copy(std::begin(background), std::end(background), frame.views[0].background);
    for (int program = 0; program < 2; ++program) {
      frame.objects.resize(frame.objects.size() + object_words);
      frame.objects[static_cast<size_t>(program * object_words + lower::object_word::program)] =
          static_cast<float>(program);
    }
    expected.resize(width, height);
    for (size_t i = 0; i < expected.depth.size(); ++i) std::memcpy(&expected.rgba[4 * i], background, 16);
    for (const Item& item : items) add(item);
  }
  const backends::Target& target() const { return frame.views[0].target; }
  backends::ViewPass pass() const { return {frame, frame.views[0]}; }

 private:
  void add(const Item& item) {
    const int x0 = item.x0 * 256, y0 = item.y0 * 256, x1 = item.x1 * 256, y1 = item.y1 * 256;
    const int corners[2][6] = {{x0, y0, x1, y0, x1, y1}, {x0, y0, x1, y1, x0, y1}};
    for (const auto& corner : corners) {
      const auto index = static_cast<float>(triangles.size() / 16);
      int32_t record[16] = {0, 0, 0, item.program * object_words << lower::triangle_flag::bits};
      std::copy(std::begin(corner), std::end(corner), record + lower::triangle_word::position);
      record[lower::triangle_word::depth] = bits(item.depth);
      triangles.insert(triangles.end(), std::begin(record), std::end(record));
      show(item, index, &corner == &corners[0]);
    }
  }

  /// The upper triangle has the pixels on and right of the diagonal; the diagonal belongs to the lower one,
  /// whose right edge it is not: it is the upper one's left edge.
  void show(const Item& item, float index, bool upper) {
    for (int y = std::max(item.y0, 0); y < std::min(item.y1, target().height); ++y)
      for (int x = std::max(item.x0, 0); x < std::min(item.x1, target().width); ++x) {
        const int64_t across = int64_t{2 * (x - item.x0) + 1} * (item.y1 - item.y0);
        const int64_t down = int64_t{2 * (y - item.y0) + 1} * (item.x1 - item.x0);
        if ((across >= down) != upper) continue;
        const size_t pixel = static_cast<size_t>(y * target().width + x);
        if (!(item.depth > expected.depth[pixel])) continue;
        expected.depth[pixel] = item.depth;
        const float color[4] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, index + 1000.0f,
                                item.program == 0 ? 0.25f : std::bit_cast<float>(0x7fc00000)};
        std::memcpy(&expected.rgba[4 * pixel], color, 16);
      }
  }
};

class VulkanDraw : public testing::TestWithParam<bool> {
 protected:
  HandWritten hand{Texts{{"depth", depth_glsl()},
                         {"red", pixel_glsl("0.25")},
                         {"nan", pixel_glsl("intBitsToFloat(0x7fc00000)")}},
                   EvalStage::fragment, GetParam()};

  void expect_identical(const Rectangles& scene) {
    Image image;
    const std::vector<float> vertices(8);
    ASSERT_TRUE(draw(*hand.backend, scene.pass(), vertices, scene.triangles, image, hand.diagnostics))
        << hand.diagnostics.text();
    ASSERT_EQ(image.width, scene.target().width);
    ASSERT_EQ(image.height, scene.target().height);
    for (size_t i = 0; i < image.depth.size(); ++i) {
      ASSERT_EQ(bits(image.depth[i]), bits(scene.expected.depth[i])) << "pixel " << i;
      for (size_t k = 4 * i; k < 4 * i + 4; ++k)
        ASSERT_EQ(bits(image.rgba[k]), bits(scene.expected.rgba[k]))
            << "pixel " << i << ", channel " << k % 4;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Memory, VulkanDraw, memories, name_of_memory);

TEST_P(VulkanDraw, DrawsTheNearestTriangleAtAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {64, 64}, {37, 5}, {129, 200}, {1921, 3}}) {
    expect_identical({width,
                      height,
                      {{-5, -7, 20, 13, 0.5f, 0},
                       {4, 2, 90, 70, 0.75f, 1},
                       {4, 2, 90, 70, 0.75f, 0},  // the first of two as near wins
                       {10, 0, 300, 300, 0.25f, 0},
                       {30, 3, 33, 170, 1.0f, 1},
                       {0, 0, 2000, 300, 0.0f, 0}}});  // behind everything: depth 0 is the background
  }
}

TEST_P(VulkanDraw, DrawsTheBackgroundWithoutTriangles) {
  expect_identical({64, 48, {}});
  expect_identical({64, 48, {{100, 100, 200, 200, 0.5f, 0}, {-80, -30, 0, 900, 0.5f, 1}}});
}

/// 2048 x 2048 pixels come back in more than one band.
TEST_P(VulkanDraw, ReadsLargeImagesBackInBands) {
  static_assert(size_t{2048} * 2048 * 20 > max_readback_bytes);
  expect_identical({2048, 2048, {{1000, 1500, 2048, 2048, 0.5f, 0}}});
}

/// Only blocks of an array that differ from what the device has are written.
TEST_P(VulkanDraw, ShowsEveryChangeOfALargeArray) {
  std::vector<Rectangles::Item> items;
  for (int i = 0; i < 2000; ++i) items.push_back({i % 50, i / 50, i % 50 + 1, i / 50 + 1, 0.5f, 0});
  expect_identical({50, 40, items});
  for (const size_t changed : {size_t{1999}, size_t{0}, size_t{1000}}) {
    items[changed].program = 1;
    expect_identical({50, 40, items});
  }
  items.resize(1500);
  expect_identical({50, 40, items});
  items.resize(5000, {3, 3, 9, 9, 0.75f, 1});  // the array grows
  expect_identical({50, 40, items});
}

TEST_P(VulkanDraw, CountsTheSecondsOfTheDevice) {
  const auto before = hand.backend->device_seconds();
  if (!before) GTEST_SKIP() << "the device has no clock";
  expect_identical({300, 300, {{0, 0, 300, 300, 0.5f, 0}}});
  const auto after = hand.backend->device_seconds();
  EXPECT_GT(after->visibility, before->visibility);
  EXPECT_GT(after->shading, before->shading);
  EXPECT_GT(after->copies, before->copies);
  EXPECT_LT(after->shading, before->shading + 60);
  EXPECT_EQ(after->screen, before->screen);
  EXPECT_EQ(after->layers, before->layers);
}

TEST_P(VulkanDraw, RejectsFramesBeyondTheGuardBand) {
  Rectangles scene(1, 1, {});
  scene.frame.views[0].target.width = guard_band + 1;
  Image image;
  EXPECT_FALSE(draw(*hand.backend, scene.pass(), {}, {}, image, hand.diagnostics));
  ASSERT_EQ(hand.diagnostics.all().size(), 1u);
  EXPECT_EQ(hand.diagnostics.all()[0].id, support::Id::device_limit);
  EXPECT_NE(hand.diagnostics.text().find("8193x1 pixels"), std::string::npos) << hand.diagnostics.text();
  EXPECT_NE(hand.diagnostics.text().find("at most 8192"), std::string::npos) << hand.diagnostics.text();
}

TEST_P(VulkanDraw, ReportsShaderErrorsAndContinues) {
  const Rectangles scene(8, 8, {{0, 0, 8, 8, 0.5f, 0}});
  hand.texts["red"] = "#version 450\nvoid main() { nothing(); }\n";
  Image image;
  EXPECT_FALSE(draw(*hand.backend, scene.pass(), {}, scene.triangles, image, hand.diagnostics));
  ASSERT_EQ(hand.diagnostics.all().size(), 1u);
  EXPECT_EQ(hand.diagnostics.all()[0].id, support::Id::bad_shader);
  EXPECT_NE(hand.diagnostics.text().find("the pixel stage of \"red\""), std::string::npos);
  hand.texts["red"] = pixel_glsl("0.25");
  expect_identical(scene);
}

// Tables.

/// Result k of a row is its first input times 100 plus k.
std::string eval_glsl(size_t words, size_t stride) {
  std::string text = interface_glsl(), body;
  for (size_t i = 0; i < (words + 3) / 4; ++i) {
    const std::string n = std::to_string(i);
    text += "layout(location = " + n + ") out ivec4 result_" + n + ";\n";
    body += "  result_" + n + " = ivec4(100 * inputs[" + std::to_string(stride) +
            " * row]) + ivec4(0, 1, 2, 3) + 4 * " + n + ";\n";
  }
  return text + R"(
void main() {
  int row = push.first + int(gl_FragCoord.x) + int(gl_FragCoord.y) * push.width;
  if (row >= push.count) discard;
)" + body +
         "}\n";
}

std::string vertex_eval_glsl(size_t words, size_t stride) {
  const std::string n = std::to_string(words);
  return interface_glsl() + R"(
layout(std430, set = 0, binding = )" +
         std::to_string(output_binding) + R"() writeonly buffer words_block { int words[]; };
void main() {
  for (int k = 0; k < )" +
         n + "; ++k) words[gl_VertexIndex * " + n + " + k] = 100 * inputs[" + std::to_string(stride) +
         " * gl_VertexIndex] + k;\n  gl_PointSize = 1.0;\n}\n";
}

driver::Program table_program(size_t words, size_t stride) {
  driver::Program program = named("table", Stage::eval);
  program.inputs.resize(1);
  program.inputs[0].words = static_cast<int>(stride);
  program.results.resize(1);
  program.results[0].words = static_cast<int>(words);
  return program;
}

void expect_table(HandWritten& hand, size_t rows, size_t words, size_t stride) {
  std::vector<int32_t> inputs(rows * stride), outputs;
  for (size_t row = 0; row < rows; ++row) inputs[row * stride] = static_cast<int32_t>(row);
  ASSERT_TRUE(hand.backend->evaluate(table_program(words, stride), inputs, rows, outputs, hand.diagnostics))
      << hand.diagnostics.text();
  ASSERT_EQ(outputs.size(), rows * words);
  for (size_t i = 0; i < outputs.size(); ++i)
    ASSERT_EQ(outputs[i], static_cast<int32_t>(100 * (i / words) + i % words)) << "row " << i / words;
}

TEST(VulkanEvaluate, FillsEveryRowOfTablesOfAnyLength) {
  HandWritten hand(Texts{});
  for (const size_t words : {1, 4, 5, 32}) {
    hand.texts["table"] = eval_glsl(words, 3);
    for (const size_t rows : {0, 1, 511, 512, 513, 3000}) expect_table(hand, rows, words, 3);
  }
  hand.texts["table"] = eval_glsl(2, 1);
  expect_table(hand, max_table_rows + 1, 2, 1);
}

TEST(VulkanEvaluate, RunsInTheVertexStage) {
  HandWritten hand(Texts{}, EvalStage::vertex);
  for (const size_t words : {1, 5, 33}) {
    hand.texts["table"] = vertex_eval_glsl(words, 2);
    expect_table(hand, 1000, words, 2);
  }
  hand.texts["table"] = vertex_eval_glsl(1, 1);
  expect_table(hand, max_table_rows + 1, 1, 1);
}

TEST(VulkanEvaluate, RejectsMoreResultsThanAFragmentShaderWrites) {
  HandWritten hand(Texts{{"table", ""}});
  std::vector<int32_t> outputs;
  EXPECT_FALSE(
      hand.backend->evaluate(table_program(33, 1), std::vector<int32_t>(1), 1, outputs, hand.diagnostics));
  ASSERT_EQ(hand.diagnostics.all().size(), 1u);
  EXPECT_EQ(hand.diagnostics.all()[0].id, support::Id::device_limit);
}

TEST(VulkanValidation, LayerMessagesBecomeErrors) {
  std::string without_point_size = vertex_eval_glsl(1, 1);
  without_point_size.erase(without_point_size.find("gl_PointSize"), std::strlen("gl_PointSize = 1.0;"));
  HandWritten hand(Texts{{"table", without_point_size}}, EvalStage::vertex);
  if (hand.backend->description().find("validated") == std::string::npos)
    GTEST_SKIP() << "VK_LAYER_KHRONOS_validation is not installed";
  std::vector<int32_t> outputs;
  EXPECT_FALSE(
      hand.backend->evaluate(table_program(1, 1), std::vector<int32_t>(1), 1, outputs, hand.diagnostics));
  ASSERT_TRUE(hand.diagnostics.has_errors());
  EXPECT_EQ(hand.diagnostics.all().back().id, support::Id::validation);
}

}  // namespace
}  // namespace isoshade::vulkan
