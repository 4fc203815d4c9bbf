// SPDX-License-Identifier: Apache-2.0
// Triangles that the device makes itself. Vertex programs leave their positions on the device, and the setup stage makes a
// record of each triangle where the host would list only those that are seen: a record without an area takes the place of
// the others. The few triangles that a plane cuts come to the host, which clips them as it clips all for other backends, and
// puts what is left of them behind the records.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/vulkan/device.h"

namespace isoshade::vulkan {

/// Consecutive triangles with the same depth test and the same cut-out.
struct Run {
  uint32_t first, count;
  bool over;
  const driver::Program* cutout;  ///< or null
};

/// Appends triangles, to the last run if they belong to it.
void append(std::vector<Run>& runs, const Run& run);

/// The triangles of a view, whose records the device has. Their numbers tell the order, see glsl::order_bits.
struct DeviceTriangles {
  std::vector<Run> opaque, blended;
  size_t blended_count = 0;
  std::vector<size_t> programs, blending;  ///< the programs that show them: indices into Frame::programs
  size_t first_cut = 0;    ///< from this number on they are what cutting left
  size_t first_order = 0;  ///< where the order of these stands in `inputs`
  backends::Made made;
};

/// Rows of a call of Stage::vertex or setup, see glsl::table_row.
class Table {
 public:
  /// Adds a row of so many vertices or triangles; the further words as there.
  void add(uint32_t count, std::initializer_list<size_t> words);
  /// The words of the rows, which begin at word `first` of `inputs`; the call of all of them.
  std::span<const int32_t> words() const { return words_; }
  Call call(PipelineIndex pipeline, size_t first) const;
  bool empty() const { return words_.empty(); }

 private:
  std::vector<int32_t> words_;
  uint32_t count_ = 0;
};

/// Appends the record of a surface for the setup stage, see lower::surface_word.
void append_surface(const raster::Surface& surface, const raster::Viewport& viewport,
                    std::vector<int32_t>& words);

/// Whether a vertex program of the view reads a texture.
bool moves_by_textures(const backends::ViewPass& pass);

}  // namespace isoshade::vulkan
