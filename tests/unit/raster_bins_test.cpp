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

threads::Workers workers(2);

std::vector<int32_t> mixture(int width, int height) {
  Shapes shapes(width, height, 11);
  std::vector<int32_t> triangles;
  for (const std::string kind : shapes::kinds)
    for (const auto& t : shapes.of(kind, 40)) shapes::append(triangles, t, {0.5f, 0.5f, 0.5f});
  return triangles;
}

void expect_every_triangle_that_covers_a_pixel(const Box& area) {
  const std::vector<int32_t> triangles = mixture(300, 170);
  const TileGrid grid(area);
  Bins bins;
  bins.sort(triangles, grid, workers);
  const int width = area.x1 - area.x0 + 1, height = area.y1 - area.y0 + 1;
  std::vector<int32_t> ids(static_cast<size_t>(width) * height);
  std::vector<float> depth(ids.size());
  for (int i = 0; i < shapes::count(triangles); ++i) {
    const std::span one = std::span(triangles).subspan(static_cast<size_t>(i) * lower::triangle_word::stride,
                                                       lower::triangle_word::stride);
    rasterize_reference(one, area, ids, depth);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (ids[static_cast<size_t>(y) * width + x] < 0) continue;
        const auto listed = bins.of(y / tile_size * grid.columns + x / tile_size);
        ASSERT_TRUE(std::binary_search(listed.begin(), listed.end(), i)) << "triangle " << i;
      }
  }
}

TEST(Bins, ContainEveryTriangleThatCoversAPixel) {
  expect_every_triangle_that_covers_a_pixel(box_at(0, 0, 300, 170));
}

TEST(Bins, ContainEveryTriangleThatCoversAPixelOfAPart) {
  expect_every_triangle_that_covers_a_pixel(box_at(70, 9, 150, 151));
  expect_every_triangle_that_covers_a_pixel(box_at(299, 169, 1, 1));
}

TEST(Bins, KeepTheOrderOfTriangles) {
  const std::vector<int32_t> triangles = mixture(300, 170);
  const TileGrid grid(box_at(0, 0, 300, 170));
  Bins bins;
  bins.sort(triangles, grid, workers);
  for (int tile = 0; tile < grid.count(); ++tile) {
    const auto listed = bins.of(tile);
    EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end()));
    EXPECT_EQ(std::adjacent_find(listed.begin(), listed.end()), listed.end());
  }
}

TEST(Bins, AreTheSameForAnyNumberOfThreads) {
  std::vector<int32_t> triangles;
  for (int i = 0; i < 30; ++i) {
    const std::vector<int32_t> more = mixture(300, 170);
    triangles.insert(triangles.end(), more.begin(), more.end());
  }
  const TileGrid grid(box_at(0, 0, 300, 170));
  threads::Workers one(1);
  Bins expected;
  expected.sort(triangles, grid, one);
  Bins bins;
  for (const int count : {1, 2, 3, 16}) {
    threads::Workers several(count);
    for (const size_t part : {size_t{0}, triangles.size() / 5 / 16 * 16, triangles.size()}) {
      // What was sorted before leaves nothing behind.
      bins.sort(std::span(triangles).first(part), grid, several);
      if (part < triangles.size()) continue;
      for (int tile = 0; tile < grid.count(); ++tile) EXPECT_TRUE(std::ranges::equal(bins.of(tile), expected.of(tile)));
    }
  }
}

TEST(Bins, OmitTilesThatALongEdgeMisses) {
  std::vector<int32_t> triangles;
  const int end = 16 * tile_size * 256;
  shapes::append(triangles, {shapes::Position{0, 0}, {end, end}, {end - 512, end}}, {0.5f, 0.5f, 0.5f});
  const int size = 16 * tile_size;
  const TileGrid grid(box_at(0, 0, size, size));
  Bins bins;
  bins.sort(triangles, grid, workers);
  int listed = 0;
  for (int tile = 0; tile < grid.count(); ++tile) listed += static_cast<int>(bins.of(tile).size());
  EXPECT_GE(listed, 16);
  EXPECT_LE(listed, 3 * 16);  // of 256
}

}  // namespace
}  // namespace isoshade::raster
