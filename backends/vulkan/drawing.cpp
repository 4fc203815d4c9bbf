// SPDX-License-Identifier: Apache-2.0
// Drawing the parts of a frame.
#include <algorithm>

#include "backends/vulkan/backend.h"
#include "backends/vulkan/device.h"
#include "backends/vulkan/shaders.h"
#include "compiler/driver/driver.h"
#include "compiler/support/assert.h"
#include "runtime/raster/triangle.h"

namespace isoshade::vulkan {

using backends::Frame;
using backends::Window;
using raster::Box;
using support::Diagnostics;

namespace {

/// The pixels of the window that triangles of each program may cover.
std::vector<Box> bounds_of_programs(const Frame& frame, const Window& window,
                                    std::span<const int32_t> triangles) {
  const Box area = raster::box_at(window.x, window.y, window.width, window.height);
  std::vector<Box> bounds(frame.programs.size(), Box{area.x1 + 1, area.y1 + 1, area.x0 - 1, area.y0 - 1});
  const auto count = static_cast<int>(triangles.size() / lower::triangle_word::stride);
  for (int i = 0; i < count; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
    const auto object = static_cast<size_t>(triangle.object());
    const auto program = static_cast<size_t>(frame.objects[object + lower::object_word::program]);
    support::assert_that(program < bounds.size(), "an object has a program that the frame lacks");
    const Box covered = raster::bounds(triangle).within(area);
    if (covered.empty()) continue;
    Box& box = bounds[program];
    box = {std::min(box.x0, covered.x0), std::min(box.y0, covered.y0), std::max(box.x1, covered.x1),
           std::max(box.y1, covered.y1)};
  }
  return bounds;
}

/// Triangles that follow each other under the same depth test.
struct Run {
  uint32_t first, count;
  bool over;
};

std::vector<Run> runs_of(std::span<const int32_t> triangles) {
  std::vector<Run> runs;
  const auto count = static_cast<uint32_t>(triangles.size() / lower::triangle_word::stride);
  for (uint32_t i = 0; i < count; ++i) {
    const bool over = raster::triangle_at(triangles.data(), static_cast<int>(i)).over();
    if (runs.empty() || runs.back().over != over) runs.push_back({i, 0, over});
    ++runs.back().count;
  }
  return runs;
}

Rect rect(const Box& box) { return {box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1}; }

}  // namespace

class VulkanDrawing final : public backends::Drawing {
 public:
  VulkanDrawing(VulkanBackend& backend, const Frame& frame, std::span<const float> vertices)
      : backend_(backend), frame_(frame), vertices_(vertices), shading_(frame.programs.size()) {}

  bool draw(const Window& window, std::span<const int32_t> triangles, backends::Image& image,
            Diagnostics& diagnostics) override {
    return backend_.guarded(diagnostics, [&] {
      if (!backend_.check_size(window.width, window.height, diagnostics)) return false;
      if (!triangles.empty() && !upload(triangles, diagnostics)) return false;
      const Rect area{window.x, window.y, window.width, window.height};
      std::vector<Call> visibility, color;
      for (const Run& run : runs_of(triangles)) {
        const auto pipeline = visibility_pipeline(run.over, diagnostics);
        if (!pipeline) return false;
        visibility.push_back({.pipeline = *pipeline,
                              .push = {.light_count = frame_.light_count},
                              .first_vertex = 3 * run.first,
                              .vertex_count = 3 * run.count,
                              .scissor = area});
      }
      const std::vector<Box> bounds = bounds_of_programs(frame_, window, triangles);
      for (size_t p = 0; p < bounds.size(); ++p) {
        if (bounds[p].empty()) continue;
        if (!shading_[p]) shading_[p] = pixel_pipeline(*frame_.programs[p], diagnostics);
        if (!shading_[p]) return false;
        color.push_back({.pipeline = *shading_[p],
                         .push = {.light_count = frame_.light_count, .program = static_cast<int32_t>(p)},
                         .scissor = rect(bounds[p])});
      }
      image.resize(window.width, window.height);
      backend_.device_->render(visibility, color, frame_.background, area, image);
      return true;
    });
  }

 private:
  /// The triangles; before the first ones all else that is read.
  bool upload(std::span<const int32_t> triangles, Diagnostics& diagnostics) {
    uploaded_ = uploaded_ || (backend_.upload_frame(frame_, vertices_, diagnostics) &&
                              backend_.upload_textures(frame_, diagnostics));
    return uploaded_ && backend_.upload_triangles(frame_, triangles, diagnostics);
  }

  std::optional<PipelineIndex> visibility_pipeline(bool over, Diagnostics& diagnostics) {
    std::optional<PipelineIndex>& pipeline = visibility_[over ? 1 : 0];
    if (!pipeline) {
      pipeline = backend_.device_->pipeline(
          {Target::visibility, 1, triangle_vertex(),
           backend_.options_.glsl(driver::depth_program(), backend_.division_), over},
          diagnostics);
    }
    return pipeline;
  }

  std::optional<PipelineIndex> pixel_pipeline(const driver::Program& program, Diagnostics& diagnostics) {
    auto text = backend_.text_of(program, diagnostics);
    if (!text) return std::nullopt;
    PipelineSource source{Target::color, 1, full_screen_vertex(), std::move(*text)};
    source.what = driver::description(program);
    return backend_.device_->pipeline(source, diagnostics);
  }

  VulkanBackend& backend_;
  const Frame& frame_;
  std::span<const float> vertices_;
  bool uploaded_ = false;
  std::optional<PipelineIndex> visibility_[2];         ///< with the depth test, and without
  std::vector<std::optional<PipelineIndex>> shading_;  ///< of each program of the frame, once one is needed
};

std::unique_ptr<backends::Drawing> VulkanBackend::begin(const Frame& frame, std::span<const float> vertices,
                                                        Diagnostics&) {
  return std::make_unique<VulkanDrawing>(*this, frame, vertices);
}

}  // namespace isoshade::vulkan
