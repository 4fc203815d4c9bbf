// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/render.h"

#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/check.h"
#include "compiler/support/release.h"
#include "runtime/raster/clip.h"
#include "runtime/render/clock.h"
#include "runtime/render/samples.h"

namespace isoshade::render {
namespace {

raster::Cull to_raster(backends::Cull cull) {
  switch (cull) {
    case backends::Cull::none: return raster::Cull::none;
    case backends::Cull::back: return raster::Cull::back;
    case backends::Cull::front: return raster::Cull::front;
  }
  return raster::Cull::none;
}

}  // namespace

bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics) {
  const backends::Frame& frame = plan.frame;
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
  support::check(clip.size() == frame.draws.size(), "a backend transformed another number of draws");
  stats.transform_seconds = lap();

  std::vector<float> vertices = frame.vertices;
  std::vector<int32_t> triangles;
  for (size_t d = 0; d < frame.draws.size(); ++d) {
    const backends::Draw& draw = frame.draws[d];
    support::check(clip[d].size() == size_t{4} * draw.vertex_count, "a backend left out vertices");
    raster::clip_and_snap({clip[d], draw.indices, draw.first_vertex, to_raster(draw.cull), draw.object, draw.over},
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
  if (!run_posts(plan.posts, frame.frame, backend, image, stats, diagnostics)) return false;
  stats.post_seconds = lap();
  return true;
}

}  // namespace isoshade::render
