// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "compiler/functions/interpolation.h"
#include "runtime/lanes/lanes.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/tile.h"
#include "tests/unit/raster_shapes.h"

namespace isoshade::raster {
namespace {

namespace word = lower::triangle_word;
using shapes::Position;
using shapes::Shapes;

using Rasterize = void (*)(const int32_t*, const int32_t*, int, int, int, Tile&);
using List = int (*)(const int32_t*, const int32_t*, int, int, int, const Box&, Tile&, Candidates&);

struct Visible {
  std::vector<int32_t> ids;
  std::vector<float> depth;

  Visible(int width, int height) : ids(static_cast<size_t>(width) * height), depth(ids.size()) {}
};

Visible by_tiles(Rasterize rasterize, const std::vector<int32_t>& triangles, int width, int height) {
  Visible result(width, height);
  const TileGrid grid(box_at(0, 0, width, height));
  threads::Workers workers(1);
  Bins bins;
  bins.sort(triangles, grid, workers);
  const lanes::FpGuard guard_floats;
  for (int i = 0; i < grid.count(); ++i) {
    const int left = i % grid.columns * tile_size, top = i / grid.columns * tile_size;
    Tile tile;
    tile.clear();
    rasterize(triangles.data(), bins.of(i).data(), static_cast<int>(bins.of(i).size()), left, top, tile);
    for (int pixel = 0; pixel < tile_pixels; ++pixel) {
      const int x = left + tile_x(pixel), y = top + tile_y(pixel);
      if (x >= width || y >= height) continue;
      result.ids[static_cast<size_t>(y) * width + x] = tile.triangles[pixel];
      result.depth[static_cast<size_t>(y) * width + x] = tile.depth[pixel];
    }
  }
  return result;
}

/// A cut-out without a pattern that a rasteriser might share.
bool is_hole(int triangle, int x, int y) {
  return (static_cast<unsigned>(triangle) * 2654435761u ^ static_cast<unsigned>(x) * 40503u ^
          static_cast<unsigned>(y) * 9176u) >> 7 & 1;
}

/// Draws runs of triangles of one kind, as backends do: those with cut-outs by way of candidates.
Visible by_candidates(Rasterize rasterize, List list, const std::vector<int32_t>& triangles, int width, int height) {
  Visible result(width, height);
  const Box area = box_at(0, 0, width, height);
  const TileGrid grid(area);
  threads::Workers workers(1);
  Bins bins;
  bins.sort(triangles, grid, workers);
  const lanes::FpGuard guard_floats;
  const auto tile = std::make_unique<Tile>();
  const auto found = std::make_unique<Candidates>();
  for (int i = 0; i < grid.count(); ++i) {
    const int left = grid.x(i), top = grid.y(i);
    tile->clear();
    std::span<const int32_t> listed = bins.of(i);
    while (!listed.empty()) {
      const Triangle first = triangle_at(triangles.data(), listed.front());
      size_t count = 1;
      while (count < listed.size()) {
        const Triangle next = triangle_at(triangles.data(), listed[count]);
        if (next.cutout() != first.cutout() || next.over() != first.over()) break;
        ++count;
      }
      if (!first.cutout()) {
        rasterize(triangles.data(), listed.data(), static_cast<int>(count), left, top, *tile);
        listed = listed.subspan(count);
        continue;
      }
      found->count = 0;
      const int taken = list(triangles.data(), listed.data(), static_cast<int>(count), left, top, area, *tile, *found);
      EXPECT_GT(taken, 0);
      for (int c = 0; c < found->count; ++c) {
        EXPECT_TRUE(found->x[c] < width && found->y[c] < height) << "candidates outside of the image";
        found->drawn[c] = is_hole(found->triangle[c], found->x[c], found->y[c]) ? 0 : 1;
      }
      draw_candidates(*found, first.over(), *tile);
      listed = listed.subspan(static_cast<size_t>(taken));
    }
    for (int pixel = 0; pixel < tile_pixels; ++pixel) {
      const int x = left + tile_x(pixel), y = top + tile_y(pixel);
      if (x >= width || y >= height) continue;
      result.ids[static_cast<size_t>(y) * width + x] = tile->triangles[pixel];
      result.depth[static_cast<size_t>(y) * width + x] = tile->depth[pixel];
    }
  }
  return result;
}

Visible plainly(const std::vector<int32_t>& triangles, int width, int height) {
  Visible result(width, height);
  rasterize_reference(triangles, box_at(0, 0, width, height), result.ids, result.depth,
                      [](int triangle, int x, int y) { return !is_hole(triangle, x, y); });
  return result;
}

int differences(const Visible& a, const Visible& b) {
  int count = 0;
  for (size_t i = 0; i < a.ids.size(); ++i)
    if (a.ids[i] != b.ids[i] || std::bit_cast<int32_t>(a.depth[i]) != std::bit_cast<int32_t>(b.depth[i]))
      ++count;
  return count;
}

struct Variant {
  int lanes;
  Rasterize rasterize;
  List list;
};

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.lanes << " lanes"; }

class TileAtLanes : public testing::TestWithParam<Variant> {
 protected:
  void SetUp() override {
    if (GetParam().lanes > rasterizer_lanes())
      GTEST_SKIP() << "this machine has no registers of so many lanes";
  }
};

TEST_P(TileAtLanes, MatchesTheReferenceRasterizer) {
  for (const auto& [width, height] :
       {std::pair{64, 64}, std::pair{200, 150}, std::pair{1, 1}, std::pair{333, 65}})
    for (const std::string kind : shapes::kinds) {
      Shapes shapes(width, height, 4242u + static_cast<unsigned>(width));
      std::vector<int32_t> triangles;
      std::array<float, 3> depth{};
      for (const auto& t : shapes.of(kind, 400)) {
        // Every fourth has the depths of the one before, so that ties occur; some are flat, some lie at the
        // ends.
        if (shapes.between(0, 3) != 0) depth = {shapes.fraction(), shapes.fraction(), shapes.fraction()};
        if (shapes.between(0, 7) == 0) depth = {0.5f, 0.5f, 0.5f};
        if (shapes.between(0, 15) == 0) depth = {0.0f, 1.0f, shapes.fraction()};
        shapes::append(triangles, t, depth);
        if (shapes.between(0, 7) == 0) shapes::append(triangles, t, depth);
        // Some are drawn over what is nearer.
        if (shapes.between(0, 9) == 0 && !triangles.empty())
          triangles[triangles.size() - word::stride + word::object] |= lower::triangle_flag::over;
      }
      const Visible expected = plainly(triangles, width, height);
      const Visible actual = by_tiles(GetParam().rasterize, triangles, width, height);
      EXPECT_EQ(differences(expected, actual), 0) << kind << " at " << width << "x" << height;
    }
}

TEST_P(TileAtLanes, CutOutsMatchTheReferenceRasterizer) {
  for (const auto& [width, height] : {std::pair{64, 64}, std::pair{150, 131}, std::pair{1, 1}})
    for (const std::string kind : shapes::kinds) {
      Shapes shapes(width, height, 99u + static_cast<unsigned>(width));
      std::vector<int32_t> triangles;
      for (const auto& t : shapes.of(kind, 300)) {
        const float flat = shapes.fraction();
        const bool is_flat = shapes.between(0, 5) == 0;
        if (!shapes::append(triangles, t,
                            is_flat ? std::array{0.5f, 0.5f, 0.5f}
                                    : std::array{flat, shapes.fraction(), shapes.fraction()}))
          continue;
        int32_t& flags = triangles[triangles.size() - word::stride + word::object];
        if (shapes.between(0, 2) != 0) flags |= lower::triangle_flag::cutout;
        if (shapes.between(0, 9) == 0) flags |= lower::triangle_flag::over;
      }
      const Visible expected = plainly(triangles, width, height);
      const Visible actual = by_candidates(GetParam().rasterize, GetParam().list, triangles, width, height);
      EXPECT_EQ(differences(expected, actual), 0) << kind << " at " << width << "x" << height;
    }
}

// Depths an ULP apart, so that what is left out as hidden must be hidden in every pixel.
TEST_P(TileAtLanes, LeavesOutOnlyWhatIsHidden) {
  for (unsigned round = 0; round < 12; ++round) {
    Shapes shapes(90, 70, 31 + round);
    float steps[4] = {shapes.fraction()};
    for (int i = 1; i < 4; ++i) steps[i] = std::nextafter(steps[i - 1], 2.0f);
    const auto depth = [&] { return steps[shapes.between(0, 3)]; };
    std::vector<int32_t> triangles;
    for (int layer = 0; layer < 6; ++layer) {
      // Behind what follows, in part; then many in front of, behind and between those.
      for (const auto& t : shapes.of("general", 30)) shapes::append(triangles, t, {steps[0], depth(), steps[layer / 2]});
      for (const char* kind : {"subpixel", "small", "sliver", "on_centres"})
        for (const auto& t : shapes.of(kind, 250)) {
          const bool is_flat = shapes.between(0, 1) == 0;
          const float flat = depth();
          shapes::append(triangles, t, is_flat ? std::array{flat, flat, flat} : std::array{depth(), depth(), depth()});
          if (round % 3 == 2 && shapes.between(0, 40) == 0 && !triangles.empty())
            triangles[triangles.size() - word::stride + word::object] |= lower::triangle_flag::over;
        }
    }
    const Visible expected = plainly(triangles, 90, 70);
    EXPECT_EQ(differences(expected, by_tiles(GetParam().rasterize, triangles, 90, 70)), 0);
    for (size_t i = word::object; i < triangles.size(); i += 3 * word::stride)
      triangles[i] |= lower::triangle_flag::cutout;
    EXPECT_EQ(differences(plainly(triangles, 90, 70),
                          by_candidates(GetParam().rasterize, GetParam().list, triangles, 90, 70)),
              0);
  }
}

TEST_P(TileAtLanes, DrawsNothingWhereDepthIsNegative) {
  std::vector<int32_t> triangles;
  Shapes shapes(64, 64, 8);
  for (const char* kind : shapes::kinds)
    for (const auto& t : shapes.of(kind, 50)) shapes::append(triangles, t, {-shapes.fraction(), -0.5f, -0.0f});
  const Visible seen = by_tiles(GetParam().rasterize, triangles, 64, 64);
  for (const int32_t id : seen.ids) EXPECT_EQ(id, -1);
}

TEST_P(TileAtLanes, CoversClosedFansExactlyOnce) {
  Shapes shapes(64, 64, 7);
  for (int round = 0; round < 200; ++round) {
    const Position centre{shapes.between(2048, 14336), shapes.between(2048, 14336)};
    const int reach = round % 4 == 3 ? 2000000 : 16384;
    std::vector<int> times(tile_pixels);
    for (const auto& t : shapes.fan(centre, shapes.between(5, 12), reach / 2, reach)) {
      std::vector<int32_t> triangle;
      if (!shapes::append(triangle, t, {0.5f, 0.5f, 0.5f})) continue;
      const lanes::FpGuard guard_floats;
      Tile tile;
      tile.clear();
      const int32_t first = 0;
      GetParam().rasterize(triangle.data(), &first, 1, 0, 0, tile);
      for (int i = 0; i < tile_pixels; ++i) times[static_cast<size_t>(i)] += tile.triangles[i] >= 0;
    }
    const int around = tile_index(centre.x / 256, centre.y / 256);
    EXPECT_EQ(times[static_cast<size_t>(around)], 1);
    for (const int n : times) ASSERT_TRUE(n == 1 || (n == 0 && reach == 16384)) << n << " times";
  }
}

/// Covers all of a small image.
constexpr std::array<Position, 3> everywhere = {Position{-65536, -65536}, Position{262144, -65536},
                                                Position{-65536, 262144}};

TEST_P(TileAtLanes, EarlierTriangleWinsAtEqualDepth) {
  std::vector<int32_t> triangles;
  shapes::append(triangles, everywhere, {0.25f, 0.25f, 0.25f});
  shapes::append(triangles, everywhere, {0.25f, 0.25f, 0.25f});
  const Visible seen = by_tiles(GetParam().rasterize, triangles, 8, 8);
  for (const int32_t id : seen.ids) EXPECT_EQ(id, 0);
}

TEST_P(TileAtLanes, OverFlagDrawsOverNearerTriangles) {
  std::vector<int32_t> triangles;
  for (const float depth : {0.5f, 0.25f, 0.375f}) shapes::append(triangles, everywhere, {depth, depth, depth});
  triangles[word::stride + word::object] |= lower::triangle_flag::over;
  const Visible seen = by_tiles(GetParam().rasterize, triangles, 8, 8);
  for (const int32_t id : seen.ids) EXPECT_EQ(id, 2);  // nearer than the second, which lies over the first
  for (const float depth : seen.depth) EXPECT_EQ(depth, 0.375f);
}

TEST_P(TileAtLanes, IgnoresTrianglesAtDepthZero) {
  std::vector<int32_t> triangles;
  shapes::append(triangles, everywhere, {0, 0, 0});
  const Visible seen = by_tiles(GetParam().rasterize, triangles, 8, 8);
  for (const int32_t id : seen.ids) EXPECT_EQ(id, -1);
}

TEST_P(TileAtLanes, InterpolatesNarrowTrianglesLikeWideOnes) {
  Shapes shapes(120, 120, 99);
  std::vector<int32_t> narrow, wide;
  for (const char* kind : {"general", "small", "subpixel", "sliver", "on_centres"})
    for (const auto& t : shapes.of(kind, 300)) {
      bool fits = true;
      for (const Position p : t) fits &= p.x >= 0 && p.x < 1 << 15 && p.y >= 0 && p.y < 1 << 15;
      if (fits) shapes::append(narrow, t, {shapes.fraction(), shapes.fraction(), shapes.fraction()});
    }
  wide = narrow;
  for (size_t i = lower::triangle_word::object; i < wide.size(); i += lower::triangle_word::stride) {
    ASSERT_EQ(narrow[i] & lower::triangle_flag::wide, 0);
    wide[i] |= lower::triangle_flag::wide;
  }
  const Visible a = by_tiles(GetParam().rasterize, narrow, 128, 128);
  const Visible b = by_tiles(GetParam().rasterize, wide, 128, 128);
  EXPECT_EQ(differences(a, b), 0);
}

INSTANTIATE_TEST_SUITE_P(Raster, TileAtLanes,
                         testing::Values(Variant{4, detail::rasterize_tile_4, detail::list_candidates_4},
                                         Variant{8, detail::rasterize_tile_8, detail::list_candidates_8},
                                         Variant{16, detail::rasterize_tile_16, detail::list_candidates_16}),
                         [](const auto& info) { return std::to_string(info.param.lanes); });

// The bound that tile_lanes.h derives.
TEST(Tile, InterpolatedDepthExceedsTheNearestVertexByRoundingOnly) {
  const lanes::FpGuard guard_floats;
  std::mt19937 random(3);
  const auto bits = [&](int most) { return static_cast<int64_t>(random() & ((uint64_t{1} << most) - 1)); };
  double largest = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    float edges[3], z[3];
    for (int k = 0; k < 3; ++k) {
      edges[k] = static_cast<float>(bits(static_cast<int>(random() % 15 + 16)) * (i % 3 == 0 ? 32769 : 1));
      z[k] = std::ldexp(static_cast<float>(bits(24)), -24 - static_cast<int>(random() % 20));
    }
    if (i % 2 == 0) z[1] = z[2] = z[0];
    if (edges[0] + edges[1] + edges[2] == 0.0f) continue;
    const float nearest = std::max({z[0], z[1], z[2]});
    const float depth = functions::interpolate_depth<float>({edges[0], edges[1], edges[2]}, z[0], z[1], z[2]);
    ASSERT_LE(depth, nearest * (1.0f + 0x1p-20f));
    if (nearest > 0) largest = std::max(largest, static_cast<double>(depth) / nearest - 1);
  }
  EXPECT_GT(largest, 0x1p-24);  // it does exceed it
  EXPECT_LT(largest, 0x1p-21);
}

TEST(Tile, IndexInvertsItsCoordinates) {
  for (int i = 0; i < tile_pixels; ++i) EXPECT_EQ(tile_index(tile_x(i), tile_y(i)), i);
}

}  // namespace
}  // namespace isoshade::raster
