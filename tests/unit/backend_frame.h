// SPDX-License-Identifier: Apache-2.0
// A frame that is hard for a backend: many objects of a few triangles each, scattered over and beyond the image, which
// overlap, and some of which pass through the near plane.
#pragma once

#include <cstring>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <vector>

#include "backends/backend.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/raster/clip.h"

namespace isoshade::backends {

inline constexpr int object_stride = 64;

/// Its first program is of the vertex stage, its second of the pixel stage; whoever uses it provides them.
struct TestFrame {
  std::vector<uint32_t> indices;
  Frame frame;

  TestFrame(int width, int height, int objects) {
    frame.views.resize(1);
    view().target = {"the picture", width, height};
    frame.light_count = 3;
    frame.lights.resize(3 * lower::light_word::stride);
    frame.frame.resize(lower::frame_word::count);
    view().words.resize(lower::view_word::camera_words);
    view().background[0] = 0.25f;
    view().background[3] = 1;
    for (uint32_t i = 0; i < vertices_of_object; ++i) indices.push_back(i);
    for (int i = 0; i < objects; ++i) add_object(i * object_stride);
  }
  TestFrame(const TestFrame&) = delete;
  TestFrame& operator=(const TestFrame&) = delete;

  View& view() { return frame.views.back(); }
  const View& view() const { return frame.views.back(); }
  ViewPass pass() const { return {frame, view()}; }

  /// The steps between transform and draw.
  void assemble(std::span<const float> clip, Backend& backend, support::Array<float>& vertices,
                support::Array<int32_t>& triangles) const {
    vertices.assign(frame.vertices.begin(), frame.vertices.end());
    std::vector<raster::Surface> surfaces;
    for (const Draw& draw : view().draws) {
      const std::span<const float> of_draw = clip.first(size_t{4} * draw.vertex_count);
      clip = clip.subspan(of_draw.size());
      surfaces.push_back(
          {of_draw, draw.indices, draw.first_vertex, draw.state, draw.object, draw.mirrored, draw.cutout});
    }
    raster::Clipper().run(surfaces, view().target.width, view().target.height, backend.workers(), vertices, triangles);
  }

  static constexpr uint32_t vertices_of_object = 30;

 private:
  float random() { return static_cast<float>(random_() >> 8) / 16777216.0f; }

  void add_object(int object) {
    Draw draw;
    draw.vertex_program = 0;
    draw.pixel_program = 1;
    draw.object = object;
    draw.first_vertex = static_cast<uint32_t>(frame.vertices.size() / lower::vertex_word::stride);
    draw.vertex_count = vertices_of_object;
    draw.indices = indices;
    draw.state.cull = interface::Cull::none;
    draw.projected = static_cast<int>(view().words.size());
    view().draws.push_back(draw);

    frame.objects.resize(frame.objects.size() + object_stride);
    float* record = frame.objects.data() + object;
    record[0] = 0.5f + random();
    record[lower::object_word::program] = 1;
    record[lower::object_word::parameters] = random();
    // Columns of a perspective with the near plane at 0.25; what is at z = 0 is 1 away.
    view().words.resize(view().words.size() + lower::view_word::matrix);
    float* columns = &view().words[static_cast<size_t>(draw.projected)];
    columns[0] = columns[5] = record[0];
    columns[11] = 1;
    columns[14] = 0.25f;
    columns[15] = 1;

    const float x = 2.4f * random() - 1.2f, y = 2.4f * random() - 1.2f, size = random() * random();
    for (uint32_t v = 0; v < vertices_of_object; ++v) {
      const float vertex[lower::vertex_word::stride] = {x + size * (random() - 0.5f),
                                                        y + size * (random() - 0.5f),
                                                        random() - 0.2f,
                                                        0,
                                                        0,
                                                        1,
                                                        random(),
                                                        random()};
      frame.vertices.insert(frame.vertices.end(), std::begin(vertex), std::end(vertex));
    }
  }

  std::mt19937 random_{1};
};

template <class Floats>
bool same_bits(const Floats& a, const Floats& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// Draws a whole view.
inline bool draw(Backend& backend, const ViewPass& pass, std::span<const float> vertices,
                 std::span<const int32_t> triangles, Image& image, support::Diagnostics& diagnostics) {
  const Target& target = pass.view.target;
  SlotAllocator slots;
  const Slot depth = slots.take(target.width, target.height, 1);
  const Slot color = target.has_color ? slots.take(target.width, target.height, 4) : Slot{};
  if (!backend.reserve(slots.length(), diagnostics) ||
      !backend.draw({.pass = pass,
                     .vertices = vertices,
                     .triangles = triangles,
                     .window = {0, 0, target.width, target.height},
                     .depth = depth,
                     .color = color},
                    diagnostics))
    return false;
  const auto copy = [&](const Slot& slot) {
    const std::span<const float> floats = backend.read(slot);
    return std::vector<float>(floats.begin(), floats.end());
  };
  image = {target.width, target.height, copy(color), copy(depth)};
  return true;
}

inline Image render(Backend& backend, const TestFrame& test) {
  support::Diagnostics diagnostics;
  support::Array<float> clip;
  support::Array<float> vertices;
  support::Array<int32_t> triangles;
  Image image;
  EXPECT_TRUE(backend.transform(test.pass(), clip, diagnostics)) << diagnostics.text();
  test.assemble(clip, backend, vertices, triangles);
  EXPECT_TRUE(draw(backend, test.pass(), vertices, triangles, image, diagnostics)) << diagnostics.text();
  return image;
}

}  // namespace isoshade::backends
