// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "runtime/raster/bins.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/tile.h"
#include "tests/unit/raster_shapes.h"

namespace isoshade::raster {
namespace {

using shapes::Shapes;

std::vector<int32_t> mixture(int width, int height) {
  Shapes shapes(width, height, 11);
  std::vector<int32_t> triangles;
  for (const std::string kind : shapes::kinds)
    for (const auto& t : shapes.of(kind, 40)) shapes::append(triangles, t, {0.5f, 0.5f, 0.5f});
  return triangles;
}

TEST(Bins, ListEveryTriangleWhereItCoversAPixel) {
  const int width = 300, height = 170;
  const std::vector<int32_t> triangles = mixture(width, height);
  const TileGrid grid(width, height);
  const Bins bins(triangles, 0, shapes::count(triangles), width, height);
  std::vector<int32_t> ids(static_cast<size_t>(width) * height);
  std::vector<float> depth(ids.size());
  for (int i = 0; i < shapes::count(triangles); ++i) {
    const std::span one = std::span(triangles).subspan(static_cast<size_t>(i) * lower::triangle_word::stride,
                                                       lower::triangle_word::stride);
    rasterize_reference(one, width, height, ids, depth);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (ids[static_cast<size_t>(y) * width + x] < 0) continue;
        const auto listed = bins.of(y / tile_size * grid.columns + x / tile_size);
        ASSERT_TRUE(std::binary_search(listed.begin(), listed.end(), i)) << "triangle " << i;
      }
  }
}

TEST(Bins, KeepTheOrderOfTriangles) {
  const std::vector<int32_t> triangles = mixture(300, 170);
  const Bins bins(triangles, 0, shapes::count(triangles), 300, 170);
  for (int tile = 0; tile < TileGrid(300, 170).count(); ++tile) {
    const auto listed = bins.of(tile);
    EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end()));
    EXPECT_EQ(std::adjacent_find(listed.begin(), listed.end()), listed.end());
  }
}

TEST(Bins, OfPartsMakeUpTheWhole) {
  const std::vector<int32_t> triangles = mixture(300, 170);
  const int count = shapes::count(triangles);
  const Bins whole(triangles, 0, count, 300, 170);
  const Bins first(triangles, 0, 100, 300, 170), second(triangles, 100, count - 100, 300, 170);
  for (int tile = 0; tile < TileGrid(300, 170).count(); ++tile) {
    std::vector<int32_t> parts(first.of(tile).begin(), first.of(tile).end());
    parts.insert(parts.end(), second.of(tile).begin(), second.of(tile).end());
    EXPECT_TRUE(std::ranges::equal(parts, whole.of(tile)));
  }
}

TEST(Bins, LeaveOutTilesThatALongEdgeMisses) {
  std::vector<int32_t> triangles;
  const int end = 16 * tile_size * 256;
  shapes::append(triangles, {shapes::Position{0, 0}, {end, end}, {end - 512, end}}, {0.5f, 0.5f, 0.5f});
  const int size = 16 * tile_size;
  const Bins bins(triangles, 0, 1, size, size);
  int listed = 0;
  for (int tile = 0; tile < TileGrid(size, size).count(); ++tile)
    listed += static_cast<int>(bins.of(tile).size());
  EXPECT_GE(listed, 16);
  EXPECT_LE(listed, 3 * 16);  // of 256
}

}  // namespace
}  // namespace isoshade::raster
