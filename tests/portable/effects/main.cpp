// SPDX-License-Identifier: Apache-2.0
//
// effects RESULTS: shades the points of a part of a sphere with each of three effects and writes the colours.
#include <cstdio>

#include "points.h"

namespace program {
namespace {

using Point = std::vector<float>;

/// Columns of one point. x and y may be side, for changes to the next point.
Point point_at(int x, int y) {
  const float u = to_float(x) / 64.0f, v = to_float(y) / 64.0f;
  const float across = u * 1.2f - 0.6f, down = v * 1.2f - 0.6f;
  const float up = sqrt(1.0f - across * across - down * down), along = sqrt(up * up + across * across);
  const vec3<float> n(across, negate(down), up), view(0.0f, 0.6f, 0.8f);
  const vec3<float> t(up / along, 0.0f, negate(across) / along);
  const vec3<float> b(n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x);
  return {n.x, n.y, n.z, n.x, n.y,  n.z, view.x, view.y, view.z, t.x, t.y,
          t.z, b.x, b.y, b.z, 1.0f, u,   v,      1.0f,   u,      v,   v,   u};
}

Attributes attributes_of_sphere() {
  Attributes all;
  for (std::vector<float>* columns : {&all.values, &all.ddx, &all.ddy})
    columns->resize(static_cast<size_t>(Attributes::width * points));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Point here = point_at(x, y), right = point_at(x + 1, y), below = point_at(x, y + 1);
      for (int column = 0; column < Attributes::width; ++column) {
        const int at = column * points + y * side + x;
        all.values[at] = here[column];
        all.ddx[at] = right[column] - here[column];
        all.ddy[at] = below[column] - here[column];
      }
    }
  return all;
}

Images images() {
  Images made;
  for (int image = 0; image < Images::count; ++image)
    for (int y = 0; y < Images::side; ++y)
      for (int x = 0; x < Images::side; ++x) {
        const float red = to_float((x * 7 + y * 3 + image) & 15) / 15.0f,
                    green = to_float((x ^ y) & 15) / 15.0f;
        made.texels.insert(made.texels.end(), {red, green, to_float(x) / 15.0f, 1.0f});
      }
  return made;
}

}  // namespace
}  // namespace program

int main(int, char** arguments) {
  using namespace program;
  const FpGuard guard;
  const Attributes attributes = attributes_of_sphere();
  const Images made = images();
  const Host host(made);
  std::vector<float> rgba(3 * 4 * points);
  shade_cook_torrance(attributes, host, rgba.data());
  shade_cartoon(attributes, host, rgba.data() + 4 * points);
  shade_gltf_pbr(attributes, host, rgba.data() + 8 * points);
  FILE* out = std::fopen(arguments[1], "wb");
  if (out == nullptr) return 2;
  std::fwrite(rgba.data(), sizeof(float), rgba.size(), out);
  return std::fclose(out);
}
