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
#include "runtime/render/layout.h"
#include "runtime/render/records.h"
#include "runtime/render/samples.h"
#include "runtime/render/search.h"
#include "runtime/render/skips.h"

namespace isoshade::render {

using backends::Drawing;
using backends::ImageRead;
using backends::ScreenPass;
using backends::Slot;

namespace {

/// Whether the images fit into memory; otherwise reports what takes most of it.
bool check_images(const Plan& plan, const FrameLayout& layout, support::Diagnostics& diagnostics) {
  const uint64_t bytes = uint64_t{sizeof(float)} * layout.floats;
  const backends::Largest& shadow = plan.frame.largest_shadow;
  if (shadow_bytes(plan) <= bytes / 2 || shadow.what.empty())
    return support::check_memory(bytes, "the image", "choose a smaller --size, or fewer posts", diagnostics);
  const std::string what = "the image, of which shadow maps are the largest part,";
  if (support::check_memory(bytes, what, std::string(backends::smaller_shadow), diagnostics)) return true;
  if (!diagnostics.full()) {
    support::Diagnostic& report = diagnostics.all().back();
    report.where = shadow.where;
    report.note("the largest is " + shadow.what);
  }
  return false;
}

}  // namespace

/// Draws one frame.
class FrameRenderer {
 public:
  FrameRenderer(const Plan& plan, const FrameLayout& layout, Renderer& renderer, DrawStats& stats,
                support::Diagnostics& diagnostics)
      : plan_(plan),
        frame_(plan.frame),
        layout_(layout),
        memory_(renderer),
        backend_(renderer.backend_),
        stats_(stats),
        diagnostics_(diagnostics),
        built_(backend_.build_seconds()) {
    for (size_t s = 0; s < plan.posts.steps.size(); ++s) {
      images_of_step_.push_back(images_of(s));
      records_of_step_.push_back(record_of(s));
    }
  }

  /// Draws the views that are not kept, and what comes behind them. With `search`, looks after each step for pixels that
  /// are not finite; the layout must be that of steps apart, and no view is kept.
  bool run(bool search, const std::vector<bool>& is_kept) {
    const bool keeps = std::ranges::count(is_kept, true) > 0;
    if (!keeps && !backend_.reserve(layout_.floats, diagnostics_)) return false;
    for (size_t v = 0; v < frame_.views.size(); ++v) {
      const std::span<const float> words(frame_.views[v].words);
      backend_.write(layout_.views[v].camera, words.first(lower::view_word::camera_words));
    }
    memory_.vertices_.clear();
    for (size_t v = 0; v < frame_.views.size(); ++v)
      if (!is_kept[v] && !draw_view(v, search)) return false;
    if (plan_.motion && !draw_motion(*plan_.motion)) return false;
    for (const StepGroup& group : layout_.groups) {
      if (!run_posts(group)) return false;
      if (search) search_made(group.first);
    }
    if (search) stats_.non_finite.result = find(image(plan_.posts.result));
    stats_.post_seconds += lap();
    return true;
  }

 private:
  const Slot& image(int number) const { return layout_.images[static_cast<size_t>(number)]; }

  /// Seconds since the last call, without those that the backend built programs.
  double lap() {
    const double before = std::exchange(built_, backend_.build_seconds());
    stats_.build_seconds += built_ - before;
    return clock_.lap() - (built_ - before);
  }

  NonFinite find(const Slot& slot) { return find_non_finite(backend_.read(slot), slot.width); }

  /// The positions of the vertices of a draw, which stand first in the rest.
  static std::span<const float> take_vertices(std::span<const float>& rest, const backends::Draw& draw) {
    const size_t floats = size_t{4} * draw.vertex_count;
    support::assert_that(floats <= rest.size(), "a backend left out vertices");
    const std::span<const float> taken = rest.first(floats);
    rest = rest.subspan(floats);
    return taken;
  }

  /// Runs the vertex programs of the view and makes triangles of their positions.
  bool make_triangles(const backends::ViewPass& pass) {
    if (!backend_.transform(pass, memory_.clip_, diagnostics_)) return false;
    const std::vector<backends::Draw>& draws = pass.view.draws;
    stats_.transform_seconds += lap();
    const size_t given = frame_.vertices.size();
    if (memory_.vertices_.size() < given)
      memory_.vertices_.assign(frame_.vertices.begin(), frame_.vertices.end());
    else
      memory_.vertices_.resize(given);
    std::vector<raster::Surface> surfaces;
    std::span<const float> rest = memory_.clip_;
    const backends::Target& target = pass.view.target;
    for (const backends::Draw& draw : draws) {
      const std::span<const float> clip = take_vertices(rest, draw);
      if (const auto surface = backends::surface_of(pass.view, draw, clip)) surfaces.push_back(*surface);
    }
    support::assert_that(rest.empty(), "a backend transformed another number of vertices");
    memory_.clipper_.run(surfaces, target.width, target.height, backend_.workers(), memory_.vertices_, memory_.triangles_);
    stats_.triangles += static_cast<int64_t>(memory_.triangles_.size()) / lower::triangle_word::stride;
    stats_.made_vertices +=
        static_cast<int64_t>(memory_.vertices_.size() - frame_.vertices.size()) / lower::vertex_word::stride;
    stats_.clip_seconds += lap();
    return true;
  }

  /// The images that the programs of a view read: for each view that it reads, the depth and the color.
  std::vector<ImageRead> images_of(const backends::View& view) const {
    std::vector<ImageRead> images;
    for (const size_t read : view.reads) {
      if (read == backends::View::nothing) {
        images.resize(images.size() + 2);
        continue;
      }
      const auto& [camera, depth, color] = layout_.views[read];
      images.push_back({depth, camera});
      images.push_back(color.exists() ? ImageRead{color, camera} : ImageRead{});
    }
    return images;
  }

  bool draw_view(size_t v, bool search) {
    const backends::View& view = frame_.views[v];
    const std::vector<ImageRead> images = images_of(view);
    const backends::ViewPass pass{frame_, view, images};
    const bool is_picture = v + 1 == frame_.views.size();
    std::vector<ScreenPass> posts;
    if (is_picture)
      for (size_t s = 0; s < layout_.drawn_steps; ++s) posts.push_back(pass_of(s));
    Drawing drawing{.pass = pass,
                    .vertices = {},
                    .triangles = {},
                    .window = {0, 0, view.target.width, view.target.height},
                    .side = is_picture ? samples_each_way(plan_.samples) : 1,
                    .posts = {},
                    .depth = layout_.views[v].depth,
                    .color = layout_.views[v].color,
                    .skips_tiles = plan_.skips.has(interface::Skip::tiles)};
    if (!search) {
      drawing.posts = posts;
      backends::Made made;
      if (const std::optional<bool> drawn = backend_.draw_view(drawing, made, diagnostics_)) {
        stats_.triangles += made.triangles;
        stats_.made_vertices += made.vertices;
        stats_.draw_seconds += lap();
        return *drawn;
      }
      drawing.posts = {};
    }
    if (!make_triangles(pass)) return false;
    drawing.vertices = memory_.vertices_;
    drawing.triangles = memory_.triangles_;
    if (is_picture && search && !search_drawn(drawing, posts)) return false;
    drawing.posts = posts;
    if (!backend_.draw(drawing, diagnostics_)) return false;
    stats_.draw_seconds += lap();
    return true;
  }

  /// The images that a step reads.
  std::vector<ImageRead> images_of(size_t s) const {
    const PostStep& step = plan_.posts.steps[s];
    const backends::Target& target = frame_.picture().target;
    const int side = samples_each_way(plan_.samples);
    const bool over_samples = s < layout_.drawn_steps;
    ImageRead depth{layout_.views.back().depth};
    if (!step.post->reads_depth) depth.slot.channels = 0;
    std::vector<ImageRead> images{depth};
    for (const int source : step.sources) {
      if (source == PostStep::not_read)
        images.emplace_back();
      else
        images.push_back({source == PostStep::motion ? layout_.motion : image(source)});
    }
    if (over_samples) {
      for (size_t i = 0; i < 2; ++i)
        images[i].slot.width = target.width, images[i].slot.height = target.height;
    } else {
      images[0].slot.width = target.width / side, images[0].slot.height = target.height / side;
    }
    return images;
  }

  /// The pass of a step over its whole image, or over the samples of the picture.
  ScreenPass pass_of(size_t s) const {
    const PostStep& step = plan_.posts.steps[s];
    const bool over_samples = s < layout_.drawn_steps;
    const backends::Target& target = frame_.picture().target;
    return {.program = &step.post->program,
            .width = over_samples ? target.width : step.width,
            .height = over_samples ? target.height : step.height,
            .frame = frame_.frame,
            .view = std::span(frame_.picture().words).first(lower::view_word::camera_words),
            .record = s < records_of_step_.size() ? std::span<const float>(records_of_step_[s]) : std::span<const float>(),
            .images = images_of_step_[s],
            .textures = step.post->environment.any ? &frame_ : nullptr,
            .keeps_background_plain = step.post->keeps_background_plain};
  }

  std::vector<float> record_of(size_t s) {
    const PostStep& step = plan_.posts.steps[s];
    std::vector<float> record = step.record;
    const std::shared_ptr<const passes::DrawValues>& values = step.post->program.draw;
    if (values == nullptr) return record;
    record.resize(values->first + values->words);
    const ScreenPass pass = pass_of(s);
    const std::vector<int32_t> images = backends::image_records(pass.width, pass.height, pass.images);
    DrawEvaluator& evaluator = memory_.evaluator_;
    evaluator.bind(lower::FrameBuffer::frame, pass.frame);
    evaluator.bind(lower::FrameBuffer::view, pass.view);
    evaluator.bind(lower::FrameBuffer::textures, frame_.textures);
    evaluator.bind(lower::FrameBuffer::layer_records, images);
    evaluator.fill(values, record);
    return record;
  }

  bool run_posts(const StepGroup& group) {
    std::vector<ScreenPass> passes;
    for (size_t s = group.first; s < group.first + group.count; ++s) passes.push_back(pass_of(s));
    return backend_.post(passes, layout_.images[group.first + group.count], diagnostics_);
  }

  /// Draws the motion with one sample a pixel.
  bool draw_motion(const MotionPlan& motion) {
    const backends::View& view = motion.now;
    const auto [width, height] = std::pair(view.target.width, view.target.height);
    const backends::ViewPass before{frame_, motion.before}, now{frame_, view};
    support::Array<float>&clip = memory_.clip_, &clip_before = memory_.clip_before_;
    if (!backend_.transform(before, clip_before, diagnostics_) || !backend_.transform(now, clip, diagnostics_))
      return false;
    support::Array<float>& vertices = memory_.vertices_;
    vertices.clear();
    std::vector<raster::Surface> surfaces;
    std::span<const float> rest = clip, rest_before = clip_before;
    for (const backends::Draw& draw : view.draws) {
      const std::span<const float> positions = take_vertices(rest, draw);
      const auto first_vertex = static_cast<uint32_t>(vertices.size() / lower::vertex_word::stride);
      append_moved(draw, positions, take_vertices(rest_before, draw));
      surfaces.push_back({positions, draw.indices, first_vertex, draw.state, draw.object, draw.mirrored, draw.cutout,
                          false, {}});
    }
    memory_.clipper_.run(surfaces, width, height, backend_.workers(), vertices, memory_.triangles_);
    const auto& drawn = layout_.drawn_motion;
    if (!backend_.draw({.pass = now,
                        .vertices = vertices,
                        .has_other_vertices = true,
                        .triangles = memory_.triangles_,
                        .window = {0, 0, width, height},
                        .depth = drawn.depth,
                        .color = drawn.color,
                        .skips_tiles = plan_.skips.has(interface::Skip::tiles)},
                       diagnostics_))
      return false;
    const ImageRead images[] = {{Slot{0, width, height, 0}}, {drawn.color}};
    const ScreenPass complete{.program = motion.complete,
                              .width = width,
                              .height = height,
                              .frame = frame_.frame,
                              .view = std::span(view.words).first(lower::view_word::camera_words),
                              .record = motion.backdrop,
                              .images = images};
    return backend_.post({&complete, 1}, layout_.motion, diagnostics_);
  }

  /// Appends the vertices of a draw with how far they have moved, see lower::add_motion_kernel.
  void append_moved(const backends::Draw& draw, std::span<const float> now, std::span<const float> before) {
    namespace word = lower::vertex_word;
    const lanes::FpGuard guard;
    const auto first = frame_.vertices.begin() + static_cast<ptrdiff_t>(draw.first_vertex) * word::stride;
    const size_t begin = memory_.vertices_.size();
    memory_.vertices_.insert(memory_.vertices_.end(), first, first + static_cast<ptrdiff_t>(draw.vertex_count) * word::stride);
    for (size_t i = 0; i < draw.vertex_count; ++i) {
      float change[3];
      bool is_known = true;
      for (size_t c = 0; c < 3; ++c) {
        const size_t from = 4 * i + (c == 2 ? 3 : c);  // x, y, w
        change[c] = now[from] - before[from];
        is_known = is_known && std::isfinite(change[c]);
      }
      for (size_t c = 0; c < 3; ++c)
        memory_.vertices_[begin + i * word::stride + word::corner_normals + c] = is_known ? change[c] : 0.0f;
    }
  }

  /// Draws the picture with more and more of the posts that run over its samples, and looks for what made the first pixel
  /// that is not finite.
  bool search_drawn(Drawing drawing, std::span<const ScreenPass> posts) {
    NonFiniteReport& report = stats_.non_finite;
    bool was_finite = true;
    for (size_t count = 0; count <= posts.size(); ++count) {
      drawing.posts = posts.first(count);
      if (!backend_.draw(drawing, diagnostics_)) return false;
      const NonFinite made = find(drawing.color);
      if (count == 0) report.drawn = made;
      if (count > 0 && was_finite && made.count > 0) report.posts.push_back({plan_.posts.steps[count - 1].post_number, made});
      was_finite = made.count == 0;
      finite_.push_back(was_finite);
    }
    drawing.posts = {};
    return report.drawn.count == 0 || find_object(backend_, drawing, layout_.probe, report, diagnostics_);
  }

  /// Notes pixels of a step's image that are not finite if the step made them so.
  void search_made(size_t s) {
    const PostStep& step = plan_.posts.steps[s];
    const NonFinite made = find(layout_.images[s + 1]);
    const bool read_finite = std::ranges::all_of(
        step.sources, [&](int source) { return source < 0 || finite_[static_cast<size_t>(source)]; });
    finite_.push_back(made.count == 0);
    if (made.count > 0 && read_finite) stats_.non_finite.posts.push_back({step.post_number, made});
  }

  const Plan& plan_;
  const backends::Frame& frame_;
  const FrameLayout& layout_;
  Renderer& memory_;
  backends::Backend& backend_;
  DrawStats& stats_;
  support::Diagnostics& diagnostics_;
  Clock clock_;
  double built_;  ///< Backend::build_seconds() at the last lap
  std::vector<std::vector<ImageRead>> images_of_step_;
  std::vector<std::vector<float>> records_of_step_;  ///< with what is the same for all pixels of the step
  std::vector<bool> finite_;  ///< of each image of the chain, in a search
};

bool Renderer::draw(const Plan& plan, DrawStats& stats, support::Diagnostics& diagnostics) {
  const FrameLayout layout(plan);
  if (!check_images(plan, layout, diagnostics)) return false;
  stats = {};
  stats.samples = plan.samples;
  stats.fused_posts = static_cast<int64_t>(layout.fused());
  stats.kept_images = plan.posts.steps.empty() ? 0 : static_cast<int64_t>(layout.most_images);
  const std::vector<backends::DeviceStep> device_before = backend_.device_steps();
  const backends::TileCounts tiles_before = backend_.tile_counts();
  const FrameLayout* used = &layout;
  std::optional<FrameLayout> apart;
  const bool may_keep = plan.skips.has(interface::Skip::frames) && backend_.drawer() == this;
  const std::vector<bool> is_kept = may_keep ? drawn_.views_of(plan, layout) : std::vector<bool>(plan.frame.views.size());
  stats.views = static_cast<int64_t>(plan.frame.views.size());
  stats.kept_views = std::ranges::count(is_kept, true);
  stats.is_kept = stats.kept_views == stats.views && drawn_.has_posts_of(plan, layout);
  if (stats.is_kept) {
    stats.device = device_before;
    for (backends::DeviceStep& step : stats.device) step.seconds = 0;
    return true;
  }
  drawn_ = {};
  backend_.set_drawer(this);
  if (!FrameRenderer(plan, layout, *this, stats, diagnostics).run(false, is_kept)) return false;
  stats.device = backend_.device_steps();
  for (size_t i = 0; i < stats.device.size(); ++i) stats.device[i].seconds -= device_before[i].seconds;
  stats.tiles = backend_.tile_counts();
  stats.tiles -= tiles_before;
  report_tiles(stats.tiles, stats.skips);
  if (!backend_.is_finite()) {
    used = &apart.emplace(plan, true);
    DrawStats searched;
    if (!check_images(plan, *used, diagnostics) ||
        !FrameRenderer(plan, *used, *this, searched, diagnostics).run(true, std::vector<bool>(plan.frame.views.size())))
      return false;
    stats.non_finite = std::move(searched.non_finite);
  } else {
    drawn_ = DrawnFrame(plan, layout);
  }
  color_ = used->images[static_cast<size_t>(plan.posts.result)];
  depth_ = used->views.back().depth;
  return true;
}

scene::ImageView Renderer::image() {
  return {color_.width, color_.height, backend_.read(color_), backend_.read(depth_)};
}

bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics) {
  Renderer renderer(backend);
  if (!renderer.draw(plan, stats, diagnostics)) return false;
  const scene::ImageView drawn = renderer.image();
  image.width = drawn.width;
  image.height = drawn.height;
  image.rgba.assign(drawn.rgba.begin(), drawn.rgba.end());
  image.depth.assign(drawn.depth.begin(), drawn.depth.end());
  return true;
}

}  // namespace isoshade::render
