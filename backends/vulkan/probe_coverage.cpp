// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "backends/vulkan/limits.h"
#include "backends/vulkan/probe_parts.h"
#include "compiler/targets/glsl/glsl.h"
#include "runtime/raster/clip.h"

namespace isoshade::vulkan {

namespace {

using namespace lower;

constexpr int cell_rows = 2;
constexpr int subpixels = 256;
constexpr int cell_extent = cell_size * subpixels;
constexpr int first_position = -raster::max_before_image * subpixels;
constexpr int last_position = raster::max_image_size * subpixels;

/// In 1/256 pixel.
struct Point {
  int x = 0;
  int y = 0;
};
using Corners = std::array<Point, 3>;

int64_t doubled_area(const Corners& t) {
  return int64_t{t[1].x - t[0].x} * (t[2].y - t[0].y) - int64_t{t[1].y - t[0].y} * (t[2].x - t[0].x);
}

/// One triangle of a cell, of one of several kinds that rasterisers find hard.
class Shapes {
 public:
  Corners make(const Window& cell, int kind) {
    origin_ = {cell.x * subpixels, cell.y * subpixels};
    for (;;) {
      Corners corners = shape(kind);
      const int64_t area = doubled_area(corners);
      if (area == 0) continue;
      if (area < 0) std::swap(corners[1], corners[2]);
      return corners;
    }
  }
  static constexpr int kinds = 7;

  Random random{77};

 private:
  static int within_guard_band(int position) { return std::clamp(position, first_position, last_position); }
  /// A point of the cell, or up to `margin` outside of it.
  Point point(int margin) {
    const int x = within_guard_band(origin_.x + random.between(-margin, cell_extent + margin));
    return {x, within_guard_band(origin_.y + random.between(-margin, cell_extent + margin))};
  }
  Point near(Point center, int distance) {
    const int x = within_guard_band(center.x + random.between(-distance, distance));
    return {x, within_guard_band(center.y + random.between(-distance, distance))};
  }
  /// On the border of the guard band.
  Point far() {
    const int end = random.bits() % 2 != 0 ? first_position : last_position;
    const int along = random.between(first_position, last_position);
    return random.bits() % 2 != 0 ? Point{end, along} : Point{along, end};
  }
  Point on_grid(int step) {
    const Point p = point(0);
    return {p.x / step * step, p.y / step * step};
  }

  Corners shape(int kind) {
    switch (kind) {
      case 0: return {point(cell_extent), point(cell_extent), point(cell_extent)};
      case 1: {  // smaller than a pixel or two
        const Point center = point(0);
        return {near(center, 300), near(center, 300), near(center, 300)};
      }
      case 2: {  // sliver: the third corner lies almost between the others
        const Point p = point(cell_extent), q = point(cell_extent);
        return {p, q, near({p.x + (q.x - p.x) / 2, p.y + (q.y - p.y) / 2}, 3)};
      }
      case 3: return {on_grid(128), on_grid(128), on_grid(128)};  // corners and edges on pixel centres
      case 4: {                                                   // right-angled
        const Point p = on_grid(128), q = on_grid(64);
        return {p, {q.x, p.y}, q};
      }
      case 5: {  // across the guard band, one corner in the cell
        const Point p = point(0), q = far();
        return {p, q, far()};
      }
      default: {  // a long sliver through the cell
        const Point p = point(0), q = far();
        const Point beyond{within_guard_band(2 * p.x - q.x), within_guard_band(2 * p.y - q.y)};
        return {q, beyond, near(p, 100)};
      }
    }
  }

  Point origin_;
};

/// Inside, or on a top or left edge (y down), for a triangle of positive area.
bool covers(const Corners& t, Point pixel) {
  for (int i = 0; i < 3; ++i) {
    const Point& p = t[static_cast<size_t>(i)];
    const Point& q = t[static_cast<size_t>((i + 1) % 3)];
    const int64_t dx = q.x - p.x, dy = q.y - p.y;
    const int64_t edge = dx * (pixel.y - p.y) - dy * (pixel.x - p.x);
    if (edge < 0 || (edge == 0 && !(dy < 0 || (dy == 0 && dx > 0)))) return false;
  }
  return true;
}

Corners corners_of(const int32_t* triangle) {
  const int32_t* p = triangle + triangle_word::position;
  return {Point{p[0], p[1]}, Point{p[2], p[3]}, Point{p[4], p[5]}};
}

/// Nothing of it is NaN; equal depths and depth 0 are common.
uint32_t depth_bits(Random& random) {
  constexpr std::array<uint32_t, 7> common = {0x00000000, 0x00800000, 0x33800001, 0x3effffff,
                                              0x3f000000, 0x3f7fffff, 0x3f800000};
  const uint32_t bits = random.bits();
  return bits % 4 != 0 ? common[bits / 4 % common.size()] : 0x3c000000 + bits % 0x03800000;
}

/// Any float but denormals; NaN in its one form.
uint32_t color_bits(Random& random) {
  constexpr std::array<uint32_t, 6> common = {0x80000000, 0x7fc00000, 0x7f800000,
                                              0xff800000, 0x00800000, 0x7f7fffff};
  const uint32_t bits = random.bits();
  if (bits % 4 == 0) return common[bits / 4 % common.size()];
  const uint32_t exponent = bits >> 23 & 0xff;
  return exponent == 0 ? bits & 0x80000000 : exponent == 0xff ? 0x7fc00000 : bits;
}

}  // namespace

CoverageScene coverage_scene(int length, bool along_y) {
  CoverageScene scene;
  scene.width = along_y ? cell_rows * cell_size : length;
  scene.height = along_y ? length : cell_rows * cell_size;
  Shapes shapes;
  uint32_t triangles = 0;
  for (int y = 0; y + cell_size <= scene.height; y += cell_size) {
    for (int x = 0; x + cell_size <= scene.width; x += cell_size) {
      const Window area{x, y, cell_size, cell_size};
      const auto number = static_cast<int>(scene.cells.size());
      const uint32_t count = number % 3 == 2 ? 2 : 1;
      scene.cells.push_back({area, triangles, count});
      for (uint32_t i = 0; i < count; ++i) {
        const Corners corners = shapes.make(area, (number + static_cast<int>(i)) % Shapes::kinds);
        std::array<int32_t, triangle_word::stride> record{};
        for (size_t k = 0; k < 3; ++k) {
          record[triangle_word::position + 2 * k] = corners[k].x;
          record[triangle_word::position + 2 * k + 1] = corners[k].y;
        }
        scene.triangles.insert(scene.triangles.end(), record.begin(), record.end());
        scene.values.push_back(static_cast<int32_t>(depth_bits(shapes.random)));
        for (int k = 0; k < 4; ++k) scene.values.push_back(static_cast<int32_t>(color_bits(shapes.random)));
      }
      triangles += count;
    }
  }
  return scene;
}

backends::Image expected_image(const CoverageScene& scene, const float (&background)[4]) {
  backends::Image image;
  image.resize(scene.width, scene.height);
  for (size_t i = 0; i < image.depth.size(); ++i)
    std::copy(std::begin(background), std::end(background),
              image.rgba.begin() + static_cast<ptrdiff_t>(4 * i));
  for (const Cell& cell : scene.cells) {
    for (uint32_t t = cell.first; t < cell.first + cell.count; ++t) {
      const Corners corners = corners_of(scene.triangles.data() + size_t{t} * triangle_word::stride);
      const int32_t* value = scene.values.data() + size_t{t} * value_stride;
      for (int y = cell.area.y; y < cell.area.y + cell.area.height; ++y) {
        for (int x = cell.area.x; x < cell.area.x + cell.area.width; ++x) {
          if (!covers(corners, {x * subpixels + subpixels / 2, y * subpixels + subpixels / 2})) continue;
          const size_t pixel =
              static_cast<size_t>(y) * static_cast<size_t>(scene.width) + static_cast<size_t>(x);
          // Depths are not negative, so their bits are ordered as they are.
          int32_t nearest = 0;
          std::memcpy(&nearest, &image.depth[pixel], sizeof(nearest));
          if (value[0] <= nearest) continue;
          std::memcpy(&image.depth[pixel], value, sizeof(float));
          std::memcpy(&image.rgba[4 * pixel], value + 1, 4 * sizeof(float));
        }
      }
    }
  }
  return image;
}

namespace {

std::string head() {
  return glsl::head() +
         "layout(std430, set = 0, binding = " + std::to_string(static_cast<int>(FrameBuffer::inputs)) +
         ") readonly buffer inputs_block { int inputs[]; };\n"
         "layout(push_constant) uniform Push {\n"
         "  int object; int light_count; int program; int first; int count; int width;\n"
         "  int origin_x; int origin_y;\n} push;\n" +
         R"(
int pixel_here() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  bool centre = gl_FragCoord.x == float(at.x) + 0.5 && gl_FragCoord.y == float(at.y) + 0.5;
  at += ivec2(push.origin_x, push.origin_y);
  return centre ? at.x + at.y * push.width : 0x7ffff;
}
)";
}

}  // namespace

std::string coverage_visibility_glsl() {
  return head() + R"(
layout(location = 0) flat in int triangle;
layout(location = 0) out int id;

void main() {
  gl_FragDepth = intBitsToFloat(inputs[5 * triangle]);
  id = (triangle + 1) | (pixel_here() << 12);
}
)";
}

std::string coverage_color_glsl() {
  return head() + "layout(set = 0, binding = " + std::to_string(ids_binding) + R"() uniform isampler2D ids;
layout(location = 0) out vec4 color;

void main() {
  int id = texelFetch(ids, ivec2(gl_FragCoord.xy), 0).x;
  if (id == 0) discard;
  int value = 5 * ((id & 0xfff) - 1);
  bool here = id >> 12 == pixel_here();
  color = !here ? vec4(-1.0) : intBitsToFloat(
      ivec4(inputs[value + 1], inputs[value + 2], inputs[value + 3], inputs[value + 4]));
}
)";
}

}  // namespace isoshade::vulkan
