// SPDX-License-Identifier: Apache-2.0
//
// A program that links three effects: its points, its lights and images, and how it runs a shader over them.
#pragma once

#include <vector>

#include "isoshade/lanes/host.h"
#include "isoshade/lanes/lanes.h"

namespace program {

using namespace isoshade::lanes;

#if defined(ISOSHADE_LANES) && ISOSHADE_LANES > 1
using F = Float<ISOSHADE_LANES, 1>;
#else
using F = float;
#endif

inline constexpr int side = 64, points = side * side;

/// What a surface has at each point: columns of numbers, one for each component.
struct Attributes {
  enum Column {
    position = 0,
    normal = 3,
    view_direction = 6,
    tangent = 9,
    bitangent = 12,
    color = 15,
    texcoord = 19,
    texcoord1 = 21
  };
  static constexpr int width = 23;

  std::vector<float> values, ddx, ddy;  ///< and the changes to the next point in x and y
};

/// Images of 16 x 16 texels or less. Image 0 has the four mip levels 1 to 4, image 5 is a row.
struct Images {
  static constexpr int side = 16, count = 6;
  std::vector<float> texels;  ///< count * side * side of four
};

/// Two lights, one far away and one near, an environment and the images.
class Host {
 public:
  explicit Host(const Images& images)
      : texels_{images.texels.data(), static_cast<int>(images.texels.size())} {}

  int light_count() const { return 2; }

  template <class T>
  isoshade::Light<T> light(int index, vec3<T> position) const {
    if (index == 0) return {vec3<T>(T(0.6f), T(0.0f), T(0.8f)), vec3<T>(T(1.0f), T(0.9f), T(0.75f))};
    const vec3<T> way = vec3<T>(T(-1.0f), T(2.0f), T(3.0f)) - position;
    const T square = way.x * way.x + way.y * way.y + way.z * way.z;
    return {way / sqrt(square), vec3<T>(T(4.0f)) / square};
  }

  /// By the difference over a small step: what a shader makes of it does not matter here, only that it is the same.
  template <class T>
  isoshade::Light<T> light_change(int index, vec3<T> position, vec3<T> change) const {
    const isoshade::Light<T> here = light(index, position), there = light(index, position + change);
    return {there.direction - here.direction, there.color - here.color};
  }

  bool has_environment() const { return true; }
  template <class T>
  vec3<T> environment(vec3<T> direction, T roughness) const {
    return direction * vec3<T>(roughness) + vec3<T>(T(1.25f));
  }
  template <class T>
  vec3<T> irradiance(vec3<T> direction) const {
    return direction * vec3<T>(T(0.25f)) + vec3<T>(T(0.5f));
  }

  int pass_index() const { return 2; }
  int pass_count() const { return 5; }

  template <class I>
  vec4<float_of<I>> texel(I image, I x, I y) const {
    const I at = ((image * Images::side + y) * Images::side + x) * 4;
    return {load(texels_, at), load(texels_, at + 1), load(texels_, at + 2), load(texels_, at + 3)};
  }

  template <class I>
  isoshade::ImageSize<I> image_size(I image) const {
    const I size = shift_right(I(Images::side), image & 7);
    return {select(image == 5, I(16), size), select(image == 5, I(1), size),
            select(image == 5, I(0), I(4) - image)};
  }

  template <class I>
  I image_layer(I image, I) const {
    return image;
  }

 private:
  FloatBuffer texels_;
};

template <class Vector>
Vector vector_at(const std::vector<float>& columns, int first, int point) {
  const auto component = [&](int i) { return load_lanes<F>(columns.data() + (first + i) * points + point); };
  if constexpr (requires(Vector v) { v.w; })
    return {component(0), component(1), component(2), component(3)};
  else if constexpr (requires(Vector v) { v.z; })
    return {component(0), component(1), component(2)};
  else
    return {component(0), component(1)};
}

/// The fields that the effect's struct Surface has.
template <class Surface>
Surface surface_at(const Attributes& attributes, int point) {
  Surface surface;
  unsigned long bytes = 0;
#define FIELD(name, columns, from)                                                      \
  if constexpr (requires { surface.name; }) {                                           \
    surface.name = vector_at<decltype(surface.name)>(columns, Attributes::from, point); \
    bytes += sizeof surface.name;                                                       \
  }
#define FIELDS(name)                      \
  FIELD(name, attributes.values, name)    \
  FIELD(name##_ddx, attributes.ddx, name) \
  FIELD(name##_ddy, attributes.ddy, name)
  FIELDS(position)
  FIELDS(normal)
  FIELDS(view_direction)
  FIELDS(tangent)
  FIELDS(bitangent)
  FIELDS(color)
  FIELDS(texcoord)
  FIELDS(texcoord1)
#undef FIELDS
#undef FIELD
  if constexpr (requires { surface.front_facing; }) {
    surface.front_facing = vector_at<vec3<F>>(attributes.values, Attributes::position, point).x >= F(-0.4f);
    // With what pads it.
    bytes += sizeof surface.front_facing < sizeof(float) ? sizeof(float) : sizeof surface.front_facing;
  }
  if (bytes != sizeof surface)
    __builtin_trap();  // the effect needs an attribute that this program does not know
  return surface;
}

/// Shades all points: four floats each.
template <class Surface, class Shade>
void shade_points(const Attributes& attributes, Shade shade, float* rgba) {
  const FpGuard guard;
  for (int point = 0; point < points; point += lane_count<F>) {
    const vec4<F> color = shade(surface_at<Surface>(attributes, point));
    float words[4][lane_count<F>];
    store_lanes(words[0], color.x);
    store_lanes(words[1], color.y);
    store_lanes(words[2], color.z);
    store_lanes(words[3], color.w);
    for (int lane = 0; lane < lane_count<F>; ++lane)
      for (int word = 0; word < 4; ++word) rgba[4 * (point + lane) + word] = words[word][lane];
  }
}

void shade_cook_torrance(const Attributes& attributes, const Host& host, float* rgba);
void shade_cartoon(const Attributes& attributes, const Host& host, float* rgba);
void shade_gltf_pbr(const Attributes& attributes, const Host& host, float* rgba);

}  // namespace program
