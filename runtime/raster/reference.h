// SPDX-License-Identifier: Apache-2.0
// The rules of rasterisation, written down as plainly as they can be run. The interpreter draws with it, and
// the fast rasteriser is tested against it.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/raster/triangle.h"

namespace isoshade::raster {

/// Draws the triangles (records of lower/frame_layout.h) in their order. For each pixel of the area, rows top
/// down: the index of the triangle with the greatest depth above 0, of equal ones the first, or -1; and that
/// depth, or 0.
void rasterize_reference(std::span<const int32_t> triangles, const Box& area, std::span<int32_t> ids,
                         std::span<float> depth);

}  // namespace isoshade::raster
