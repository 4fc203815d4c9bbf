// SPDX-License-Identifier: Apache-2.0
// Meshes of revolution: rings around the y axis, joined by bands.
#include <algorithm>
#include <cmath>

#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade::scene {
namespace {

/// A circle around the axis, or a point on it.
struct Ring {
  float radius, height;
  glm::vec2 normal;  ///< unit: away from the axis and up
  float v;
};

/// What the vertices of all rings at one longitude share. Seen from outside, u runs to the right.
struct Meridian {
  float u;
  SinCos longitude;
  glm::vec3 tangent;

  /// At part / whole of a turn.
  Meridian(int64_t part, int64_t whole)
      : u(fraction(part, whole)),
        longitude(sin_cos_of_turn(part % whole, whole)),
        tangent(normalize(glm::vec3(-longitude.cos, 0, longitude.sin))) {}
};

/// Adds the vertices of `rings` rings from top to bottom and the bands between them. A pole is one point but many
/// vertices, as each triangle has its own u there. Other rings have a seam: their first and last vertices coincide.
/// `add(ring, meridian)` adds a vertex.
template <class IsPole, class Add>
void add_bands(Mesh& mesh, int64_t rings, int64_t segments, const IsPole& is_pole, const Add& add) {
  std::vector<Meridian> of_poles, of_rings;
  for (int64_t s = 0; s < segments; ++s) of_poles.emplace_back(2 * s + 1, 2 * segments);
  for (int64_t s = 0; s <= segments; ++s) of_rings.emplace_back(s, segments);
  std::vector<int64_t> first;
  for (int64_t ring = 0; ring < rings; ++ring) {
    first.push_back(vertices_of(mesh));
    for (const Meridian& meridian : is_pole(ring) ? of_poles : of_rings) add(ring, meridian);
  }
  for (int64_t ring = 0; ring + 1 < rings; ++ring) {
    for (int64_t s = 0; s < segments; ++s) {
      const int64_t a = first[static_cast<size_t>(ring)] + s, b = first[static_cast<size_t>(ring) + 1] + s;
      if (is_pole(ring)) {
        add_triangle(mesh, a, b, b + 1);
      } else if (is_pole(ring + 1)) {
        add_triangle(mesh, a, b, a + 1);
      } else {
        add_quad(mesh, a, b, b + 1, a + 1);
      }
    }
  }
}

/// Rings from top to bottom: the outside is to the left of the direction along them.
void add_surface(Mesh& mesh, const std::vector<Ring>& rings, int64_t segments) {
  const auto ring_at = [&](int64_t i) -> const Ring& { return rings[static_cast<size_t>(i)]; };
  const auto is_pole = [&](int64_t i) { return ring_at(i).radius == 0; };
  add_bands(mesh, static_cast<int64_t>(rings.size()), segments, is_pole,
            [&](int64_t i, const Meridian& at) {
              const Ring& ring = ring_at(i);
              const auto turned = [&](float away, float up) {
                // Removes the sign of zeros, so that a pole is one point.
                return glm::vec3(away * -at.longitude.sin + 0.0f, up, away * -at.longitude.cos + 0.0f);
              };
              add_vertex(mesh, turned(ring.radius, ring.height),
                         normalize(turned(ring.normal.x, ring.normal.y)), at.u, ring.v, at.tangent);
            });
}

/// A flat cap whose upper side is outside.
void add_top(Mesh& mesh, float radius, float height, int64_t segments) {
  add_surface(mesh, {{0, height, {0, 1}, 0}, {radius, height, {0, 1}, 1}}, segments);
}

void add_bottom(Mesh& mesh, float radius, float height, int64_t segments) {
  add_surface(mesh, {{radius, height, {0, -1}, 0}, {0, height, {0, -1}, 1}}, segments);
}

glm::vec2 unit(const glm::vec2& a) { return normalize(glm::vec3(a, 0)); }

/// The profile of a lathe from top to bottom: its points and the straight segments between them.
class Way {
 public:
  explicit Way(const std::vector<ProfilePoint>& profile) : points_(profile.rbegin(), profile.rend()) {
    const ProfilePoint &head = points_.front(), &tail = points_.back();
    closed_ = head.radius == tail.radius && head.height == tail.height && head.radius > 0;
    for (size_t i = 0; i + 1 < points_.size(); ++i) {
      const glm::vec2 step{points_[i + 1].radius - points_[i].radius,
                           points_[i + 1].height - points_[i].height};
      normals_.push_back(unit({-step.y, step.x}));
      lengths_.push_back(lengths_.back() + std::sqrt(step.x * step.x + step.y * step.y));
    }
  }

  size_t pieces() const { return normals_.size(); }

  /// The ring at a point, with the normal of one of the segments that meet there.
  Ring ring(size_t point, size_t piece) const {
    const ProfilePoint& p = points_[point];
    return {p.radius, p.height, normal(point, piece), lengths_[point] / lengths_.back()};
  }

  /// Whether the segments that meet at the point share a normal.
  bool smooth(size_t point) const {
    const bool end = point == 0 || point == pieces();
    if (end && !closed_) return false;
    const bool wanted = end ? points_.front().smooth && points_.back().smooth : points_[point].smooth;
    // A segment that reverses the one before has no mean normal with it.
    return wanted && glm_dot(normals_[before(point)], normals_[after(point)]) > -0.999f;
  }

 private:
  static float glm_dot(const glm::vec2& a, const glm::vec2& b) { return a.x * b.x + a.y * b.y; }
  size_t before(size_t point) const { return point == 0 ? pieces() - 1 : point - 1; }
  size_t after(size_t point) const { return point == pieces() ? 0 : point; }

  glm::vec2 normal(size_t point, size_t piece) const {
    const glm::vec2& own = normals_[piece];
    // Across the axis the normal is mirrored.
    if (points_[point].radius == 0) return points_[point].smooth ? unit({0, own.y}) : own;
    return smooth(point) ? unit(normals_[before(point)] + normals_[after(point)]) : own;
  }

  std::vector<ProfilePoint> points_;
  bool closed_ = false;
  std::vector<glm::vec2> normals_;    ///< of each segment
  std::vector<float> lengths_ = {0};  ///< from the top to each point
};

}  // namespace

void make_sphere(const MeshShape& shape, Mesh& mesh) {
  const int64_t rings = shape.rings;
  const auto is_pole = [&](int64_t ring) { return ring == 0 || ring == rings; };
  std::vector<SinCos> latitudes;
  for (int64_t ring = 0; ring <= rings; ++ring) latitudes.push_back(sin_cos_of_turn(ring, 2 * rings));
  add_bands(mesh, rings + 1, shape.segments, is_pole, [&](int64_t ring, const Meridian& at) {
    const SinCos latitude = latitudes[static_cast<size_t>(ring)];
    const SinCos around = is_pole(ring) ? SinCos{0, 1} : at.longitude;
    const glm::vec3 normal =
        normalize(glm::vec3(-latitude.sin * around.sin, latitude.cos, -latitude.sin * around.cos));
    add_vertex(mesh, normal * shape.size.x, normal, at.u, fraction(ring, rings), at.tangent);
  });
}

void make_cylinder(const MeshShape& shape, Mesh& mesh) {
  const float radius = shape.size.x, half = shape.size.y * 0.5f;
  std::vector<Ring> side;
  for (int64_t i = 0; i <= shape.rings; ++i) {
    const float v = fraction(i, shape.rings);
    side.push_back({radius, shape.size.y * (0.5f - v), {1, 0}, v});
  }
  if (shape.caps) add_top(mesh, radius, half, shape.segments);
  add_surface(mesh, side, shape.segments);
  if (shape.caps) add_bottom(mesh, radius, -half, shape.segments);
}

void make_cone(const MeshShape& shape, Mesh& mesh) {
  const float radius = shape.size.x, height = shape.size.y;
  const glm::vec2 normal = unit({height, radius});
  std::vector<Ring> side;
  for (int64_t i = 0; i <= shape.rings; ++i) {
    const float v = fraction(i, shape.rings);
    side.push_back({radius * v, height * (0.5f - v), normal, v});
  }
  add_surface(mesh, side, shape.segments);
  if (shape.caps) add_bottom(mesh, radius, -0.5f * height, shape.segments);
}

void make_torus(const MeshShape& shape, Mesh& mesh) {
  std::vector<Ring> rings;
  for (int64_t i = 0; i <= shape.rings; ++i) {
    const SinCos angle = sin_cos_of_turn(i % shape.rings, shape.rings);
    rings.push_back({shape.size.x - shape.size.y * angle.cos,
                     shape.size.y * angle.sin,
                     {-angle.cos, angle.sin},
                     fraction(i, shape.rings)});
  }
  add_surface(mesh, rings, shape.segments);
}

void make_lathe(const MeshShape& shape, Mesh& mesh) {
  const Way way(shape.profile);
  std::vector<Ring> rings;
  for (size_t piece = 0; piece < way.pieces(); ++piece) {
    if (rings.empty()) rings.push_back(way.ring(piece, piece));
    rings.push_back(way.ring(piece + 1, piece));
    if (piece + 1 < way.pieces() && way.smooth(piece + 1)) continue;
    add_surface(mesh, rings, shape.segments);
    rings.clear();
  }
}

}  // namespace isoshade::scene
