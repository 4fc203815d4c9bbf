// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/render.h"

#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "compiler/support/memory.h"
#include "compiler/support/release.h"
#include "runtime/raster/clip.h"
#include "runtime/render/clock.h"
#include "runtime/render/samples.h"

namespace isoshade::render {
namespace {

/// What the images of a frame take at the least: those that are drawn and the ones that posts keep, beside the arrays
/// that a post reads. The drawing itself takes more, which only the backend knows.
uint64_t image_bytes(const Plan& plan) {
  constexpr uint64_t color = 4 * sizeof(float), depth = sizeof(float);
  const auto each_way = static_cast<uint64_t>(samples_each_way(plan.samples));
  const uint64_t pixels = static_cast<uint64_t>(plan.frame.width) * static_cast<uint64_t>(plan.frame.height) /
                          (each_way * each_way);
  uint64_t of_posts = 0;
  for (const PostStep& step : plan.posts.steps)
    of_posts =
        std::max(of_posts, static_cast<uint64_t>(step.width) * static_cast<uint64_t>(step.height) * color);
  return pixels * (color + depth) + (plan.posts.steps.empty() ? 0 : of_posts + pixels * color);
}

}  // namespace

bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics) {
  const backends::Frame& frame = plan.frame;
  if (!support::check_memory(image_bytes(plan), "the image", "choose a smaller --size, or fewer posts",
                             diagnostics))
    return false;
  Clock clock;
  double built = backend.build_seconds();
  stats.build_seconds = 0;
  const auto lap = [&] {
    const double before = std::exchange(built, backend.build_seconds());
    stats.build_seconds += built - before;
    return clock.lap() - (built - before);
  };
  std::vector<std::vector<float>> clip;
  if (!backend.transform(frame, clip, diagnostics)) return false;
  support::assert_that(clip.size() == frame.draws.size(), "a backend transformed another number of draws");
  stats.transform_seconds = lap();

  std::vector<float> vertices = frame.vertices;
  std::vector<int32_t> triangles;
  for (size_t d = 0; d < frame.draws.size(); ++d) {
    const backends::Draw& draw = frame.draws[d];
    support::assert_that(clip[d].size() == size_t{4} * draw.vertex_count, "a backend left out vertices");
    raster::clip_and_snap({clip[d], draw.indices, draw.first_vertex, draw.state, draw.object},
                          frame.width, frame.height, vertices, triangles);
    support::release(clip[d]);
  }
  stats.triangles = static_cast<int64_t>(triangles.size()) / lower::triangle_word::stride;
  stats.made_vertices =
      static_cast<int64_t>(vertices.size() - frame.vertices.size()) / lower::vertex_word::stride;
  stats.clip_seconds = lap();

  stats.samples = plan.samples;
  if (!draw(frame, plan.samples, vertices, triangles, backend, image, stats, diagnostics)) return false;
  stats.draw_seconds = lap();
  if (!run_posts(plan.posts, frame, backend, image, stats, diagnostics)) return false;
  stats.post_seconds = lap();
  return true;
}

}  // namespace isoshade::render
