// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/render.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backends/shared.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "compiler/support/memory.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/raster/clip.h"
#include "runtime/render/clock.h"
#include "runtime/render/records.h"
#include "runtime/render/samples.h"

namespace isoshade::render {
namespace {

/// The least memory that the images of a frame take: the targets, and the images that posts keep, beside the arrays
/// that a post reads. Drawing takes more, which only the backend knows.
struct ImageBytes {
  uint64_t all = 0;
  uint64_t shadows = 0;  ///< those of shadow maps
};
ImageBytes image_bytes(const Plan& plan) {
  constexpr uint64_t color = 4 * sizeof(float), depth = sizeof(float);
  const auto pixels = [](int width, int height) {
    return static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  };
  uint64_t sum = 0, shadows = 0;
  for (const backends::View& view : plan.frame.views) {
    const bool is_picture = &view == &plan.frame.picture();
    const int side = is_picture ? samples_each_way(plan.samples) : 1;
    if (!view.target.has_color) shadows += pixels(view.target.width, view.target.height) * depth;
    sum += pixels(view.target.width / side, view.target.height / side) *
           (view.target.has_color ? color + depth : depth);
    if (is_picture && !plan.posts.steps.empty())
      sum += pixels(view.target.width / side, view.target.height / side) * color;
  }
  if (plan.motion) sum += 2 * pixels(plan.motion->now.target.width, plan.motion->now.target.height) * color;
  uint64_t of_posts = 0;
  for (const PostStep& step : plan.posts.steps)
    of_posts = std::max(of_posts, pixels(step.width, step.height) * color);
  return {sum + of_posts, shadows};
}

/// Whether the images fit into memory; otherwise reports what takes most of it.
bool check_images(const Plan& plan, support::Diagnostics& diagnostics) {
  const ImageBytes bytes = image_bytes(plan);
  const backends::Largest& shadow = plan.frame.largest_shadow;
  if (bytes.shadows <= bytes.all / 2 || shadow.what.empty())
    return support::check_memory(bytes.all, "the image", "choose a smaller --size, or fewer posts", diagnostics);
  const std::string what = "the image, of which shadow maps are the largest part,";
  if (support::check_memory(bytes.all, what, std::string(backends::smaller_shadow), diagnostics)) return true;
  if (!diagnostics.full()) {
    support::Diagnostic& report = diagnostics.all().back();
    report.where = shadow.where;
    report.note("the largest is " + shadow.what);
  }
  return false;
}

/// Draws a plan with one backend.
class FrameRenderer {
 public:
  FrameRenderer(const Plan& plan, backends::Backend& backend, DrawStats& stats,
                support::Diagnostics& diagnostics)
      : plan_(plan),
        frame_(plan.frame),
        backend_(backend),
        stats_(stats),
        diagnostics_(diagnostics),
        built_(backend.build_seconds()),
        targets_(plan.frame.views.size()) {}

  bool run(backends::Image& image) {
    for (size_t v = 0; v < frame_.views.size(); ++v) {
      if (!draw_view(v, v + 1 == frame_.views.size() ? image : targets_[v])) return false;
      release_unread(v);
    }
    backends::Image motion;
    if (plan_.motion && !draw_motion(*plan_.motion, motion)) return false;
    if (!run_posts(plan_.posts, sample_steps(), frame_, motion, backend_, image, stats_, diagnostics_)) return false;
    stats_.post_seconds = lap();
    return true;
  }

 private:
  size_t sample_steps() const { return plan_.samples > 1 ? plan_.posts.sample_steps : 0; }

  /// Seconds since the last call, without those that the backend built programs.
  double lap() {
    const double before = std::exchange(built_, backend_.build_seconds());
    stats_.build_seconds += built_ - before;
    return clock_.lap() - (built_ - before);
  }

  /// Runs the vertex programs of the view and makes triangles of their positions.
  bool make_triangles(const backends::ViewPass& pass) {
    std::vector<std::vector<float>> clip;
    if (!backend_.transform(pass, clip, diagnostics_)) return false;
    const std::vector<backends::Draw>& draws = pass.view.draws;
    support::assert_that(clip.size() == draws.size(), "a backend transformed another number of draws");
    stats_.transform_seconds += lap();
    vertices_ = frame_.vertices;
    triangles_.clear();
    for (size_t d = 0; d < draws.size(); ++d) {
      const backends::Draw& draw = draws[d];
      support::assert_that(clip[d].size() == size_t{4} * draw.vertex_count, "a backend left out vertices");
      // Where only depth counts, a blended draw is one that writes it or nothing.
      const backends::Target& target = pass.view.target;
      const bool writes_depth = !draw.blended || draw.state.depth_write == interface::DepthWrite::on;
      if (target.has_color || writes_depth)
        raster::clip_and_snap({clip[d], draw.indices, draw.first_vertex, draw.state, draw.object, draw.mirrored,
                               draw.cutout, draw.blended && target.has_color, pass.view.depth_bias},
                              target.width, target.height, vertices_, triangles_);
      support::release(clip[d]);
    }
    stats_.triangles += static_cast<int64_t>(triangles_.size()) / lower::triangle_word::stride;
    stats_.made_vertices +=
        static_cast<int64_t>(vertices_.size() - frame_.vertices.size()) / lower::vertex_word::stride;
    stats_.clip_seconds += lap();
    return true;
  }

  bool draw_view(size_t v, backends::Image& image) {
    const backends::View& view = frame_.views[v];
    Layers layers(view.target.width, view.target.height);
    for (const size_t read : view.reads) {
      if (read == backends::View::nothing) {
        layers.add_no_target();
        continue;
      }
      support::assert_that(read < v, "a view reads a target that is not drawn yet");
      layers.add_target(frame_.views[read], targets_[read]);
    }
    const backends::ViewPass pass{frame_, view, layers.floats, layers.records};
    if (!make_triangles(pass)) return false;
    const bool is_picture = v + 1 == frame_.views.size();
    ProcessSamples process;
    if (is_picture && sample_steps() > 0)
      process = [&](int first_row, backends::Image& samples) {
        return run_sample_posts(plan_.posts, frame_, first_row, backend_, samples, stats_, diagnostics_);
      };
    if (!draw(pass, is_picture ? plan_.samples : 1, vertices_, triangles_, process, backend_, image, stats_, diagnostics_))
      return false;
    stats_.draw_seconds += lap();
    return true;
  }

  /// Draws the motion with one sample a pixel.
  bool draw_motion(const MotionPlan& motion, backends::Image& image) {
    const backends::View& view = motion.now;
    const auto [width, height] = std::pair(view.target.width, view.target.height);
    const Layers layers(width, height);
    const backends::ViewPass before{frame_, motion.before, layers.floats, layers.records};
    const backends::ViewPass now{frame_, view, layers.floats, layers.records};
    std::vector<std::vector<float>> clip_before, clip;
    if (!backend_.transform(before, clip_before, diagnostics_) || !backend_.transform(now, clip, diagnostics_))
      return false;
    vertices_.clear();
    std::vector<uint32_t> first_vertices;
    for (size_t d = 0; d < view.draws.size(); ++d) {
      first_vertices.push_back(static_cast<uint32_t>(vertices_.size() / lower::vertex_word::stride));
      append_moved(view.draws[d], clip[d], clip_before[d]);
    }
    triangles_.clear();
    for (size_t d = 0; d < view.draws.size(); ++d) {
      const backends::Draw& draw = view.draws[d];
      raster::clip_and_snap({clip[d], draw.indices, first_vertices[d], draw.state, draw.object, draw.mirrored,
                             draw.cutout, false, {}},
                            width, height, vertices_, triangles_);
    }
    backends::Image drawn;
    if (!backend_.draw(now, vertices_, triangles_, drawn, diagnostics_)) return false;
    Layers images(width, height);
    images.add_unread(width, height);
    images.add(drawn.rgba, width, height);
    const backends::ScreenPass pass{.program = motion.complete,
                                    .width = width,
                                    .height = height,
                                    .frame = frame_.frame,
                                    .view = std::span(view.words).first(lower::view_word::camera_words),
                                    .record = motion.backdrop,
                                    .layers = images.floats,
                                    .layer_records = images.records};
    image.resize(width, height);
    return backend_.post(pass, image.rgba, diagnostics_);
  }

  /// Appends the vertices of a draw with how far they have moved, see lower::add_motion_kernel.
  void append_moved(const backends::Draw& draw, std::span<const float> now, std::span<const float> before) {
    namespace word = lower::vertex_word;
    const lanes::FpGuard guard;
    const auto first = frame_.vertices.begin() + static_cast<ptrdiff_t>(draw.first_vertex) * word::stride;
    const size_t begin = vertices_.size();
    vertices_.insert(vertices_.end(), first, first + static_cast<ptrdiff_t>(draw.vertex_count) * word::stride);
    for (size_t i = 0; i < draw.vertex_count; ++i) {
      float change[3];
      bool is_known = true;
      for (size_t c = 0; c < 3; ++c) {
        const size_t from = 4 * i + (c == 2 ? 3 : c);  // x, y, w
        change[c] = now[from] - before[from];
        is_known = is_known && std::isfinite(change[c]);
      }
      for (size_t c = 0; c < 3; ++c)
        vertices_[begin + i * word::stride + word::corner_normals + c] = is_known ? change[c] : 0.0f;
    }
  }

  /// Frees the targets that no view after `v` reads.
  void release_unread(size_t v) {
    for (size_t drawn = 0; drawn <= v; ++drawn) {
      const auto reads_it = [&](const backends::View& view) {
        return std::ranges::find(view.reads, drawn) != view.reads.end();
      };
      if (std::any_of(frame_.views.begin() + static_cast<ptrdiff_t>(v) + 1, frame_.views.end(), reads_it))
        continue;
      support::release(targets_[drawn].rgba);
      support::release(targets_[drawn].depth);
    }
  }

  const Plan& plan_;
  const backends::Frame& frame_;
  backends::Backend& backend_;
  DrawStats& stats_;
  support::Diagnostics& diagnostics_;
  Clock clock_;
  double built_;  ///< Backend::build_seconds() at the last lap
  std::vector<backends::Image>
      targets_;                  ///< of each view but the last, from when it is drawn until it was last read
  std::vector<float> vertices_;  ///< of the view that is drawn: the frame's, and those that clipping made
  std::vector<int32_t> triangles_;
};

}  // namespace

bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics) {
  if (!check_images(plan, diagnostics)) return false;
  stats = {};
  stats.samples = plan.samples;
  return FrameRenderer(plan, backend, stats, diagnostics).run(image);
}

}  // namespace isoshade::render
