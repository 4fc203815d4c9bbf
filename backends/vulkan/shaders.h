// SPDX-License-Identifier: Apache-2.0
// The vertex shaders that stand before generated fragment shaders.
#pragma once

#include <string>

namespace isoshade::vulkan {

/// Covers every pixel with one triangle.
const std::string& full_screen_vertex();

/// Draws the triangles of the buffer by their snapped positions; `flat out int triangle` at location 0. The
/// map from 1/256 pixel to clip space is an exact power of two.
const std::string& triangle_vertex();

}  // namespace isoshade::vulkan
