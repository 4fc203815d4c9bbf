// SPDX-License-Identifier: Apache-2.0
// The rows for W lanes. One file for each instruction set includes it. It calls only functions that are inlined or
// templates over the lanes, because the linker must not share code between instruction sets.
#pragma once

#include "compiler/functions/inverse_trigonometric.h"
#include "runtime/environment/rows.h"

namespace isoshade::environment::detail {

using namespace lanes;

template <int W>
struct Lanes {
  using Float = lanes::Float<W, 1>;
};
template <>
struct Lanes<1> {
  using Float = float;
};

template <class F>
using Vec3 = vec<F, 3>;
template <class F>
using Ints = int_of<F>;

/// The columns of the next lanes.
template <class F>
ISOSHADE_INLINE F columns_from(int x) {
  return to_float(lane_index<Ints<F>>() + Ints<F>(x));
}

template <class F>
ISOSHADE_INLINE Vec3<F> load_texel(FloatBuffer texels, Ints<F> word) {
  return {load(texels, word), load(texels, word + Ints<F>(1)), load(texels, word + Ints<F>(2))};
}

template <class F>
ISOSHADE_INLINE Vec3<F> between(Vec3<F> a, Vec3<F> b, F share) {
  return a * (F(1.0f) - share) + b * share;
}

/// The light of an environment is finite and not negative.
inline constexpr float most_radiance = 1e6f;

template <class F>
ISOSHADE_INLINE F limited(F radiance) {
  const F from_0 = select(radiance > F(0.0f), radiance, F(0.0f));
  return select(from_0 < F(most_radiance), from_0, F(most_radiance));
}

template <class F>
ISOSHADE_INLINE void store_texels(float* texels, int x, Vec3<F> color) {
  constexpr int count = lane_count<F>;
  float r[count], g[count], b[count];
  store_lanes(r, color.x);
  store_lanes(g, color.y);
  store_lanes(b, color.z);
  for (int i = 0; i < count; ++i) {
    float* texel = texels + channels * (x + i);
    texel[0] = r[i];
    texel[1] = g[i];
    texel[2] = b[i];
    texel[3] = 1.0f;
  }
}

/// The unit vector through the middle of a texel of a map with `side` texels a side.
template <class F>
ISOSHADE_INLINE Vec3<F> direction_of(F column, int row, int side) {
  const float size = static_cast<float>(side);
  const F u = (column + F(0.5f)) / F(size), v = F((static_cast<float>(row) + 0.5f) / size);
  const Vec3<F> d = functions::octahedral_direction(vec<F, 2>(u, v));
  const F length = sqrt((d.x * d.x + d.y * d.y) + d.z * d.z);
  return {d.x / length, d.y / length, d.z / length};
}

/// Bilinear; the columns go round, the first and the last row end.
template <class F>
ISOSHADE_INLINE Vec3<F> sample(const Equirect& image, Vec3<F> d) {
  using Int = Ints<F>;
  constexpr float turn = 0x1.921fb6p2f, half_turn = 0x1.921fb6p1f;
  const F x = d.x * F(image.cos) - d.z * F(image.sin);
  const F z = d.x * F(image.sin) + d.z * F(image.cos);
  const F u = functions::atan2(x, negate(z)) / F(turn) + F(0.5f);
  const F v = functions::atan2(sqrt(x * x + z * z), d.y) / F(half_turn);
  const int width = image.width, height = image.height;
  const F column = u * F(static_cast<float>(width)) - F(0.5f), row = v * F(static_cast<float>(height)) - F(0.5f);
  const F left = floor(column), upper = floor(row);
  const auto wrapped = [&](Int at) __attribute__((always_inline)) {
    const Int not_before = select(at < Int(0), at + Int(width), at);
    return select(not_before < Int(width), not_before, not_before - Int(width));
  };
  const auto ended = [&](Int at) __attribute__((always_inline)) {
    const Int not_before = select(at < Int(0), Int(0), at);
    return select(not_before < Int(height), not_before, Int(height - 1));
  };
  const Int x0 = wrapped(to_int(left)), x1 = wrapped(to_int(left) + Int(1));
  const FloatBuffer texels{image.texels, channels * width * height};
  const auto in_row = [&](Int y) __attribute__((always_inline)) {
    const Int first = y * Int(width);
    return between(load_texel<F>(texels, shift_left(first + x0, 2)), load_texel<F>(texels, shift_left(first + x1, 2)),
                   column - left);
  };
  return between(in_row(ended(to_int(upper))), in_row(ended(to_int(upper) + Int(1))), row - upper);
}

/// A row of level 0 of an image: the mean over the rays through each texel.
template <int W>
ISOSHADE_INLINE void project_row(const Equirect& image, int row, float* texels) {
  using F = typename Lanes<W>::Float;
  constexpr int side = functions::environment_side, fine = rays_each_way * side;
  constexpr float share = 1.0f / (rays_each_way * rays_each_way);
  for (int x = 0; x < side; x += W) {
    const F column = columns_from<F>(x) * F(static_cast<float>(rays_each_way));
    Vec3<F> sum(F(0.0f), F(0.0f), F(0.0f));
    for (int i = 0; i < rays_each_way; ++i)
      for (int k = 0; k < rays_each_way; ++k)
        sum = sum + sample(image, direction_of(column + F(static_cast<float>(k)), rays_each_way * row + i, fine));
    store_texels(texels, x, Vec3<F>(limited(sum.x * F(share)), limited(sum.y * F(share)), limited(sum.z * F(share))));
  }
}

/// Levels that differ from lane to lane, bilinear.
template <class F>
ISOSHADE_INLINE Vec3<F> read_level(FloatBuffer texels, IntBuffer firsts, Ints<F> level,
                                   vec<F, 2> place) {
  using Int = Ints<F>;
  constexpr int border = functions::environment_border;
  const Int side = shift_right(Int(functions::environment_side), level);
  const Int width = side + Int(2 * border);
  const F x = place.x * to_float(side) + F(border - 0.5f), y = place.y * to_float(side) + F(border - 0.5f);
  const F column = floor(x), row = floor(y);
  const Int corner = load(firsts, level) + shift_left(to_int(row) * width + to_int(column), 2);
  const Int next = corner + shift_left(width, 2);
  const F share = x - column;
  return between(between(load_texel<F>(texels, corner), load_texel<F>(texels, corner + Int(channels)), share),
                 between(load_texel<F>(texels, next), load_texel<F>(texels, next + Int(channels)), share), y - row);
}

/// The mean over the rays around each direction.
template <int W>
ISOSHADE_INLINE void rays_row(const RaysJob& job, int row, float* texels) {
  using F = typename Lanes<W>::Float;
  using Int = Ints<F>;
  const FloatBuffer source{job.source.texels.data(), static_cast<int>(job.source.texels.size())};
  const IntBuffer firsts{job.source.first, Pyramid::levels};
  for (int x = 0; x < job.side; x += W) {
    const Vec3<F> n = direction_of(columns_from<F>(x), row, job.side);
    // Two unit vectors across it. Source: Duff et al. 2017, Building an Orthonormal Basis, Revisited.
    const F sign = select(n.y >= F(0.0f), F(1.0f), F(-1.0f));
    const F a = F(-1.0f) / (sign + n.y);
    const F b = (n.z * n.x) * a;
    const Vec3<F> across(sign * b, negate(sign * n.z), F(1.0f) + ((sign * n.z) * n.z) * a);
    const Vec3<F> around(sign + (n.x * n.x) * a, negate(n.x), b);
    Vec3<F> sum(F(0.0f), F(0.0f), F(0.0f));
    F weights(0.0f);
    for (const Ray& ray : job.rays) {
      const F rx(ray.x), ry(ray.along), rz(ray.z);
      const Vec3<F> d((across.x * rx + around.x * rz) + n.x * ry, (across.y * rx + around.y * rz) + n.y * ry,
                      (across.z * rx + around.z * rz) + n.z * ry);
      // A texel on an axis has the least solid angle. Elsewhere it has `far`^3 times that, which is 1.5 log2(far)
      // levels; the parabola is within 0.01 of it.
      const F far = (abs(d.x) + abs(d.y)) + abs(d.z);
      const F beyond = far - F(1.0f);
      const F wanted = F(ray.level) - beyond * (F(2.16f) - beyond * F(0.733f));
      constexpr float last = Pyramid::levels - 1;
      const F from_0 = select(wanted > F(0.0f), wanted, F(0.0f));
      const F level = select(from_0 < F(last), from_0, F(last));
      const F whole = floor(level);
      const F lesser = select(whole < F(last - 1), whole, F(last - 1));
      const vec<F, 2> place = functions::octahedral_place(d);
      const Int at = to_int(lesser);
      const Vec3<F> color = between(read_level(source, firsts, at, place),
                                    read_level(source, firsts, at + Int(1), place), level - lesser);
      sum = sum + color * F(ray.weight);
      weights = weights + F(ray.weight);
    }
    store_texels(texels, x, Vec3<F>(limited(sum.x / weights), limited(sum.y / weights), limited(sum.z / weights)));
  }
}

/// The mean over the half of the sphere around each direction, weighted by GGX and the cosine, viewed along the direction.
template <int W>
ISOSHADE_INLINE void lobe_row(const LobeJob& job, int row, float* texels) {
  using F = typename Lanes<W>::Float;
  const int side = Pyramid::side_of(job.level), width = Pyramid::width_of(job.level);
  constexpr int border = functions::environment_border;
  const float* const source = job.source.level(job.level);
  const float slope = 0.5f * (job.roughness * job.roughness - 1.0f);
  for (int x = 0; x < job.side; x += W) {
    const Vec3<F> n = direction_of(columns_from<F>(x), row, job.side);
    Vec3<F> sum(F(0.0f), F(0.0f), F(0.0f));
    F weights(0.0f);
    for (int v = 0; v < side; ++v) {
      for (int u = 0; u < side; ++u) {
        const float* const d = &job.directions[static_cast<size_t>(channels * (v * side + u))];
        const float* const color = source + channels * ((v + border) * width + u + border);
        const F cosine = (n.x * F(d[0]) + n.y * F(d[1])) + n.z * F(d[2]);
        const F facing = select(cosine > F(0.0f), cosine, F(0.0f));
        const F root = (F(1.0f) + facing) * F(slope) + F(1.0f);  // (n.h)^2 (roughness^2 - 1) + 1
        const F weight = facing * F(d[3]) / (root * root);
        sum = sum + Vec3<F>(F(color[0]), F(color[1]), F(color[2])) * weight;
        weights = weights + weight;
      }
    }
    store_texels(texels, x, Vec3<F>(limited(sum.x / weights), limited(sum.y / weights), limited(sum.z / weights)));
  }
}

}  // namespace isoshade::environment::detail
