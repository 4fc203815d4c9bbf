// SPDX-License-Identifier: Apache-2.0
// The rules of clipping and rasterisation in their simplest executable form, which the fast forms are tested against. The
// interpreter draws with it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "runtime/raster/clip.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster {

/// Whether the cut-out of a triangle holds at a pixel.
using IsDrawn = std::function<bool(int triangle, int x, int y)>;

/// Draws the triangles (records of lower/frame_layout.h) in their order. Each pixel of the area, rows top down,
/// receives the index and the depth of the triangle with the greatest depth above 0 (of equal ones the first), or -1
/// and 0. A triangle with triangle_flag::over takes every pixel that it covers. One with triangle_flag::cutout takes only
/// pixels where `is_drawn`, which is asked where the triangle would be seen otherwise.
void rasterize_reference(std::span<const int32_t> triangles, const Box& area, std::span<int32_t> ids,
                         std::span<float> depth, const IsDrawn& is_drawn = {});

/// Appends what Clipper makes of a surface, one triangle after the other.
void clip_reference(const Surface& surface, int width, int height, std::vector<float>& vertices,
                    std::vector<int32_t>& triangles);

/// Calls visit(x, y, depth) for each pixel of the area that the triangle (a record) covers, rows top down.
void for_each_covered(const int32_t* triangle, const Box& area,
                      const std::function<void(int x, int y, float depth)>& visit);

}  // namespace isoshade::raster
