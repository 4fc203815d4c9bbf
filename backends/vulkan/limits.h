// SPDX-License-Identifier: Apache-2.0
// Sizes that shaders, pipelines and chunks agree on.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compiler/lower/frame_layout.h"

namespace isoshade::vulkan {

/// Pixels on each side of the origin that positions may lie at (|.| <= 2^21 in 1/256 pixel). The viewport is
/// twice this and centred on pixel 0, so that the map from clip space to 1/256 pixel is an exact power of two.
inline constexpr int guard_band = 8192;

/// Pixels of the frame before a part of it that its target has too, unless both begin at the same pixel. lavapipe keeps
/// edge functions to 39 bits where all of a triangle that is right of and below the target's beginning lies in one tile
/// of this size, which is too few for one that begins far before it; only those that end in the first tiles do.
inline constexpr int margin_of_parts = 64;

/// Set 0: the buffers of frame_layout.h, then what vertex kernels write, then the ids of the visible triangles,
/// then a word that is 0.
inline constexpr uint32_t frame_bindings = std::size(lower::frame_buffers);
inline constexpr uint32_t output_binding = frame_bindings;
inline constexpr uint32_t storage_bindings = frame_bindings + 1;
inline constexpr uint32_t ids_binding = storage_bindings;
inline constexpr uint32_t zero_binding = ids_binding + 1;
inline constexpr uint32_t binding_count = zero_binding + 1;

/// A table program writes four words to each color attachment.
inline constexpr uint32_t max_attachments = 8;
inline constexpr size_t max_result_words = 4 * max_attachments;

/// Tables and vertices run in chunks, so that memory stays bounded whatever their length.
inline constexpr int table_width = 512;
inline constexpr size_t max_table_rows = size_t{table_width} * 512;
inline constexpr size_t max_output_words = size_t{1} << 23;
/// Images come back in bands of rows of at most this many bytes.
inline constexpr size_t max_readback_bytes = size_t{64} << 20;

}  // namespace isoshade::vulkan
