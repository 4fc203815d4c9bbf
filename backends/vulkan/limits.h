// SPDX-License-Identifier: Apache-2.0
// Sizes that shaders, pipelines and chunks agree on.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compiler/lower/frame_layout.h"

namespace isoshade::vulkan {

/// Positions lie at most this many pixels from the origin on each axis (|.| <= 2^21 in 1/256 pixel). The viewport has
/// twice this size and is centred on pixel 0, so that the map from clip space to 1/256 pixel is an exact power of two.
inline constexpr int guard_band = 8192;

/// Attachments begin this many pixels before their window, unless the window begins at the view's first pixel. lavapipe
/// keeps edge functions to 39 bits where all of a triangle that is right of and below the first pixel of the
/// attachments lies in one tile of this size. That is too few for a triangle that begins far before it; the margin
/// holds the tiles in which this can happen.
inline constexpr int margin_of_windows = 64;

/// Set 0: the buffers of frame_layout.h, the buffer that vertex kernels write, the ids of the visible triangles, a word
/// that is 0, three images that the layer before left: its ids, the depth and the color; and the buffers of the setup
/// stage and of compute shaders.
inline constexpr uint32_t frame_bindings = std::size(lower::frame_buffers);
inline constexpr uint32_t output_binding = frame_bindings;
inline constexpr uint32_t storage_bindings = frame_bindings + 1;
inline constexpr uint32_t ids_binding = storage_bindings;
inline constexpr uint32_t zero_binding = ids_binding + 1;
inline constexpr uint32_t former_ids_binding = zero_binding + 1;
inline constexpr uint32_t former_depth_binding = former_ids_binding + 1;
inline constexpr uint32_t former_color_binding = former_depth_binding + 1;
inline constexpr uint32_t positions_binding = former_color_binding + 1;
inline constexpr uint32_t indices_binding = positions_binding + 1;
inline constexpr uint32_t cuts_binding = indices_binding + 1;
inline constexpr uint32_t seen_binding = cuts_binding + 1;
inline constexpr uint32_t tiles_binding = seen_binding + 1;
inline constexpr uint32_t orders_binding = tiles_binding + 1;
inline constexpr uint32_t binding_count = orders_binding + 1;
inline constexpr uint32_t image_bindings = 4;
constexpr bool is_image_binding(uint32_t binding) {
  return binding == ids_binding || (binding >= former_ids_binding && binding <= former_color_binding);
}

/// A table program writes four words to each color attachment.
inline constexpr uint32_t max_attachments = 8;
inline constexpr size_t max_result_words = 4 * max_attachments;

/// Tables and vertices run in chunks, to bound the memory.
inline constexpr int table_width = 512;
inline constexpr size_t max_table_rows = size_t{table_width} * 512;
inline constexpr size_t max_output_words = size_t{1} << 23;
/// Images are read back in bands of rows of at most this many bytes.
inline constexpr size_t max_readback_bytes = size_t{64} << 20;

}  // namespace isoshade::vulkan
