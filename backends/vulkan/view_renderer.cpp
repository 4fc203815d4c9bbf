// SPDX-License-Identifier: Apache-2.0
// Drawing the windows of a view.
#include <algorithm>
#include <map>
#include <tuple>

#include "backends/shared.h"
#include "backends/vulkan/backend.h"
#include "backends/vulkan/device.h"
#include "backends/vulkan/geometry.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/target_limits.h"
#include "compiler/targets/glsl/stages.h"
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

/// Of the triangles [begin, end).
std::vector<Run> runs_of(const Frame& frame, std::span<const int32_t> triangles, uint32_t begin, uint32_t end) {
  std::vector<Run> runs;
  for (uint32_t i = begin; i < end; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), static_cast<int>(i));
    const driver::Program* const cutout =
        triangle.cutout() ? frame.programs[backends::cutout_program_of(frame, triangle.object())] : nullptr;
    append(runs, {i, 1, triangle.over(), cutout});
  }
  return runs;
}

Box united(const Box& a, const Box& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}
int64_t area_of(const Box& box) { return int64_t{box.x1 - box.x0 + 1} * (box.y1 - box.y0 + 1); }

/// Triangles that are blended and drawn layer by layer at once.
struct BlendedGroup {
  uint32_t begin, end;  ///< their numbers
  Box box;              ///< where they lie
  bool writes_depth;
  std::map<size_t, Box> programs = {};  ///< and where those of each program lie
  std::vector<Box> objects = {};
};

/// The triangles [begin, end) in groups: objects that lie side by side are drawn at once, because each layer of a group
/// costs as much as its box is large.
std::vector<BlendedGroup> groups_of(const Frame& frame, const Window& window, std::span<const int32_t> triangles,
                                    uint32_t begin, uint32_t end) {
  constexpr size_t most_objects = 64;
  const Box area = raster::box_at(window.x, window.y, window.width, window.height);
  std::vector<BlendedGroup> groups;
  while (begin < end) {
    const raster::Triangle first = raster::triangle_at(triangles.data(), static_cast<int>(begin));
    Box box{area.x1 + 1, area.y1 + 1, area.x0 - 1, area.y0 - 1};
    uint32_t next = begin;
    for (; next < end; ++next) {
      const raster::Triangle triangle = raster::triangle_at(triangles.data(), static_cast<int>(next));
      if (triangle.object() != first.object()) break;
      if (const Box covered = raster::bounds(triangle).within(area); !covered.empty()) box = united(box, covered);
    }
    if (!box.empty()) {
      const bool writes_depth = !first.keeps_depth();
      const auto fits = [&](const BlendedGroup& group) {
        int64_t areas = area_of(box);
        for (const Box& other : group.objects) areas += area_of(other);
        const auto touches = [&](const Box& other) { return !box.within(other).empty(); };
        return group.writes_depth == writes_depth && group.end == begin && group.objects.size() < most_objects &&
               area_of(united(group.box, box)) <= 4 * areas && std::ranges::none_of(group.objects, touches);
      };
      if (groups.empty() || !fits(groups.back())) groups.push_back({begin, next, box, writes_depth});
      BlendedGroup& group = groups.back();
      group.end = next;
      group.box = united(group.box, box);
      group.objects.push_back(box);
      Box& of_program = group.programs.try_emplace(backends::pixel_program_of(frame, first.object()), box).first->second;
      of_program = united(of_program, box);
    }
    begin = next;
  }
  return groups;
}

Window window_of(const Box& box) { return {box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1}; }

}  // namespace

class VulkanViewRenderer final : public backends::ViewRenderer {
 public:
  VulkanViewRenderer(VulkanBackend& backend, const ViewPass& pass, const backends::Layers& layers,
                     std::span<const float> vertices, bool knows_vertices)
      : backend_(backend), pass_(pass), layers_(layers), vertices_(vertices), knows_vertices_(knows_vertices),
        shading_(pass.frame.programs.size()) {}

  bool draw(const Window& window, std::span<const int32_t> triangles, backends::Image& image,
            Diagnostics& diagnostics) override {
    return backend_.guarded(diagnostics, [&] {
      Calls calls;
      if (!prepare(window, triangles, calls, diagnostics)) return false;
      image.resize(window.width, window.height, pass_.view.target.has_color);
      backend_.device_->render(calls.visibility, calls.color, calls.layers, pass_.view.background, window, image);
      return true;
    });
  }

  /// Draws triangles whose records the device has, to the array `layers`, by compute shaders. Returns whether the color is
  /// finite; nothing if there are too many large triangles, or after an error.
  std::optional<bool> draw(const Window& window, const DeviceTriangles& triangles, const Device::Places& places,
                           Diagnostics& diagnostics) {
    const bool has_color = pass_.view.target.has_color;
    if (!backend_.check_size(window.width, window.height, diagnostics) ||
        !backend_.device_->prepare_own_shaders(diagnostics) ||
        !backend_.upload_textures(pass_.frame, diagnostics))
      return std::nullopt;
    Device::Computed calls;
    const auto add_runs = [&](std::span<const Run> runs, std::vector<Call>& added) {
      for (const Run& run : runs) {
        const driver::Program& program = run.cutout != nullptr ? *run.cutout : driver::depth_program();
        const auto pipeline = computed(program, Output::row, diagnostics);
        if (!pipeline) return false;
        added.push_back({.pipeline = *pipeline,
                         .push = {.object = static_cast<int32_t>(triangles.first_order)},
                         .first_vertex = run.first,
                         .vertex_count = run.count});
      }
      return true;
    };
    const auto add_programs = [&](std::span<const size_t> programs, std::vector<Call>& added) {
      for (const size_t p : programs) {
        const auto pipeline = computed(*pass_.frame.programs[p], Output::pixels, diagnostics);
        if (!pipeline) return false;
        added.push_back({.pipeline = *pipeline,
                         .push = {.light_count = pass_.frame.light_count, .program = static_cast<int32_t>(p)},
                         .scissor = window});
      }
      return true;
    };
    if (!add_runs(triangles.opaque, calls.visibility) || !add_runs(triangles.blended, calls.layers))
      return std::nullopt;
    if (has_color && (!add_programs(triangles.programs, calls.color) ||
                      !add_programs(triangles.blending, calls.blending)))
      return std::nullopt;
    calls.blended = triangles.blended_count;
    calls.first_cut = triangles.first_cut;
    return backend_.device_->compute(calls, pass_.view.background, window, has_color, places);
  }

  /// Draws to the array `layers`. `is_finite` tells whether the color is finite.
  bool draw(const Window& window, std::span<const int32_t> triangles, const Device::Places& places, bool& is_finite,
            Diagnostics& diagnostics) {
    return backend_.guarded(diagnostics, [&] {
      Calls calls;
      if (!prepare(window, triangles, calls, diagnostics) ||
          !backend_.device_->prepare_own_shaders(diagnostics))
        return false;
      is_finite = backend_.device_->render(calls.visibility, calls.color, calls.layers, pass_.view.background, window,
                                           pass_.view.target.has_color, places);
      return true;
    });
  }

 private:
  static constexpr size_t stride = lower::triangle_word::stride;

  std::optional<PipelineIndex> computed(const driver::Program& program, Output output, Diagnostics& diagnostics) {
    return backend_.pipeline_of(program, VulkanBackend::Use::computed, [&]() -> std::optional<PipelineIndex> {
      auto text = backend_.text_of(program, diagnostics, true);
      if (!text) return std::nullopt;
      PipelineSource source{output, 0, std::move(*text), {}};
      source.what = driver::description(program);
      return backend_.device_->pipeline(source, diagnostics);
    });
  }

  struct Calls {
    std::vector<Call> visibility, color;
    Layers layers;
  };
  bool prepare(const Window& window, std::span<const int32_t> triangles, Calls& calls, Diagnostics& diagnostics) {
    const bool has_color = pass_.view.target.has_color;
    if (!backend_.check_size(window.width, window.height, diagnostics)) return false;
    if (!triangles.empty() && !upload(triangles, diagnostics)) return false;
    const auto count = static_cast<uint32_t>(triangles.size() / lower::triangle_word::stride);
    const auto opaque = static_cast<uint32_t>(raster::opaque_count(triangles.data(), static_cast<int>(count)));
    if (!add_visibility(triangles, {0, opaque, window}, false, calls.visibility, diagnostics)) return false;
    std::vector<Box> bounds;
    if (has_color) bounds = bounds_of_programs(pass_.frame, window, triangles.first(opaque * stride));
    for (size_t p = 0; p < bounds.size(); ++p) {
      if (bounds[p].empty()) continue;
      if (!add_shading(p, window_of(bounds[p]), calls, diagnostics)) return false;
    }
    return opaque == count || add_layers(window, triangles, opaque, count, calls.layers, diagnostics);
  }

  bool add_shading(size_t program, const Window& area, Calls& calls, Diagnostics& diagnostics) {
    std::optional<PipelineIndex>& pipeline = shading_[program];
    if (!pipeline) pipeline = backend_.screen_pipeline(*pass_.frame.programs[program], false, diagnostics);
    if (!pipeline) return false;
    calls.color.push_back(
        {.pipeline = *pipeline,
         .push = {.light_count = pass_.frame.light_count, .program = static_cast<int32_t>(program)},
         .scissor = area});
    return true;
  }

  struct Range {
    uint32_t begin, end;  ///< numbers of triangles
    Window area;
  };
  /// Adds what finds where triangles are seen.
  bool add_visibility(std::span<const int32_t> triangles, const Range& range, bool in_layers, std::vector<Call>& calls,
                      Diagnostics& diagnostics) {
    return add_visibility(runs_of(pass_.frame, triangles, range.begin, range.end), range.area, in_layers,
                          calls, diagnostics);
  }
  bool add_visibility(std::span<const Run> runs, const Window& area, bool in_layers, std::vector<Call>& calls,
                      Diagnostics& diagnostics) {
    for (const Run& run : runs) {
      const auto pipeline = visibility_pipeline(run, in_layers, diagnostics);
      if (!pipeline) return false;
      calls.push_back({.pipeline = *pipeline,
                       .push = {.light_count = pass_.frame.light_count},
                       .first_vertex = 3 * run.first,
                       .vertex_count = 3 * run.count,
                       .scissor = area});
    }
    return true;
  }

  /// Adds what blends the triangles [begin, end).
  bool add_layers(const Window& window, std::span<const int32_t> triangles, uint32_t begin, uint32_t end,
                  Layers& layers, Diagnostics& diagnostics) {
    for (const BlendedGroup& group : groups_of(pass_.frame, window, triangles, begin, end)) {
      LayerGroup& made = layers.groups.emplace_back();
      made.first = group.begin;
      made.count = group.end - group.begin;
      made.area = window_of(group.box);
      made.writes_depth = group.writes_depth;
      if (!add_visibility(triangles, {group.begin, group.end, made.area}, true, made.visibility, diagnostics))
        return false;
      for (const auto& [p, box] : group.programs) {
        std::optional<PipelineIndex>& pipeline = blending_[{p, group.writes_depth}];
        if (!pipeline) pipeline = blend_pipeline(*pass_.frame.programs[p], group.writes_depth, diagnostics);
        if (!pipeline) return false;
        made.blending.push_back(
            {.pipeline = *pipeline,
             .push = {.light_count = pass_.frame.light_count, .program = static_cast<int32_t>(p)},
             .scissor = window_of(box)});
      }
      if (!group.writes_depth || layers.copy_depth) continue;
      const auto copy = backend_.device_->pipeline(
          {Output::depth_copy, 1, full_screen_vertex(), depth_copy_fragment()}, diagnostics);
      if (!copy) return false;
      layers.copy_depth = Call{.pipeline = *copy, .scissor = window};
    }
    return true;
  }

  /// Uploads the triangles; the first time, also everything that cut-outs and pixel programs read.
  bool upload(std::span<const int32_t> triangles, Diagnostics& diagnostics) {
    uploaded_ = uploaded_ || (!pass_.view.target.has_color && pass_.frame.cutouts.empty()) ||
                (backend_.upload(pass_, layers_, vertices_, knows_vertices_, diagnostics) &&
                 backend_.upload_textures(pass_.frame, diagnostics));
    return uploaded_ && backend_.upload_triangles(pass_.frame, triangles, diagnostics);
  }

  /// In layers the shader itself makes the depth test.
  std::optional<PipelineIndex> visibility_pipeline(const Run& run, bool in_layers, Diagnostics& diagnostics) {
    std::optional<PipelineIndex>& pipeline = visibility_[{run.cutout, run.over && !in_layers, in_layers}];
    if (pipeline) return pipeline;
    using Use = VulkanBackend::Use;
    const driver::Program& program = run.cutout != nullptr ? *run.cutout : driver::depth_program();
    const Use use = in_layers ? Use::visibility_in_layers : run.over ? Use::visibility_over : Use::visibility;
    return pipeline = backend_.pipeline_of(program, use, [&]() -> std::optional<PipelineIndex> {
      PipelineSource source{Output::visibility, 1, triangle_vertex(), {}, use == Use::visibility_over};
      if (run.cutout != nullptr) {
        if (!driver::within_limits(program, driver::Target::vulkan, backend_.division_, diagnostics)) return std::nullopt;
        source.what = driver::description(program);
      }
      source.fragment_glsl = in_layers ? driver::glsl_of_layer(program, backend_.division_)
                                       : backend_.options_.glsl(program, backend_.division_);
      return backend_.device_->pipeline(source, diagnostics);
    });
  }

  std::optional<PipelineIndex> blend_pipeline(const driver::Program& program, bool writes_depth,
                                              Diagnostics& diagnostics) {
    using Use = VulkanBackend::Use;
    const Use use = writes_depth ? Use::deep_blending : Use::blending;
    return backend_.pipeline_of(program, use, [&]() -> std::optional<PipelineIndex> {
      auto text = backend_.text_of(program, diagnostics);
      if (!text) return std::nullopt;
      if (writes_depth) text = driver::glsl_of_layer(program, backend_.division_);
      PipelineSource source{writes_depth ? Output::deep_layer : Output::layer, writes_depth ? 2u : 1u,
                            full_screen_vertex(), std::move(*text)};
      source.what = driver::description(program);
      return backend_.device_->pipeline(source, diagnostics);
    });
  }

  VulkanBackend& backend_;
  const ViewPass pass_;
  const backends::Layers layers_;
  std::span<const float> vertices_;
  bool knows_vertices_;
  bool uploaded_ = false;
  /// By the program of the cut-out, or null, whether the depth test always passes, and whether it draws layers.
  std::map<std::tuple<const driver::Program*, bool, bool>, std::optional<PipelineIndex>> visibility_;
  std::vector<std::optional<PipelineIndex>>
      shading_;  ///< one for each program of the frame, made when needed
  /// By the program, and whether its triangles write depth.
  std::map<std::pair<size_t, bool>, std::optional<PipelineIndex>> blending_;
};

std::optional<bool> VulkanBackend::draw_view(const backends::Drawing& drawing, backends::Made& made,
                                             Diagnostics& diagnostics) {
  const backends::View& view = drawing.pass.view;
  // An opaque triangle that takes every pixel is no matter of the greatest depth.
  const auto takes_all = [&](const backends::Draw& draw) {
    return draw.state.depth == interface::DepthTest::always && !(draw.blended && view.target.has_color);
  };
  if (!on_device_ || !device_->makes_triangles() || view.draws.empty() || std::ranges::any_of(view.draws, takes_all))
    return std::nullopt;
  const Device::Places pixels{drawing.depth.first * sizeof(float), drawing.color.first * sizeof(float)};
  // Samples lie behind the images of the frame until they become pixels; of 16 a pixel, first each 4 become one.
  Device::Places places = pixels, between{};
  if (drawing.side > 1) {
    const size_t samples =
        static_cast<size_t>(view.target.width) * static_cast<size_t>(view.target.height) * sizeof(float);
    places = {layers_.size() * sizeof(float), layers_.size() * sizeof(float) + samples};
    between = {places.color + 4 * samples, places.color + 4 * samples + samples / 4};
    const size_t end = between.color + samples;
    if (end > device_->max_buffer_bytes()) return std::nullopt;
    if (!guarded(diagnostics, [&] { return device_->extend_layers(end), true; })) return false;
  }
  const std::vector<int32_t> records =
      backends::image_records(view.target.width, view.target.height, drawing.pass.images);
  std::optional<bool> is_finite;
  const bool succeeded = guarded(diagnostics, [&] {
    const auto triangles = make_triangles(drawing.pass, {{}, records}, diagnostics);
    if (!triangles) return !diagnostics.has_errors();
    made = triangles->made;
    VulkanViewRenderer renderer(*this, drawing.pass, {{}, records}, drawing.pass.frame.vertices, true);
    is_finite = renderer.draw(drawing.window, *triangles, places, diagnostics);
    return is_finite || !diagnostics.has_errors();
  });
  if (!succeeded) return false;
  if (!is_finite) return std::nullopt;
  made_finite_ = made_finite_ && *is_finite;
  if (drawing.side == 1) return drawing.posts.empty() || post(drawing.posts, drawing.color, diagnostics);
  const backends::Slot color{places.color / sizeof(float), view.target.width, view.target.height, 4};
  for (backends::ScreenPass pass : drawing.posts) {
    std::vector<backends::ImageRead> images(pass.images.begin(), pass.images.end());
    images[0].slot.first = places.depth / sizeof(float);
    images[1].slot.first = color.first;
    pass.images = images;
    if (!post({&pass, 1}, color, diagnostics)) return false;
  }
  return guarded(diagnostics, [&] {
    device_->reduce(places, between, pixels, view.target.width, view.target.height,
                    drawing.side == 4 ? 2 : 1);
    return true;
  });
}

bool VulkanBackend::draw(const backends::Drawing& drawing, Diagnostics& diagnostics) {
  if (!on_device_) return HostBackend::draw(drawing, diagnostics);
  const backends::View& view = drawing.pass.view;
  if (drawing.side > 1) {
    // Samples become pixels in the memory of the host, and the device's array is overwritten on the way.
    std::vector<backends::Slot> kept;
    for (const backends::ImageRead& image : drawing.pass.images) {
      if (image.slot.exists()) kept.push_back(image.slot);
      if (image.camera != backends::ImageRead::no_camera)
        kept.push_back({image.camera, lower::view_word::camera_words, 1, 1});
    }
    for (const backends::Slot& slot : kept) read(slot);
    if (!HostBackend::draw(drawing, diagnostics)) return false;
    kept.insert(kept.end(), {drawing.depth, drawing.color});
    return guarded(diagnostics, [&] {
      device_->reserve_layers(layers_.size() * sizeof(float));
      for (const backends::Slot& slot : kept)
        device_->write_layers(slot.first * sizeof(float), layers_.data() + slot.first, slot.size() * sizeof(float));
      return true;
    });
  }
  const std::vector<int32_t> records =
      backends::image_records(view.target.width, view.target.height, drawing.pass.images);
  bool is_finite = true;
  VulkanViewRenderer renderer(*this, drawing.pass, {{}, records}, drawing.vertices, !drawing.has_other_vertices);
  const Device::Places places{drawing.depth.first * sizeof(float), drawing.color.first * sizeof(float)};
  if (!renderer.draw(drawing.window, drawing.triangles, places, is_finite, diagnostics)) return false;
  made_finite_ = made_finite_ && is_finite;
  return drawing.posts.empty() || post(drawing.posts, drawing.color, diagnostics);
}

std::unique_ptr<backends::ViewRenderer> VulkanBackend::begin(const ViewPass& pass, const backends::Layers& layers,
                                                             std::span<const float> vertices, Diagnostics&) {
  return std::make_unique<VulkanViewRenderer>(*this, pass, layers, vertices, false);
}

}  // namespace isoshade::vulkan
