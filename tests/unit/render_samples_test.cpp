// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

#include "backends/interpreter/backend.h"
#include "backends/resolve.h"
#include "compiler/functions/blending.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/compare/compare.h"
#include "runtime/render/render.h"
#include "runtime/render/samples.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
using backends::Image;

constexpr float largest = functions::largest_finite;

Image two_by_two(const std::array<float, 4>& samples) {
  Image image;
  image.resize(2, 2);
  image.depth.assign(samples.begin(), samples.end());
  for (size_t i = 0; i < 16; ++i) image.rgba[i] = samples[i / 4] * static_cast<float>(1 + i % 4);
  return image;
}

void halve(Image& image) {
  const lanes::FpGuard guard;
  backends::halve(image.rgba.data(), image.depth.data(), image.width, image.height);
  image.resize(image.width / 2, image.height / 2);
}

uint32_t bits_of_mean(const std::array<float, 4>& samples) {
  Image image = two_by_two(samples);
  image.rgba = {samples[0], 0, 0, 0, samples[1], 0, 0, 0, samples[2], 0, 0, 0, samples[3], 0, 0, 0};
  halve(image);
  return std::bit_cast<uint32_t>(image.rgba[0]);
}

TEST(Halve, AveragesEachChannelAndTheDepth) {
  Image image = two_by_two({0.5f, 1, 0, 0.25f});
  halve(image);
  EXPECT_EQ(image.width, 1);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(image.rgba, (std::vector<float>{0.4375f, 0.875f, 1.3125f, 1.75f}));
  EXPECT_EQ(image.depth, std::vector<float>{0.4375f});
}

TEST(Halve, TakesEachPixelFromItsOwnSamples) {
  Image image;
  image.resize(6, 4);
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const size_t pixel = i / 6 / 2 * 3 + i % 6 / 2;
    image.depth[i] = static_cast<float>(pixel);
    for (size_t c = 0; c < 4; ++c) image.rgba[4 * i + c] = static_cast<float>(10 * pixel + c);
  }
  halve(image);
  ASSERT_EQ(image.depth, (std::vector<float>{0, 1, 2, 3, 4, 5}));
  for (size_t i = 0; i < 24; ++i) EXPECT_EQ(image.rgba[i], static_cast<float>(10 * (i / 4) + i % 4));
}

TEST(Halve, AvoidsOverflowDenormalsAndNoncanonicalNans) {
  EXPECT_EQ(bits_of_mean({largest, largest, largest, largest}), std::bit_cast<uint32_t>(largest));
  EXPECT_EQ(bits_of_mean({largest, largest, -largest, -largest}), 0u);
  EXPECT_EQ(bits_of_mean({0x1p-126f, 0x1p-126f, 0x1p-126f, 0x1p-126f}), 0u);
  EXPECT_EQ(bits_of_mean({INFINITY, 1, 1, 1}), 0x7f800000u);
  EXPECT_EQ(bits_of_mean({INFINITY, 1, -INFINITY, 1}), 0x7fc00000u);
  EXPECT_EQ(bits_of_mean({1, std::bit_cast<float>(0xffc12345u), 1, 1}), 0x7fc00000u);
}

TEST(MeanOfFour, ErrorIsWithinItsStatedBound) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 100'000; ++i) {
    const float a = any(random), b = any(random), c = any(random), d = any(random);
    const double exact = (static_cast<double>(a) + b + c + d) / 4;
    const double magnitude = (std::abs(static_cast<double>(a)) + std::abs(b) + std::abs(c) + std::abs(d)) / 4;
    ASSERT_LE(std::abs(functions::mean_of_four(a, b, c, d) - exact), magnitude * 0x1p-23);
  }
}

/// Scenes beside an effect, in a folder of their own.
class SamplesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_samples" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("plain.json", R"({"isoshade": 1, "effect": "plain",
      "parameters": {"color": {"type": "color3", "value": [1, 0.5, 0.25]}},
      "passes": [{"name": "base", "cull": "none", "color": "color"}]})");
    write("sizes.json", R"({"isoshade": 1, "post": "sizes",
      "nodes": {"size": {"type": "screensize"}, "pixel": {"type": "screencoord"},
                "color": {"type": "combine4", "in1": "size.x", "in2": "size.y", "in3": "pixel.x", "in4": 1,
                          "to": "color4"}},
      "outputs": {"color": "color"}})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::optional<render::Plan> plan(const std::string& members) {
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, (folder_ / "scene.json").string());
    const auto scene = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    if (!scene) return std::nullopt;
    options_.compiler.library = &library_;
    return render::plan_frame(*scene, options_, diagnostics_);
  }

  Image drawn(const render::Plan& plan) {
    Image image;
    EXPECT_TRUE(render::render(plan, *interpreter::create(), image, stats_, diagnostics_))
        << diagnostics_.text();
    return image;
  }

  fs::path folder_;
  check::Library library_;
  render::PlanOptions options_;
  render::DrawStats stats_;
  support::Diagnostics diagnostics_;
};

TEST_F(SamplesTest, EnlargeTheFrameButNotThePixelSize) {
  const std::string members =
      R"("size": [30, 20], "objects": {"o": {"mesh": "box", "effect": "plain.json"}})";
  const auto one = plan(members);
  ASSERT_TRUE(one) << diagnostics_.text();
  for (const auto& [samples, side] : {std::pair{4, 2}, {16, 4}}) {
    const auto several = plan("\"samples\": " + std::to_string(samples) + ", " + members);
    ASSERT_TRUE(several) << diagnostics_.text();
    EXPECT_EQ(several->frame.picture().target.width, 30 * side);
    EXPECT_EQ(several->frame.picture().target.height, 20 * side);
    EXPECT_EQ(several->frame.picture().words, one->frame.picture().words);  // pixel_size is among these words
    EXPECT_EQ(several->frame.objects, one->frame.objects);
    const Image image = drawn(*several);
    EXPECT_EQ(image.width, 30);
    EXPECT_EQ(image.height, 20);
    EXPECT_EQ(image.depth.size(), 600u);
  }
}

TEST_F(SamplesTest, AreAveragedAtEdges) {
  // The plane's left edge goes through the middle of column 2, at 2.5 pixels.
  const auto made = plan(R"("size": [8, 8], "samples": 16, "background": [0, 0, 1, 0],
    "camera": {"type": "orthographic", "position": [0, 5, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 8},
    "objects": {"o": {"mesh": {"type": "plane", "size": [100, 100]}, "effect": "plain.json",
                      "transform": {"translate": [48.5, 0, 0]}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const Image image = drawn(*made);
  const auto pixel = [&](size_t x) {
    return std::vector<float>(image.rgba.begin() + static_cast<ptrdiff_t>(4 * (8 + x)),
                              image.rgba.begin() + static_cast<ptrdiff_t>(4 * (8 + x) + 4));
  };
  EXPECT_EQ(pixel(1), (std::vector<float>{0, 0, 1, 0}));
  EXPECT_EQ(pixel(2), (std::vector<float>{0.5f, 0.25f, 0.625f, 0.5f}));
  EXPECT_EQ(pixel(3), (std::vector<float>{1, 0.5f, 0.25f, 1}));
  EXPECT_EQ(image.depth[8 + 1], 0.0f);
  EXPECT_EQ(image.depth[8 + 2], 0.5f * image.depth[8 + 3]);
}

TEST_F(SamplesTest, AreThoseOfTheBackgroundWhereNothingIsDrawn) {
  const std::string members = R"("size": [600, 300], "samples": 16, "background": [0.3, 1e-38, 0.1, 1],
    "objects": {"o": {"mesh": "plane", "effect": "plain.json", "transform": {"rotate": [90, 0, 0], "scale": 0.01,
                                                                           "translate": [3, 1, 0]}}})";
  const auto made = plan(members);
  ASSERT_TRUE(made) << diagnostics_.text();
  const Image image = drawn(*made);
  // As far from the object, in the part that is drawn and in one that is not.
  const auto pixel = [&](size_t x) { return std::vector(&image.rgba[4 * x], &image.rgba[4 * x] + 4); };
  EXPECT_EQ(pixel(599), pixel(0));
  EXPECT_EQ(pixel(0)[0], 0.3f);
}

TEST_F(SamplesTest, PostsRunAtImageResolution) {
  const auto made =
      plan(R"("size": [12, 6], "samples": 16, "posts": [{"name": "p", "effect": "sizes.json"}])");
  ASSERT_TRUE(made) << diagnostics_.text();
  const Image image = drawn(*made);
  EXPECT_EQ(image.rgba.size(), 12u * 6 * 4);
  EXPECT_EQ(image.rgba[0], 12.0f);
  EXPECT_EQ(image.rgba[1], 6.0f);
}

TEST_F(SamplesTest, AreRejectedIfTheFrameWouldBeTooLarge) {
  EXPECT_TRUE(plan(R"("size": [2048, 1], "samples": 16)"));
  EXPECT_FALSE(plan(R"("size": [2049, 1], "samples": 16)"));
  EXPECT_NE(diagnostics_.text().find(
                "16 samples a pixel has at most 2048 pixels each way, and this one has 2049x1"),
            std::string::npos)
      << diagnostics_.text();
  diagnostics_ = support::Diagnostics();
  options_.width = 4097;
  options_.height = 2;
  EXPECT_FALSE(plan(R"("samples": 4)"));
  EXPECT_NE(diagnostics_.text().find("error[too-large]"), std::string::npos) << diagnostics_.text();
}

}  // namespace
}  // namespace isoshade
