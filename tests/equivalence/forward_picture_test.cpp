// SPDX-License-Identifier: Apache-2.0
// Scenes drawn with forward pairs: close to the contract's pictures. How close is printed.
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "compiler/driver/forward.h"
#include "compiler/targets/targets.h"
#include "tests/equivalence/forward_renderer.h"

namespace isoshade::equivalence {
namespace {

/// The pairs of all passes of a plan.
std::map<const driver::EffectPass*, driver::ForwardPair> pairs_of(const render::Plan& plan) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  std::map<const driver::EffectPass*, driver::ForwardPair> pairs;
  for (const driver::Effect& effect : plan.effects) {
    const support::Source source = graph::read_source(ISOSHADE_GRAPHS "/" + effect.document, diagnostics);
    const auto shader = driver::compile_shader(source, options, {}, diagnostics);
    if (!shader) {
      ADD_FAILURE() << diagnostics.text();
      continue;
    }
    const auto made = driver::forward_pairs(*shader, targets::get(emit::TargetId::glsl));
    for (size_t i = 0; i < effect.passes.size(); ++i) pairs[&effect.passes[i]] = made.at(i);
  }
  return pairs;
}

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

struct Case {
  const char* scene;
  double mean;         ///< that the difference stays below
  double far_pixels;   ///< the share of pixels that may differ by more than 1/255
};

class ForwardPicture : public testing::TestWithParam<Case> {};

TEST_P(ForwardPicture, IsCloseToTheContracts) {
  render::Plan plan = equivalence::plan(scene_path(GetParam().scene));
  plan.posts = {};
  const int width = plan.frame.picture().target.width, height = plan.frame.picture().target.height;
  const backends::Image expected = equivalence::draw(plan, *vulkan_backend());
  ASSERT_EQ(expected.width, width) << "the scene has one sample a pixel";

  support::Diagnostics diagnostics;
  const vulkan::Instance instance;
  const int index = vulkan::choose(instance, "", diagnostics);
  ASSERT_GE(index, 0) << diagnostics.text();
  forward::Renderer renderer(instance.devices[static_cast<size_t>(index)], width, height);
  const auto made = pairs_of(plan);
  // The transform of a copy may mirror it, and a parameter may switch culling off.
  std::map<std::tuple<const driver::EffectPass*, interface::Cull, bool>, forward::Pair> pairs;
  std::vector<const forward::Pair*> of_draws;
  for (const backends::Draw& draw : plan.frame.picture().draws) {
    const auto origin = std::ranges::find(plan.origins, draw.object, &render::RecordOrigin::record);
    ASSERT_NE(origin, plan.origins.end());
    const std::tuple key(origin->pass, draw.state.cull, draw.mirrored);
    if (!pairs.contains(key)) pairs.emplace(key, renderer.pair(made.at(origin->pass), draw.state, draw.mirrored));
    of_draws.push_back(&pairs.at(key));
  }
  const std::vector<float> rgba = renderer.draw(plan, of_draws);

  double sum = 0, largest = 0, largest_inside = 0;
  size_t far = 0, pixels = rgba.size() / 4;
  for (size_t p = 0; p < pixels; ++p) {
    double of_pixel = 0;
    for (size_t c = 0; c < 3; ++c) {
      // Highlights reach 460: relative above 1.
      const double wanted = expected.rgba[4 * p + c];
      const double difference = std::abs(double{rgba[4 * p + c]} - wanted) / std::max(1.0, wanted);
      sum += difference;
      of_pixel = std::max(of_pixel, difference);
    }
    largest = std::max(largest, of_pixel);
    const auto place = static_cast<int>(p);
    if (!is_at_edge(expected, place % width, place / width)) largest_inside = std::max(largest_inside, of_pixel);
    far += of_pixel > 1.0 / 255;
  }
  const double mean = sum / (3.0 * static_cast<double>(pixels));
  std::printf(
      "%s: difference to the contract's picture: mean %.3g, largest %.3g, away from edges %.3g; %zu of %zu pixels differ by more "
      "than 1/255\n",
      GetParam().scene, mean, largest, largest_inside, far, pixels);
  EXPECT_LT(mean, GetParam().mean);
  EXPECT_LT(static_cast<double>(far), GetParam().far_pixels * static_cast<double>(pixels));
  size_t drawn = 0;
  for (size_t p = 0; p < pixels; ++p) drawn += expected.depth[p] != 0;
  EXPECT_GT(drawn, pixels / 10) << "there is something to compare";
}

INSTANTIATE_TEST_SUITE_P(Scenes, ForwardPicture,
                         testing::Values(Case{"material_balls", 1e-5, 1e-4}, Case{"cartoon_tub", 5e-4, 2e-2},
                                         Case{"moved_vertices", 1e-5, 1e-4}, Case{"derivatives", 1e-3, 4e-2},
                                         Case{"surface_attributes", 1e-5, 1e-4}, Case{"textures", 2e-4, 1e-3}),
                         [](const auto& info) { return std::string(info.param.scene); });

}  // namespace
}  // namespace isoshade::equivalence
