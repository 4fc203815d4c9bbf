// SPDX-License-Identifier: Apache-2.0
#include "runtime/environment/prefilter.h"

#include <algorithm>
#include <utility>

#include "runtime/threads/workers.h"
#include "compiler/functions/logarithm.h"
#include "runtime/raster/tile.h"
#include "runtime/scene/host_math.h"

namespace isoshade::environment {
namespace {

using threads::Workers;

/// Rays for each level of roughness from 1 on: powers of two. The lobes of the other levels are wide enough for LobeJob.
constexpr int ray_counts[] = {128, 512, 1024};
constexpr int narrow_levels = std::size(ray_counts);
/// The levels of the pyramid that wide lobes are summed over: the coarse one from this roughness on.
constexpr int fine_source = 2, coarse_source = 3;
constexpr float coarse_from = 0.5f;
/// A ray reads texels of this many times the size of its share of the lobe: rays overlap, and so the noise is low.
/// Source: Krivanek and Colbert 2008, Real-time Shading with Filtered Importance Sampling.
constexpr float ray_overlap = 4;
/// An image is read at a size of at most this many columns.
constexpr int most_columns = 2 * functions::environment_side * rays_each_way / 2;

template <class Job>
void make_rows(const Job& job, float* texels, int side, const PrefilterOptions& options) {
  const int lanes = options.lanes != 0 ? options.lanes : raster::rasterizer_lanes();
  const size_t width = static_cast<size_t>(side) + 2;
  Workers(options.threads).for_each(static_cast<size_t>(side), [&](size_t row) {
    float* const to = texels + channels * ((row + 1) * width + 1);
    const int y = static_cast<int>(row);
    switch (lanes) {
      case 16: return detail::make_row_16(job, y, to);
      case 8: return detail::make_row_8(job, y, to);
      case 4: return detail::make_row_4(job, y, to);
      default: return detail::make_row_1(job, y, to);
    }
  });
  fill_border(texels, side);
}

scene::TextureLevel bordered(int side) {
  const int width = side + 2;
  return {width, width, std::vector<float>(static_cast<size_t>(channels * width * width))};
}

/// The bits of an index in reverse order: van der Corput's sequence, times `count`.
int reversed(int index, int count) {
  int result = 0;
  for (int bit = 1; bit < count; bit *= 2, index /= 2) result = 2 * result + index % 2;
  return result;
}

/// The unit vectors of the texels of a level, and their solid angles in any unit.
std::vector<float> directions_of(int side) {
  std::vector<float> directions;
  const float size = static_cast<float>(side);
  const auto place = [&](int at) { return (static_cast<float>(at) + 0.5f) / size; };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto d = functions::octahedral_direction(lanes::vec<float, 2>(place(x), place(y)));
      const float square = (d.x * d.x + d.y * d.y) + d.z * d.z;
      const float length = lanes::sqrt(square);
      directions.insert(directions.end(), {d.x / length, d.y / length, d.z / length, 1.0f / (square * length)});
    }
  }
  return directions;
}

}  // namespace

Pyramid project(scene::TextureLevel image, float rotate, float intensity, const PrefilterOptions& options) {
  const lanes::FpGuard guard;
  while (image.width > most_columns) image = scene::half_size(image);
  for (float& value : image.texels) {
    value = value * intensity;
    value = value > 0.0f ? value : 0.0f;
    value = value < 1e6f ? value : 1e6f;
  }
  const scene::SinCos turn = scene::sin_cos_of_degrees(rotate);
  Pyramid pyramid;
  make_rows(Equirect{image.texels.data(), image.width, image.height, turn.sin, turn.cos}, pyramid.level(0),
            functions::environment_side, options);
  return pyramid;
}

std::vector<Ray> rays_of_level(int level) {
  const lanes::FpGuard guard;
  const int count = ray_counts[level - 1];
  const float alpha = functions::environment_roughness(static_cast<float>(level));
  const float square = alpha * alpha;
  constexpr float pi = 0x1.921fb6p1f;
  // The solid angle of a texel of level 0 on an axis.
  constexpr float texel = 4.0f / (static_cast<float>(functions::environment_side) * functions::environment_side);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    // The half vector by its distribution, D(h) (n.h), then the ray that it reflects. Viewed along the normal,
    // v.h = n.h, and so the density of rays is D / 4.
    const float share = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const float cosine2 = (1.0f - share) / (1.0f + (square - 1.0f) * share);
    const float along = 2.0f * cosine2 - 1.0f;
    if (!(along > 0.0f)) continue;
    const float sine2 = 1.0f - cosine2;
    const float across = 2.0f * lanes::sqrt(cosine2 * (sine2 > 0.0f ? sine2 : 0.0f));
    const float width = cosine2 * (square - 1.0f) + 1.0f;
    const float density = square / ((pi * width) * width) * 0.25f;
    const float solid_angle = ray_overlap / (static_cast<float>(count) * density);
    const scene::SinCos turn = scene::sin_cos_of_turn(reversed(i, count), count);
    rays.push_back({across * turn.cos, along, across * turn.sin, along, 0.5f * functions::log2(solid_angle / texel)});
  }
  return rays;
}

Maps prefilter(const Pyramid& source, const PrefilterOptions& options) {
  Maps maps;
  {
    const lanes::FpGuard guard;
    scene::TextureLevel& mirror = maps.emplace_back(bordered(functions::environment_side));
    std::copy_n(source.level(0), mirror.texels.size(), mirror.texels.begin());
  }
  std::vector<float> directions[Pyramid::levels], roughness;
  {
    const lanes::FpGuard guard;
    for (const int level : {fine_source, coarse_source}) directions[level] = directions_of(Pyramid::side_of(level));
    for (int level = 0; level < functions::environment_levels; ++level)
      roughness.push_back(functions::environment_roughness(static_cast<float>(level)));
  }
  const auto add_lobes = [&](float of, int level, int side) {
    scene::TextureLevel& made = maps.emplace_back(bordered(side));
    make_rows(LobeJob{source, level, directions[level], of, side}, made.texels.data(), side, options);
  };
  for (int level = 1; level < functions::environment_levels; ++level) {
    const int side = functions::environment_sides[level];
    if (level > narrow_levels) {
      const float of = roughness[static_cast<size_t>(level)];
      add_lobes(of, of < coarse_from ? fine_source : coarse_source, side);
      continue;
    }
    scene::TextureLevel& made = maps.emplace_back(bordered(side));
    const std::vector<Ray> rays = rays_of_level(level);
    make_rows(RaysJob{source, rays, side}, made.texels.data(), side, options);
  }
  add_lobes(1, fine_source, functions::irradiance_side);
  return maps;
}

}  // namespace isoshade::environment
