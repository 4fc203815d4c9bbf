// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/shadows.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "runtime/scene/host_math.h"

namespace isoshade::render {
namespace {

using glm::vec3;

/// The widest spot that one map shows: the outer angle in degrees.
constexpr float widest_cone = 60;
/// Part of the scene's size at which a point light or a spot begins to see.
constexpr float near_part = 0.0009765625f;  // 2^-10
/// How far vertices may be moved without losing their shadow under a directional light, in sizes of the scene.
constexpr float moved_sizes = 2;
/// Deeper maps of directional lights gain nothing: their numbers would become denormal.
constexpr float most_depths = 1.8446744e19f;  // 2^64
/// Enlarges what a light looks at, against rounding.
constexpr float slack = 0.001f;

/// The smallest box along the axes around points.
struct Bounds {
  vec3 low{INFINITY}, high{-INFINITY};
  void add(const vec3& point) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], point[i]);
      high[i] = std::max(high[i], point[i]);
    }
  }
  void add(const Bounds& more) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], more.low[i]);
      high[i] = std::max(high[i], more.high[i]);
    }
  }
  bool empty() const { return !(low.x <= high.x); }
  /// The longest side.
  float largest() const {
    const vec3 sides = high - low;
    return std::max({sides.x, sides.y, sides.z, 1e-6f});
  }
  /// The corners of a box that is larger by `sizes` times the longest side in each direction.
  std::array<vec3, 8> widened(float sizes) const {
    const vec3 margin(sizes * largest());
    return corners_of(low - margin, high + margin, 0, glm::mat4(1));
  }
};

/// Calls make(hull, bounds) for all hulls, on all threads, and joins the bounds in their order.
template <class Make>
Bounds bounds_over(std::span<const Hull> hulls, threads::Workers& workers, const Make& make) {
  constexpr size_t task = 256;
  std::vector<Bounds> parts((hulls.size() + task - 1) / task);
  const auto one = [&](size_t p) {
    for (const Hull& hull : hulls.subspan(p * task, std::min(task, hulls.size() - p * task))) make(hull, parts[p]);
  };
  if (parts.size() > 1)
    workers.for_each(parts.size(), one);
  else if (!parts.empty())
    one(0);
  Bounds all;
  for (const Bounds& part : parts) all.add(part);
  return all;
}

/// The box around everything.
Bounds bounds_of(std::span<const Hull> hulls, threads::Workers& workers) {
  return bounds_over(hulls, workers, [](const Hull& hull, Bounds& bounds) {
    for (const vec3& corner : hull.corners) bounds.add(corner);
  });
}

/// A plane through the eye, or along the view: distance(p) = dot(normal, p) + offset, not negative inside.
struct Plane {
  vec3 normal;
  float offset;
  float distance(const vec3& p) const { return scene::dot(normal, p) + offset; }
};

/// The four sides of what the picture shows.
std::array<Plane, 4> sides_of(const glm::mat4& projection) {
  const auto row = [&](int r) {
    return glm::vec4(projection[0][r], projection[1][r], projection[2][r], projection[3][r]);
  };
  const auto plane = [](const glm::vec4& v) { return Plane{vec3(v.x, v.y, v.z), v.w}; };
  const glm::vec4 w = row(3);
  return {plane(w + row(0)), plane(w - row(0)), plane(w + row(1)), plane(w - row(1))};
}

/// A polygon of four corners, clipped by up to four planes. Each adds at most half as many points, even if rounding
/// makes the polygon concave.
struct Polygon {
  std::array<vec3, 19> points;
  size_t count = 0;
  void add(const vec3& p) { points[count++] = p; }
};

/// The part of a polygon that is inside.
Polygon clip(const Polygon& polygon, const Plane& plane) {
  Polygon kept;
  std::array<float, 19> distances;
  for (size_t i = 0; i < polygon.count; ++i) distances[i] = plane.distance(polygon.points[i]);
  for (size_t i = 0; i < polygon.count; ++i) {
    const size_t next = i + 1 < polygon.count ? i + 1 : 0;
    const vec3 &a = polygon.points[i], &b = polygon.points[next];
    const float at_a = distances[i], at_b = distances[next];
    if (at_a >= 0) kept.add(a);
    if ((at_a >= 0) != (at_b >= 0)) kept.add(a + (b - a) * (at_a / (at_a - at_b)));
  }
  return kept;
}

/// Calls use(p) for points whose convex hull is the part of the box that the picture may show.
template <class Use>
void for_seen_points(const std::array<vec3, 8>& corners, const scene::View& picture,
                     const std::array<Plane, 4>& sides, const Use& use) {
  const bool is_whole = std::ranges::all_of(sides, [&](const Plane& side) {
    return std::ranges::all_of(corners, [&](const vec3& corner) { return side.distance(corner) >= 0; });
  });
  if (is_whole) std::ranges::for_each(corners, use);
  constexpr int faces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  for (const auto& face : faces) {
    if (is_whole) break;
    Polygon polygon;
    for (const int corner : face) polygon.add(corners[static_cast<size_t>(corner)]);
    for (const Plane& side : sides) polygon = clip(polygon, side);
    for (size_t i = 0; i < polygon.count; ++i) use(polygon.points[i]);
  }
  // The sides meet in the eye, which may lie in the box. Whether it does is not asked: it is near enough.
  if (picture.eye.w == 0) return;
  const vec3 eye(picture.eye);
  Bounds box;
  for (const vec3& corner : corners) box.add(corner);
  bool inside = true;
  for (int i = 0; i < 3; ++i) inside = inside && box.low[i] <= eye[i] && eye[i] <= box.high[i];
  if (inside) use(eye);
}

/// A direction across `along` that no rounding makes parallel to it.
vec3 up_across(const vec3& along) {
  const bool steep = std::abs(along.y) > 0.9f * std::max(std::abs(along.x), std::abs(along.z));
  return steep ? vec3(0, 0, -1) : vec3(0, 1, 0);
}

/// The number of texels at each edge of a map that only the filter reads.
float margin_of(const scene::Shadow& shadow) { return std::ceil(shadow.softness * 0.5f) + 1; }

/// ShadowMap::margin.
float margin_factor(const scene::Shadow& shadow) {
  const auto size = static_cast<float>(shadow.size);
  return size / std::max(size - 2 * margin_of(shadow), 1.0f);
}

raster::DepthBias bias_of(const scene::Shadow& shadow, const scene::Camera& camera, const scene::View& view,
                          float depths) {
  // The filter compares with texels whose centres lie so far away, and positions are rounded to 1/256.
  const float reach = shadow.softness * 0.5f + 0.5f + 0.01f;
  // What the facet of a curved surface lacks where its neighbour is steeper: as if each had at least this slope.
  constexpr float least_slope = 0.1f;
  constexpr float rounding = 7.62939453e-06f;  // 2^-17
  // World units across a texel, of an image that is 2 units high; in perspective for each unit of distance.
  const float texel = 2 / (view.clip_from_view[1][1] * static_cast<float>(shadow.size));
  const bool perspective = camera.projection == scene::Projection::perspective;
  // Orthographic depth falls by clip_from_view[2][2] a unit; depth in perspective is near / distance.
  const float fall = perspective ? 1.0f : view.clip_from_view[2][2];
  const float least = shadow.bias * (least_slope * texel * reach * fall + rounding / depths);
  return {shadow.bias * reach, perspective ? least : 0.0f, perspective ? 0.0f : least};
}

/// The edges of the camera's picture lie as many texels inside of the map as the filter reaches. An orthographic map is as
/// deep as `depths` pictures, towards the light.
ShadowMap map_of(const scene::Camera& camera, const scene::Shadow& shadow, float depths = 1) {
  ShadowMap map{camera, scene::make_view(camera, shadow.size, shadow.size), {}};
  map.margin = margin_factor(shadow);
  map.view.clip_from_view[0][0] /= map.margin;
  map.view.clip_from_view[1][1] /= map.margin;
  for (const int column : {2, 3}) map.view.clip_from_view[column][2] /= depths;
  map.view.projection = scene::multiply(map.view.clip_from_view, map.view.view);
  map.bias = bias_of(shadow, camera, map.view, depths);
  return map;
}

ShadowMaps map_of_directional(const scene::Light& light, std::span<const Hull> hulls,
                              const scene::View& picture, threads::Workers& workers) {
  const vec3 back = scene::normalize(-light.direction);
  const vec3 up = up_across(back);
  const vec3 right = scene::normalize(scene::cross(up, back)), upright = scene::cross(back, right);
  const auto in_light = [&](const vec3& p) {
    return vec3(scene::dot(right, p), scene::dot(upright, p), scene::dot(back, p));
  };
  const std::array<Plane, 4> sides = sides_of(picture.projection);
  const auto see = [&](const std::array<vec3, 8>& corners, Bounds& bounds) {
    for_seen_points(corners, picture, sides, [&](const vec3& p) { bounds.add(in_light(p)); });
  };
  Bounds seen = bounds_over(hulls, workers, [&](const Hull& hull, Bounds& bounds) {
    if (hull.shows) see(hull.corners, bounds);
  });
  const Bounds all = bounds_of(hulls, workers);
  const bool may_show = std::ranges::any_of(hulls, [](const Hull& hull) { return hull.shows && hull.moves; });
  // Nothing is where it was: look wherever vertices may have been moved to.
  if (seen.empty() && may_show) see(all.widened(moved_sizes), seen);
  const bool shows_any = !seen.empty();
  if (!shows_any)  // the map shows all there is, for comparison
    for (const vec3& corner : all.empty() ? corners_of(vec3(0), vec3(0), 0, glm::mat4(1)) : all.widened(0))
      seen.add(in_light(corner));
  float nearest = seen.high.z;
  bool casts = false, casts_anywhere = false;
  for (const Hull& hull : hulls) {
    if (!hull.casts) continue;
    casts_anywhere = casts_anywhere || hull.casts_anywhere;
    Bounds box;
    for (const vec3& corner : hull.corners) box.add(in_light(corner));
    const bool beside = box.high.x < seen.low.x || box.low.x > seen.high.x || box.high.y < seen.low.y ||
                        box.low.y > seen.high.y || box.high.z < seen.low.z;
    if (beside) continue;
    casts = true;
    nearest = std::max(nearest, box.high.z);
  }
  const bool may_darken =
      shows_any && (casts || casts_anywhere) && std::ranges::any_of(hulls, &Hull::darkens);
  const vec3 middle = (seen.low + seen.high) * 0.5f;
  const vec3 extent = vec3(seen.high.x, seen.high.y, nearest) - seen.low;
  const float widest = std::max({extent.x, extent.y, 1e-6f});
  const float depth = std::max(extent.z, widest * slack);
  const float begin = nearest + depth * slack;
  scene::Camera camera;
  camera.projection = scene::Projection::orthographic;
  camera.position = right * middle.x + upright * middle.y + back * begin;
  camera.target = camera.position - back * std::max(depth, widest);
  camera.up = up;
  camera.height = widest * (1 + slack);
  camera.near = 0;
  camera.far = depth * (1 + 2 * slack);
  if (!casts_anywhere) return {{map_of(camera, *light.shadow)}, may_darken};
  // How far the map must see beyond `begin`, in depths of the map: a power of two, so that all depths keep their digits.
  float depths = 1;
  while ((depths - 1) * camera.far < moved_sizes * all.largest() && depths < most_depths) depths *= 2;
  return {{map_of(camera, *light.shadow, depths)}, may_darken};
}

/// The angle from the middle of each map of a point light or a spot to its sides, in degrees.
float half_angle(const scene::Light& light) { return shadow_map_count(light) == 1 ? light.outer_angle : 45; }

/// Whether a hull may stand before something within the range of a point light or a spot, as a map shows it.
bool may_hide(const scene::Light& light, LightRecord record, const Hull& hull) {
  if (!hull.casts) return false;
  if (light.range == 0 || hull.moves) return true;
  // A map compares depths along its axis. In its corners they are this much less than distances.
  const double side =
      std::tan(double{half_angle(light)} * std::numbers::pi / 180) * double{margin_factor(*light.shadow)};
  const double reach = double{light.range} * (1 + double{slack});
  return !(squared_distance(record, hull.box) > reach * reach * (1 + 2 * side * side));
}

}  // namespace

std::array<vec3, 8> corners_of(const vec3& low, const vec3& high, float margin, const glm::mat4& model) {
  const vec3 diagonal = high - low;
  const float length = std::sqrt(scene::dot(diagonal, diagonal));
  const vec3 least = low - vec3(margin * length), most = high + vec3(margin * length);
  std::array<vec3, 8> corners;
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto end = [&](int axis) { return (i >> axis & 1) != 0 ? most[axis] : least[axis]; };
    corners[i] = vec3(scene::multiply(model, glm::vec4(end(0), end(1), end(2), 1)));
  }
  return corners;
}

size_t shadow_map_count(const scene::Light& light) {
  if (!light.shadow) return 0;
  const bool is_wide = light.kind == scene::LightKind::spot && light.outer_angle > widest_cone;
  return light.kind == scene::LightKind::point || is_wide ? 6 : 1;
}

ShadowMaps shadow_maps(const scene::Light& light, LightRecord record, std::span<const Hull> hulls,
                       const scene::View& picture, threads::Workers& workers) {
  if (light.kind == scene::LightKind::directional) return map_of_directional(light, hulls, picture, workers);
  const auto is_darkened = [&](const Hull& hull) {
    return hull.darkens && (hull.moves || reaches(record, hull.box));
  };
  const auto hides = [&](const Hull& hull) { return may_hide(light, record, hull); };
  ShadowMaps made{{}, std::ranges::any_of(hulls, is_darkened) && std::ranges::any_of(hulls, hides)};
  scene::Camera camera;
  camera.position = light.position;
  camera.near = bounds_of(hulls, workers).largest() * near_part;
  // Far enough to differ from the position.
  const vec3 away = glm::abs(light.position);
  const float far_enough = std::max({away.x, away.y, away.z, 1.0f});
  const auto add = [&](const vec3& along, float fov) {
    camera.target = light.position + along * far_enough;
    camera.up = up_across(along);
    camera.fov = fov;
    made.maps.push_back(map_of(camera, *light.shadow));
  };
  if (shadow_map_count(light) == 1) {
    add(scene::normalize(light.direction), 2 * half_angle(light));
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {1.0f, -1.0f}) {
        vec3 along(0);
        along[axis] = sign;
        add(along, 2 * half_angle(light));
      }
    }
  }
  return made;
}

}  // namespace isoshade::render
