// SPDX-License-Identifier: Apache-2.0
// The probe's triangles: many small cells of a frame, each with a few triangles of its own, so that the coverage
// of nearly every triangle is seen and not only what ends on top.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backends/vulkan/device.h"

namespace isoshade::vulkan {

/// Triangles that are drawn with the cell's area as scissor.
struct Cell {
  Rect area;
  uint32_t first = 0;  ///< triangle
  uint32_t count = 0;
};

inline constexpr int cell_size = 16;  ///< pixels each way

struct CoverageScene {
  int width = 0;
  int height = 0;
  std::vector<Cell> cells;
  std::vector<int32_t> triangles;  ///< records of frame_layout.h of which only the positions are set
  std::vector<int32_t> values;     ///< of each triangle as bits: its depth everywhere, its color
};
inline constexpr int value_stride = 5;

/// A frame of `length` pixels along x or along y, at most to the end of the guard band. The same on every
/// machine.
CoverageScene coverage_scene(int length, bool along_y);

/// The image that the scene must give over a background, by exact edge functions.
backends::Image expected_image(const CoverageScene& scene, const float (&background)[4]);

/// Fragment shaders. The first writes depth, and an id made of the triangle and of the pixel where the device
/// believes to be; the second shows the triangle's color, or (-1, -1, -1, -1) if it does not find this pixel in
/// the id.
std::string coverage_visibility_glsl();
std::string coverage_color_glsl();

}  // namespace isoshade::vulkan
