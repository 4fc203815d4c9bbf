// SPDX-License-Identifier: Apache-2.0
// Scenes drawn with forward pairs: close to the contract's pictures. How close is printed.
#include <cmath>
#include <cstdio>

#include "runtime/bench/forward.h"
#include "runtime/bench/subject.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

/// Whether depth jumps around a pixel: there rounding may decide which surface it shows.
bool is_at_edge(const backends::Image& image, int x, int y) {
  float least = 1, most = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.width - 1); ++u) {
      const float depth = image.depth[static_cast<size_t>(v * image.width + u)];
      least = std::min(least, depth);
      most = std::max(most, depth);
    }
  return most > 1.02f * least;
}

/// How far the ordinary renderer's picture is from the contract's.
struct Distance {
  double mean = 0, largest = 0;
  double inside = 0;      ///< the largest away from edges
  size_t far_pixels = 0;  ///< that differ by more than 1/255
};

Distance distance(const backends::Image& drawn, const backends::Image& expected) {
  Distance distance;
  const size_t pixels = drawn.rgba.size() / 4;
  for (size_t p = 0; p < pixels; ++p) {
    double of_pixel = 0;
    for (size_t c = 0; c < 3; ++c) {
      // Highlights reach 460: relative above 1.
      const double wanted = expected.rgba[4 * p + c];
      const double difference = std::abs(double{drawn.rgba[4 * p + c]} - wanted) / std::max(1.0, wanted);
      distance.mean += difference / (3.0 * static_cast<double>(pixels));
      of_pixel = std::max(of_pixel, difference);
    }
    distance.largest = std::max(distance.largest, of_pixel);
    const auto place = static_cast<int>(p);
    if (!is_at_edge(expected, place % drawn.width, place / drawn.width))
      distance.inside = std::max(distance.inside, of_pixel);
    distance.far_pixels += of_pixel > 1.0 / 255;
  }
  return distance;
}

struct Case {
  const char* scene;
  double mean;         ///< that the difference stays below
  double far_pixels;   ///< the share of pixels that may differ by more than 1/255
};

class ForwardPicture : public testing::TestWithParam<Case> {
 protected:
  /// Draws the scene, and compares with the contract's picture.
  void expect_close(bool is_peer) {
    const render::Plan plan = equivalence::plan(scene_path(GetParam().scene));
    ASSERT_EQ(bench::forward_lack(plan), "");
    const backends::Image expected = equivalence::draw(plan, *vulkan_backend());
    support::Diagnostics diagnostics;
    check::Library library(ISOSHADE_GRAPHS "/library");
    backends::Image image;
    if (is_peer) {
      const auto peer = bench::ForwardPeer::make(plan, ISOSHADE_GRAPHS, "", library, diagnostics);
      ASSERT_TRUE(peer && peer->renderer->draw(diagnostics) && peer->renderer->read(image, diagnostics))
          << diagnostics.text();
    } else {
      const auto shaders =
          bench::forward_shaders(plan, ISOSHADE_GRAPHS, emit::ForwardSampling::fetch, library, diagnostics);
      ASSERT_TRUE(shaders) << diagnostics.text();
      const vulkan::ForwardScene scene = bench::forward_scene(plan, *shaders);
      const auto renderer = vulkan::ForwardRenderer::create(scene, "", glsl::Contract::outside, diagnostics);
      ASSERT_TRUE(renderer && renderer->draw(diagnostics) && renderer->read(image, diagnostics)) << diagnostics.text();
    }
    ASSERT_EQ(image.rgba.size(), expected.rgba.size());

    const Distance d = distance(image, expected);
    const size_t pixels = image.rgba.size() / 4;
    std::printf(
        "%s: difference to the contract's picture: mean %.3g, largest %.3g, away from edges %.3g; %zu of %zu pixels differ by "
        "more than 1/255\n",
        GetParam().scene, d.mean, d.largest, d.inside, d.far_pixels, pixels);
    EXPECT_LT(d.mean, GetParam().mean);
    EXPECT_LT(static_cast<double>(d.far_pixels), GetParam().far_pixels * static_cast<double>(pixels));
    size_t drawn = 0;
    for (const float depth : expected.depth) drawn += depth != 0;
    EXPECT_GT(drawn, pixels / 10) << "there is something to compare";
  }
};

TEST_P(ForwardPicture, IsCloseToTheContracts) { expect_close(false); }

/// The peer that `isoshade bench` measures.
using ForwardPeerPicture = ForwardPicture;
TEST_P(ForwardPeerPicture, IsCloseToTheContracts) { expect_close(true); }

TEST(ForwardShaders, BuiltInsReplaceGeneratedFunctions) {
  const render::Plan plan = equivalence::plan(scene_path("fog_balls"), 64, 36);
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  auto shaders = bench::forward_shaders(plan, ISOSHADE_GRAPHS, emit::ForwardSampling::fetch, library, diagnostics);
  ASSERT_TRUE(shaders) << diagnostics.text();
  ASSERT_FALSE(shaders->passes.empty() || shaders->posts.empty());
  bench::use_built_ins(*shaders, bench::built_in_definitions);
  const std::string& surface = shaders->passes.begin()->second.pair.text.fragment;
  EXPECT_EQ(surface.find("precise "), surface.npos);
  EXPECT_NE(surface.find("vec3 iso_normalize(vec3 a) {\n  return normalize(a);\n}"), surface.npos) << surface;
  for (const auto& [post, shader] : shaders->posts)
    EXPECT_NE(shader.pair.text.fragment.find("return clamp(a, 0.0, 1.0);"), std::string::npos) << shader.pair.text.fragment;
}

TEST(ForwardShaders, ScenesThatAnOrdinaryRendererCannotDrawAreKnown) {
  EXPECT_EQ(bench::forward_lack(equivalence::plan(scene_path("cartoon_village"), 64, 36)), "shadows and other views");
  EXPECT_EQ(bench::forward_lack(equivalence::plan(scene_path("environment_balls"), 64, 36)), "an environment");
}

INSTANTIATE_TEST_SUITE_P(Scenes, ForwardPicture,
                         testing::Values(Case{"material_balls", 1e-5, 1e-4}, Case{"cartoon_tub", 5e-4, 2e-2},
                                         Case{"moved_vertices", 1e-5, 1e-4}, Case{"derivatives", 1e-3, 4e-2},
                                         Case{"surface_attributes", 1e-5, 1e-4}, // The device decodes sRGB in its own way.
                                         Case{"textures", 3e-4, 1e-3}),
                         [](const auto& info) { return std::string(info.param.scene); });
INSTANTIATE_TEST_SUITE_P(Scenes, ForwardPeerPicture,
                         testing::Values(Case{"material_balls", 1e-5, 1e-4}, Case{"cartoon_tub", 5e-4, 2e-2},
                                         Case{"fog_balls", 1e-5, 1e-4}),
                         [](const auto& info) { return std::string(info.param.scene); });

}  // namespace
}  // namespace isoshade::equivalence
