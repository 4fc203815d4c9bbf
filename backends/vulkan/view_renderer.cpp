// SPDX-License-Identifier: Apache-2.0
// Drawing the windows of a view.
#include <algorithm>
#include <map>
#include <tuple>

#include "backends/shared.h"
#include "backends/vulkan/backend.h"
#include "backends/vulkan/device.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/target_limits.h"
#include "runtime/raster/triangle.h"

namespace isoshade::vulkan {

using backends::Frame;
using backends::ViewPass;
using raster::Box;
using support::Diagnostics;

namespace {

/// For each program, the bounds of its triangles in the window.
std::vector<Box> bounds_of_programs(const Frame& frame, const Window& window,
                                    std::span<const int32_t> triangles) {
  const Box area = raster::box_at(window.x, window.y, window.width, window.height);
  std::vector<Box> bounds(frame.programs.size(), Box{area.x1 + 1, area.y1 + 1, area.x0 - 1, area.y0 - 1});
  const auto count = static_cast<int>(triangles.size() / lower::triangle_word::stride);
  for (int i = 0; i < count; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
    const Box covered = raster::bounds(triangle).within(area);
    if (covered.empty()) continue;
    Box& box = bounds[backends::pixel_program_of(frame, triangle.object())];
    box = {std::min(box.x0, covered.x0), std::min(box.y0, covered.y0), std::max(box.x1, covered.x1),
           std::max(box.y1, covered.y1)};
  }
  return bounds;
}

/// Consecutive triangles with the same depth test and the same cut-out.
struct Run {
  uint32_t first, count;
  bool over;
  const driver::Program* cutout;  ///< or null
};

/// Of the triangles [begin, end).
std::vector<Run> runs_of(const Frame& frame, std::span<const int32_t> triangles, uint32_t begin, uint32_t end) {
  std::vector<Run> runs;
  for (uint32_t i = begin; i < end; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), static_cast<int>(i));
    const driver::Program* const cutout =
        triangle.cutout() ? frame.programs[backends::cutout_program_of(frame, triangle.object())] : nullptr;
    if (runs.empty() || runs.back().over != triangle.over() || runs.back().cutout != cutout)
      runs.push_back({i, 0, triangle.over(), cutout});
    ++runs.back().count;
  }
  return runs;
}

Window window_of(const Box& box) { return {box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1}; }

}  // namespace

class VulkanViewRenderer final : public backends::ViewRenderer {
 public:
  VulkanViewRenderer(VulkanBackend& backend, const ViewPass& pass, std::span<const float> vertices)
      : backend_(backend), pass_(pass), vertices_(vertices), shading_(pass.frame.programs.size()) {}

  bool draw(const Window& window, std::span<const int32_t> triangles, backends::Image& image,
            Diagnostics& diagnostics) override {
    return backend_.guarded(diagnostics, [&] {
      const bool has_color = pass_.view.target.has_color;
      const int light_count = pass_.frame.light_count;
      if (!backend_.check_size(window.width, window.height, diagnostics)) return false;
      if (!triangles.empty() && !upload(triangles, diagnostics)) return false;
      const auto count = static_cast<uint32_t>(triangles.size() / lower::triangle_word::stride);
      const auto opaque = static_cast<uint32_t>(raster::opaque_count(triangles.data(), static_cast<int>(count)));
      Calls calls{light_count, window};
      if (!add_visibility(triangles, 0, opaque, false, calls, diagnostics)) return false;
      calls.layers.first = opaque;
      calls.layers.count = count - opaque;
      if (opaque < count && !add_visibility(triangles, opaque, count, true, calls, diagnostics)) return false;
      if (opaque < count && !add_keeping(calls, diagnostics)) return false;
      std::vector<Box> bounds;
      if (has_color) bounds = bounds_of_programs(pass_.frame, window, triangles);
      for (size_t p = 0; p < bounds.size(); ++p) {
        if (bounds[p].empty()) continue;
        const driver::Program& program = *pass_.frame.programs[p];
        if (!shading_[p]) shading_[p] = pixel_pipeline(program, diagnostics);
        if (!shading_[p]) return false;
        std::vector<Call>& to = program.stage == driver::Stage::blend ? calls.layers.blending : calls.color;
        to.push_back({.pipeline = *shading_[p],
                      .push = {.light_count = light_count, .program = static_cast<int32_t>(p)},
                      .scissor = window_of(bounds[p])});
      }
      image.resize(window.width, window.height, has_color);
      backend_.device_->render(calls.visibility, calls.color, calls.layers, pass_.view.background, window, image);
      return true;
    });
  }

 private:
  /// What draws a window.
  struct Calls {
    int light_count;
    Window window;
    std::vector<Call> visibility = {}, color = {};
    Layers layers = {};
  };

  /// Adds what finds where the triangles [begin, end) are seen.
  bool add_visibility(std::span<const int32_t> triangles, uint32_t begin, uint32_t end, bool in_layers, Calls& calls,
                      Diagnostics& diagnostics) {
    for (const Run& run : runs_of(pass_.frame, triangles, begin, end)) {
      const auto pipeline = visibility_pipeline(run, in_layers, diagnostics);
      if (!pipeline) return false;
      (in_layers ? calls.layers.visibility : calls.visibility)
          .push_back({.pipeline = *pipeline,
                      .push = {.light_count = calls.light_count},
                      .first_vertex = 3 * run.first,
                      .vertex_count = 3 * run.count,
                      .scissor = calls.window});
    }
    return true;
  }

  /// Adds what keeps the pixels that a layer leaves as they were.
  bool add_keeping(Calls& calls, Diagnostics& diagnostics) {
    const auto pipeline =
        backend_.device_->pipeline({Output::layer, 2, full_screen_vertex(), keep_fragment()}, diagnostics);
    if (pipeline) calls.layers.blending.push_back({.pipeline = *pipeline, .scissor = calls.window});
    return pipeline.has_value();
  }

  /// Uploads the triangles; the first time, also everything that cut-outs and pixel programs read.
  bool upload(std::span<const int32_t> triangles, Diagnostics& diagnostics) {
    uploaded_ = uploaded_ || (!pass_.view.target.has_color && pass_.frame.cutouts.empty()) ||
                (backend_.upload(pass_, vertices_, diagnostics) &&
                 backend_.upload_textures(pass_.frame, diagnostics));
    return uploaded_ && backend_.upload_triangles(pass_.frame, triangles, diagnostics);
  }

  /// In layers the shader itself makes the depth test.
  std::optional<PipelineIndex> visibility_pipeline(const Run& run, bool in_layers, Diagnostics& diagnostics) {
    std::optional<PipelineIndex>& pipeline = visibility_[{run.cutout, run.over && !in_layers, in_layers}];
    if (pipeline) return pipeline;
    PipelineSource source{Output::visibility, 1, triangle_vertex(), {}, run.over && !in_layers};
    const driver::Program& program = run.cutout != nullptr ? *run.cutout : driver::depth_program();
    if (run.cutout != nullptr) {
      if (!driver::within_limits(program, driver::Target::vulkan, backend_.division_, diagnostics)) return std::nullopt;
      source.what = driver::description(program);
    }
    source.fragment_glsl = in_layers ? driver::glsl_of_layer(program, backend_.division_)
                                     : backend_.options_.glsl(program, backend_.division_);
    return pipeline = backend_.device_->pipeline(source, diagnostics);
  }

  std::optional<PipelineIndex> pixel_pipeline(const driver::Program& program, Diagnostics& diagnostics) {
    auto text = backend_.text_of(program, diagnostics);
    if (!text) return std::nullopt;
    const bool blends = program.stage == driver::Stage::blend;
    PipelineSource source{blends ? Output::layer : Output::color, blends ? 2u : 1u, full_screen_vertex(),
                          std::move(*text)};
    source.what = driver::description(program);
    return backend_.device_->pipeline(source, diagnostics);
  }

  VulkanBackend& backend_;
  const ViewPass pass_;
  std::span<const float> vertices_;
  bool uploaded_ = false;
  /// By the program of the cut-out, or null, whether the depth test always passes, and whether it draws layers.
  std::map<std::tuple<const driver::Program*, bool, bool>, std::optional<PipelineIndex>> visibility_;
  std::vector<std::optional<PipelineIndex>>
      shading_;  ///< one for each program of the frame, made when needed
};

std::unique_ptr<backends::ViewRenderer> VulkanBackend::begin(const ViewPass& pass,
                                                             std::span<const float> vertices, Diagnostics&) {
  return std::make_unique<VulkanViewRenderer>(*this, pass, vertices);
}

}  // namespace isoshade::vulkan
