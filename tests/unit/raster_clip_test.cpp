// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/clip.h"
#include "runtime/raster/reference.h"

namespace isoshade::raster {
namespace {

using interface::Cull;

namespace word = lower::triangle_word;
constexpr int stride = lower::vertex_word::stride;

struct Clipped {
  support::Array<float> vertices;
  support::Array<int32_t> triangles;

  int count() const { return static_cast<int>(triangles.size() / word::stride); }
  int at(int triangle, int field) const {
    return triangles[static_cast<size_t>(triangle * word::stride + field)];
  }
  float number(int triangle, int field) const { return std::bit_cast<float>(at(triangle, field)); }
};

void clip_and_snap(const Surface& surface, int width, int height, support::Array<float>& vertices,
                   support::Array<int32_t>& triangles) {
  threads::Workers workers(1);
  Clipper().run({&surface, 1}, width, height, workers, vertices, triangles);
}

/// Attributes are the clip-space position and zeros, so that what clipping makes can be checked.
Clipped run(const std::vector<float>& clip, const std::vector<uint32_t>& indices, Cull cull, int width,
            int height) {
  Clipped result;
  for (size_t i = 0; i + 3 < clip.size(); i += 4) {
    result.vertices.insert(result.vertices.end(), clip.begin() + static_cast<ptrdiff_t>(i),
                           clip.begin() + static_cast<ptrdiff_t>(i) + 4);
    result.vertices.insert(result.vertices.end(), stride - 4, 0.0f);
  }
  Surface surface;
  surface.clip = clip;
  surface.indices = indices;
  surface.state.cull = cull;
  surface.object = 40;
  clip_and_snap(surface, width, height, result.vertices, result.triangles);
  return result;
}

std::vector<int> times_covered(const Clipped& clipped, int width, int height) {
  std::vector<int> times(static_cast<size_t>(width) * height);
  std::vector<int32_t> ids(times.size());
  std::vector<float> depth(times.size());
  for (int i = 0; i < clipped.count(); ++i) {
    std::vector<int32_t> one(clipped.triangles.begin() + i * word::stride,
                             clipped.triangles.begin() + (i + 1) * word::stride);
    for (int k = 0; k < 3; ++k) one[static_cast<size_t>(word::depth + k)] = std::bit_cast<int32_t>(1.0f);
    rasterize_reference(one, box_at(0, 0, width, height), ids, depth);
    for (size_t p = 0; p < ids.size(); ++p) times[p] += ids[p] == 0;
  }
  return times;
}

const std::vector<uint32_t> one_triangle = {0, 1, 2};

// The corners of a 4x2 image are at +-1; a pixel is 256 units wide, y turns to point down.
TEST(ClipAndSnap, SnapsVerticesToTheGrid) {
  const Clipped result =
      run({-1, 1, 0.5f, 1, /**/ -1, -1, 0.25f, 1, /**/ 2, 2, 0.5f, 2}, one_triangle, Cull::back, 4, 2);
  ASSERT_EQ(result.count(), 1);
  const std::array<int, 6> positions = {0, 0, 1024, 0, 0, 512};  // wound the other way: y points down
  for (int i = 0; i < 6; ++i) EXPECT_EQ(result.at(0, word::position + i), positions[static_cast<size_t>(i)]);
  const std::array<int, 3> vertices = {0, 2, 1};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(result.at(0, word::vertex + i), vertices[static_cast<size_t>(i)]);
  EXPECT_EQ(result.number(0, word::depth), 0.5f);
  EXPECT_EQ(result.number(0, word::depth + 1), 0.25f);
  EXPECT_EQ(result.number(0, word::depth + 2), 0.25f);
  EXPECT_EQ(result.number(0, word::inverse_w), 1.0f);
  EXPECT_EQ(result.number(0, word::inverse_w + 1), 0.5f);
  EXPECT_EQ(result.at(0, word::object), 40 << lower::triangle_flag::bits);
}

TEST(ClipAndSnap, FlagsBackFacesMirroredOnesAndCutOuts) {
  const std::vector<float> clip = {-1, -1, 0.5f, 1, 1, -1, 0.5f, 1, -1, 1, 0.5f, 1};
  namespace flag = lower::triangle_flag;
  const auto flags = [&](std::vector<uint32_t> indices, bool mirrored, bool cutout) {
    support::Array<float> vertices(3 * stride);
    support::Array<int32_t> triangles;
    Surface surface;
    surface.clip = clip;
    surface.indices = indices;
    surface.state.cull = Cull::none;
    surface.mirrored = mirrored;
    surface.cutout = cutout;
    clip_and_snap(surface, 8, 8, vertices, triangles);
    return triangles.at(word::object);
  };
  EXPECT_EQ(flags({0, 1, 2}, false, false), 0);
  EXPECT_EQ(flags({0, 2, 1}, false, false), flag::back);
  EXPECT_EQ(flags({0, 1, 2}, true, false), flag::back);
  EXPECT_EQ(flags({0, 2, 1}, true, true), flag::cutout);
  EXPECT_EQ(flags({0, 2, 1}, false, true), flag::back | flag::cutout);
}

TEST(ClipAndSnap, MirroredSurfacesCullTheOtherWinding) {
  const std::vector<float> clip = {-1, -1, 0.5f, 1, 1, -1, 0.5f, 1, -1, 1, 0.5f, 1};
  for (const Cull cull : {Cull::back, Cull::front})
    for (const bool turned : {false, true}) {
      support::Array<float> vertices(3 * stride);
      support::Array<int32_t> triangles;
      const std::vector<uint32_t> indices = turned ? std::vector<uint32_t>{0, 2, 1} : one_triangle;
      Surface surface;
      surface.clip = clip;
      surface.indices = indices;
      surface.state.cull = cull;
      surface.mirrored = true;
      clip_and_snap(surface, 8, 8, vertices, triangles);
      EXPECT_EQ(triangles.empty(), turned == (cull == Cull::front)) << turned;
    }
}

TEST(ClipAndSnap, CutsAtTheFarPlane) {
  // Depth falls from 0.5 at the left edge to -0.5 at the right one: it is 0 in the middle, and 0.25 halfway there.
  const Clipped result =
      run({-1, 3, 0.5f, 1, -1, -3, 0.5f, 1, 1, 0, -0.5f, 1}, one_triangle, Cull::none, 8, 8);
  ASSERT_EQ(result.count(), 2);
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) {
      const int x = result.at(i, word::position + 2 * k);
      EXPECT_LE(x, 4 * 256);
      EXPECT_EQ(result.number(i, word::depth + k), 0.5f - 0.125f * static_cast<float>(x) / 256);
    }
  EXPECT_EQ(run({-1, 1, -0.5f, 1, -1, -1, -0.1f, 1, 1, 0, -0.5f, 1}, one_triangle, Cull::none, 8, 8).count(), 0);
}

TEST(ClipAndSnap, BiasMovesATriangleAwayByItsSlope) {
  // Depth grows by 1/16 a pixel to the right and falls by 1/32 a pixel downwards.
  const std::vector<float> clip = {-1, 1, 0.25f, 1, 1, 1, 0.75f, 1, -1, -1, 0, 1};
  const auto depths = [&](DepthBias bias) {
    support::Array<float> vertices(3 * stride);
    support::Array<int32_t> triangles;
    Surface surface;
    surface.clip = clip;
    surface.indices = one_triangle;
    surface.state.cull = Cull::none;
    surface.bias = bias;
    clip_and_snap(surface, 8, 8, vertices, triangles);
    std::multiset<float> found;
    for (int i = 0; i < 3; ++i) found.insert(std::bit_cast<float>(triangles.at(static_cast<size_t>(word::depth + i))));
    return found;
  };
  EXPECT_EQ(depths({}), (std::multiset<float>{0, 0.25f, 0.75f}));
  EXPECT_EQ(depths({2, 0, 0}), (std::multiset<float>{-0.1875f, 0.0625f, 0.5625f}));
  EXPECT_EQ(depths({0, 0.5f, 0}), (std::multiset<float>{0, 0.125f, 0.375f}));
  EXPECT_EQ(depths({0, 0, 0.125f}), (std::multiset<float>{-0.125f, 0.125f, 0.625f}));
}

TEST(ClipAndSnap, RoundsTiesToEven) {
  // A 2x2 image: x in units is 256 * x + 256.
  const auto snapped = [](float unit) {
    const Clipped result = run({(unit - 256) / 256, 1, 0.5f, 1, -1, -1, 0.5f, 1, 1, -1, 0.5f, 1},
                               one_triangle, Cull::none, 2, 2);
    return result.at(0, word::position);
  };
  EXPECT_EQ(snapped(10.5f), 10);
  EXPECT_EQ(snapped(11.5f), 12);
  EXPECT_EQ(snapped(11.25f), 11);
  EXPECT_EQ(snapped(-10.5f), -10);
  EXPECT_EQ(snapped(-11.5f), -12);
}

TEST(ClipAndSnap, CullsByFacing) {
  const std::vector<float> clip = {-1, -1, 0.5f, 1, 1, -1, 0.5f, 1, 0, 1, 0.5f, 1};  // counter-clockwise
  EXPECT_EQ(run(clip, {0, 1, 2}, Cull::back, 16, 16).count(), 1);
  EXPECT_EQ(run(clip, {0, 1, 2}, Cull::front, 16, 16).count(), 0);
  EXPECT_EQ(run(clip, {0, 2, 1}, Cull::back, 16, 16).count(), 0);
  EXPECT_EQ(run(clip, {0, 2, 1}, Cull::front, 16, 16).count(), 1);
  EXPECT_EQ(run(clip, {0, 1, 2, 0, 2, 1}, Cull::none, 16, 16).count(), 2);
  EXPECT_EQ(run(clip, {0, 1, 1}, Cull::none, 16, 16).count(), 0);
}

TEST(ClipAndSnap, DropsNonFiniteTriangles) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity()};
  for (int component = 0; component < 4; ++component)
    for (const float value : bad) {
      std::vector<float> clip = {-1, -1, 0.5f, 1, 1, -1, 0.5f, 1, 0, 1, 0.5f, 1};
      clip[static_cast<size_t>(4 + component)] = value;
      EXPECT_EQ(run(clip, {0, 1, 2, 0, 2, 1}, Cull::none, 16, 16).count(), 0) << component << " " << value;
    }
}

TEST(ClipAndSnap, DropsTrianglesThatCoverNoPixelCentre) {
  EXPECT_EQ(run({-1, -1, 0.5f, 1, -0.95f, -1, 0.5f, 1, -1, -0.95f, 0.5f, 1}, one_triangle, Cull::none, 16, 16)
                .count(),
            0);
  EXPECT_EQ(run({2, 2, 0.5f, 1, 3, 2, 0.5f, 1, 2, 3, 0.5f, 1}, one_triangle, Cull::none, 16, 16).count(), 0);
}

TEST(ClipAndSnap, NearPlaneVerticesHaveDepthOne) {
  // One vertex behind a camera with its near plane at 0.25; x and w are equally far.
  const Clipped perspective =
      run({-1, -1, 0.25f, 1, 1, -1, 0.25f, 1, 0, 3, 0.25f, -2}, one_triangle, Cull::none, 16, 16);
  ASSERT_GE(perspective.count(), 1);
  int near = 0;
  for (int i = 0; i < perspective.count(); ++i)
    for (int k = 0; k < 3; ++k)
      if (perspective.at(i, word::vertex + k) >= 3) {
        ++near;
        EXPECT_EQ(perspective.number(i, word::depth + k), 1.0f);
        EXPECT_EQ(perspective.number(i, word::inverse_w + k), 4.0f);
      }
  EXPECT_GE(near, 2);

  const Clipped flat =
      run({-1, -1, 0.3f, 1, 1, -1, 0.7f, 1, 0.1f, 1, 1.9f, 1}, one_triangle, Cull::none, 16, 16);
  ASSERT_EQ(flat.count(), 2);
  for (int i = 0; i < flat.count(); ++i)
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(flat.number(i, word::inverse_w + k), 1.0f);
      if (flat.at(i, word::vertex + k) >= 3) { EXPECT_EQ(flat.number(i, word::depth + k), 1.0f); }
    }
}

TEST(ClipAndSnap, InterpolatesAttributesAtCuts) {
  const Clipped result =
      run({-1, -1, 0.25f, 1, 1, -1, 0.25f, 2, 0.5f, 1, 0.25f, -2}, one_triangle, Cull::none, 16, 16);
  ASSERT_EQ(result.vertices.size(), 5u * stride);
  for (size_t i = 3 * stride; i < result.vertices.size(); i += stride) {
    const float* made = result.vertices.data() + i;
    EXPECT_EQ(made[2], 0.25f);           // constant, so kept to the bit
    EXPECT_NEAR(made[3], 0.25f, 1e-6f);  // w of the near plane
    EXPECT_GT(made[0], -1);
    EXPECT_LT(made[0], 1);
  }
}

TEST(ClipAndSnap, DoesNotClipVerticesOutsideTheImage) {
  const Clipped result =
      run({-9, -9, 0.5f, 1, 9, -9, 0.5f, 1, 0, 9, 0.5f, 1}, one_triangle, Cull::none, 64, 64);
  EXPECT_EQ(result.count(), 1);
  EXPECT_EQ(result.vertices.size(), 3u * stride);
}

TEST(ClipAndSnap, KeepsPositionsWithinTheGuardBand) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> wide(-1e6f, 1e6f), depth(0.0f, 1.0f);
  for (const int size : {1, 64, 1000, 8191, 8192})
    for (int i = 0; i < 2000; ++i) {
      std::vector<float> clip;
      for (int k = 0; k < 3; ++k)
        clip.insert(clip.end(), {wide(random), wide(random), depth(random), wide(random)});
      const Clipped result = run(clip, one_triangle, Cull::none, size, size);
      for (int t = 0; t < result.count(); ++t)
        for (int k = 0; k < 6; ++k) {
          ASSERT_GE(result.at(t, word::position + k), -256 * max_before_image - 1);
          ASSERT_LE(result.at(t, word::position + k), 1 << 21);
        }
    }
}

TEST(ClipAndSnap, MarksTrianglesThatNeedWideProducts) {
  const auto wide = [](float width) {
    const float x = width / 512 - 1;  // of 1024 pixels
    const Clipped result =
        run({-1, 1, 0.5f, 1, x, 1, 0.5f, 1, x, 0.9f, 0.5f, 1}, one_triangle, Cull::none, 1024, 1024);
    return result.at(0, word::object) & lower::triangle_flag::wide;
  };
  EXPECT_EQ(wide(127), 0);
  EXPECT_EQ(wide(128), 1);
  EXPECT_EQ(wide(129), 1);
}

TEST(ClipAndSnap, CoversTheLastPixelOfTheLargestImage) {
  const int size = max_image_size;
  const Clipped result =
      run({-3, -3, 0.5f, 1, 5, -3, 0.5f, 1, -3, 5, 0.5f, 1}, one_triangle, Cull::none, size, size);
  for (const auto& [x, y] :
       {std::pair{0, 0}, std::pair{size - 1, size - 1}, std::pair{0, size - 1}, std::pair{size - 1, 0}}) {
    int covered = 0;
    for (int i = 0; i < result.count(); ++i) {
      // The reference draws the one pixel that is left when everything moves by whole pixels.
      std::vector<int32_t> moved(result.triangles.begin() + i * word::stride,
                                 result.triangles.begin() + (i + 1) * word::stride);
      for (int k = 0; k < 3; ++k) {
        moved[static_cast<size_t>(word::position + 2 * k)] -= x * 256;
        moved[static_cast<size_t>(word::position + 2 * k + 1)] -= y * 256;
      }
      int32_t id = -1;
      float depth = 0;
      rasterize_reference(moved, box_at(0, 0, 1, 1), {&id, 1}, {&depth, 1});
      covered += id == 0;
    }
    EXPECT_EQ(covered, 1) << x << " " << y;
  }
}

/// A floor under the camera that reaches far behind it and out of every guard plane, in a perspective with
/// the near plane at 0.1: its grid of vertices is shaken, so that edges cross the planes everywhere.
struct Floor {
  std::vector<float> clip;
  std::vector<uint32_t> indices;

  Floor(int cells, unsigned seed, float tilt) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> shake(-0.45f, 0.45f);
    const float step = 4000.0f / static_cast<float>(cells);
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const bool rim = i == 0 || j == 0 || i == cells || j == cells;
        const float x =
            (static_cast<float>(i) - static_cast<float>(cells) / 2 + (rim ? 0 : shake(random))) * step;
        const float z =
            (static_cast<float>(j) - static_cast<float>(cells) / 2 + (rim ? 0 : shake(random))) * step;
        const float y = -1.5f + tilt * x * 1e-3f;
        clip.insert(clip.end(), {x, y, 0.1f, z});
      }
    const auto at = [&](int i, int j) { return static_cast<uint32_t>(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i)
        indices.insert(indices.end(),
                       {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
  }
};

TEST(ClipAndSnap, CoversAFloorThroughTheNearPlaneExactlyOnce) {
  const int width = 160, height = 120;
  for (const int cells : {1, 2, 7, 40})
    for (const float tilt : {0.0f, 0.4f}) {
      const Floor floor(cells, static_cast<unsigned>(cells), tilt);
      // Where snapping turns a sliver over it counts against what it overlaps: in all, each pixel is hit
      // once.
      const Clipped front = run(floor.clip, floor.indices, Cull::back, width, height);
      const Clipped back = run(floor.clip, floor.indices, Cull::front, width, height);
      const std::vector<int> more = times_covered(front, width, height),
                             less = times_covered(back, width, height);
      // The floor ends 2000 away, a hair below the horizon; leave that row and its neighbours out.
      for (int y = height / 2 + 2; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const size_t p = static_cast<size_t>(y) * width + x;
          ASSERT_EQ(std::abs(more[p] - less[p]), 1)
              << cells << " cells, tilt " << tilt << ", pixel " << x << " " << y;
        }
      for (int y = 0; y < height / 2 - 2; ++y)
        for (int x = 0; x < width; ++x) {
          const size_t p = static_cast<size_t>(y) * width + x;
          ASSERT_EQ(more[p] - less[p], 0) << cells << " cells, tilt " << tilt << ", pixel " << x << " " << y;
        }
    }
}

TEST(ClipAndSnap, CutsSharedEdgesIdenticallyFromBothSides) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> any(-3.0f, 3.0f);
  int cut = 0;
  for (int i = 0; i < 500; ++i) {
    // Vertices 0 and 1 are shared; two others lie anywhere.
    std::vector<float> clip;
    for (int k = 0; k < 4; ++k) clip.insert(clip.end(), {any(random), any(random), 0.1f, any(random)});
    if ((clip[3] < 0.1f) == (clip[7] < 0.1f)) continue;
    const auto made = [&](const std::vector<uint32_t>& indices) {
      std::set<std::array<uint32_t, 4>> points;
      const Clipped result = run(clip, indices, Cull::none, 64, 64);
      for (size_t v = 4 * stride; v < result.vertices.size(); v += stride) {
        std::array<uint32_t, 4> point;
        for (size_t k = 0; k < 4; ++k) point[k] = std::bit_cast<uint32_t>(result.vertices[v + k]);
        points.insert(point);
      }
      return points;
    };
    const auto one = made({0, 1, 2}), other = made({1, 0, 3});
    if (one.empty() || other.empty()) continue;
    int common = 0;
    for (const auto& point : one) common += static_cast<int>(other.count(point));
    EXPECT_GE(common, 1);
    ++cut;
  }
  EXPECT_GT(cut, 50);
}

}  // namespace
}  // namespace isoshade::raster
