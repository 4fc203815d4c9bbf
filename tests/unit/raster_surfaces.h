// SPDX-License-Identifier: Apache-2.0
// Random surfaces for tests of clipping.
#pragma once

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/clip.h"

namespace isoshade::raster {

/// Surfaces whose vertices lie inside, on and beyond every plane, and some that are not finite.
class RandomSurfaces {
 public:
  std::vector<std::vector<float>> clips;
  std::vector<std::vector<uint32_t>> indices;
  std::vector<Surface> surfaces;
  std::vector<float> vertices;

  explicit RandomSurfaces(unsigned seed) : random_(seed) {
    for (const size_t count : {1, 2, 3, 7, 64, 0, 300, 5000, 20000, 5, 4096}) add(count);
    for (size_t i = 0; i < clips.size(); ++i) {
      surfaces[i].clip = clips[i];
      surfaces[i].indices = indices[i];
    }
  }

 private:
  static constexpr size_t stride = lower::vertex_word::stride;

  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8) / 16777216.0f;
  }
  bool one_in(unsigned n) { return random_() % n == 0; }

  void add(size_t triangles) {
    using interface::Cull, interface::DepthTest, interface::DepthWrite;
    const size_t count = std::max<size_t>(3, triangles * 2 / 3);
    std::vector<float>& clip = clips.emplace_back();
    // Neighbours in the order of vertices are near each other, so that triangles are small; a few go anywhere.
    const float spread = between(0.01f, 0.3f);
    float x = between(-1.5f, 1.5f), y = between(-1.5f, 1.5f), w = between(0.2f, 3.0f);
    for (size_t i = 0; i < count; ++i) {
      x += between(-spread, spread), y += between(-spread, spread), w += between(-spread, spread);
      if (one_in(40)) x = between(-2, 2), y = between(-2, 2), w = between(-0.5f, 4.0f);
      const bool orthographic = one_in(50);
      float point[4] = {x, y, orthographic ? between(-0.1f, 1.1f) : 0.1f, orthographic ? 1.0f : w};
      if (one_in(60)) point[random_() % 2] *= 1000.0f;  // beyond the guard band
      if (one_in(70)) point[2] = point[3];              // on the near plane
      if (one_in(90)) point[2] = one_in(2) ? 0.0f : -0.0f;
      if (one_in(200)) point[3] = one_in(2) ? 0.0f : 1.2e-38f;
      if (one_in(300))
        point[random_() % 4] =
            one_in(2) ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
      clip.insert(clip.end(), point, point + 4);
    }
    std::vector<uint32_t>& corners = indices.emplace_back();
    for (size_t i = 0; i < triangles; ++i) {
      const auto first = static_cast<uint32_t>(random_() % (count - 2));
      for (uint32_t k = 0; k < 3; ++k)
        corners.push_back(one_in(30) ? static_cast<uint32_t>(random_() % count) : first + k);
    }
    Surface surface;
    surface.first_vertex = static_cast<uint32_t>(vertices.size() / stride);
    surface.state.cull = std::vector{Cull::none, Cull::back, Cull::front}[random_() % 3];
    surface.state.depth = one_in(4) ? DepthTest::always : DepthTest::nearer;
    surface.state.depth_write = one_in(2) ? DepthWrite::on : DepthWrite::off;
    surface.object = static_cast<int>(surfaces.size());
    surface.mirrored = one_in(2);
    surface.cutout = one_in(3);
    surface.blended = one_in(3);
    if (one_in(3)) surface.bias = {between(0, 3), between(0, 1e-3f), between(0, 1e-4f)};
    surfaces.push_back(surface);
    for (size_t i = 0; i < count * stride; ++i) vertices.push_back(between(-10, 10));
  }

  std::mt19937 random_;
};

}  // namespace isoshade::raster
