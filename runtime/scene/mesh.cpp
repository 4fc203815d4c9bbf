// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/mesh.h"

#include <algorithm>

#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

/// part/whole in [0, 1]
float fraction(int64_t part, int64_t whole) { return static_cast<float>(part) / static_cast<float>(whole); }

/// White, and with normal, tangent and the way up in the texture right-handed.
void add_vertex(Mesh& mesh, glm::vec3 position, glm::vec3 normal, float u, float v, glm::vec3 tangent) {
  const float record[lower::vertex_word::stride] = {
      position.x, position.y, position.z, normal.x, normal.y, normal.z, u, v,  //
      tangent.x,  tangent.y,  tangent.z,  1,        1,        1,        1, 1};
  for (const float value : record) mesh.vertices.push_back(canonical(value));
}

void add_triangle(Mesh& mesh, int64_t a, int64_t b, int64_t c) {
  for (const int64_t index : {a, b, c}) mesh.indices.push_back(static_cast<uint32_t>(index));
}

/// A quadrilateral a b c d, counter-clockwise from outside.
void add_quad(Mesh& mesh, int64_t a, int64_t b, int64_t c, int64_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

/// Longitude runs from -z over -x, +z and +x back to -z: seen from outside, u runs to the right.
glm::vec3 sphere_direction(const MeshShape& shape, int64_t ring, int64_t segment) {
  const SinCos latitude = sin_cos_of_turn(ring, 2 * shape.rings);
  const SinCos longitude = sin_cos_of_turn(segment, shape.segments);
  return {-latitude.sin * longitude.sin, latitude.cos, -latitude.sin * longitude.cos};
}

void make_sphere(const MeshShape& shape, Mesh& mesh) {
  const int64_t segments = shape.segments;
  const int64_t rings = shape.rings;
  const auto add = [&](int64_t ring, int64_t segment, float u, SinCos longitude) {
    const glm::vec3 normal = normalize(sphere_direction(shape, ring, segment));
    const glm::vec3 tangent = normalize(glm::vec3(-longitude.cos, 0, longitude.sin));
    add_vertex(mesh, normal * shape.size.x, normal, u, fraction(ring, rings), tangent);
  };
  // A pole is one point but many vertices: each of its triangles has its own u there.
  const auto add_pole = [&](int64_t ring) {
    for (int64_t s = 0; s < segments; ++s) {
      const int64_t part = 2 * s + 1, whole = 2 * segments;
      add(ring, 0, fraction(part, whole), sin_cos_of_turn(part, whole));
    }
  };
  add_pole(0);
  for (int64_t ring = 1; ring < rings; ++ring) {
    // The seam's two columns are the same points.
    for (int64_t s = 0; s <= segments; ++s)
      add(ring, s % segments, fraction(s, segments), sin_cos_of_turn(s % segments, segments));
  }
  add_pole(rings);

  const auto vertex = [&](int64_t ring, int64_t s) { return segments + (ring - 1) * (segments + 1) + s; };
  for (int64_t s = 0; s < segments; ++s) add_triangle(mesh, s, vertex(1, s), vertex(1, s + 1));
  for (int64_t ring = 1; ring + 1 < rings; ++ring)
    for (int64_t s = 0; s < segments; ++s)
      add_quad(mesh, vertex(ring, s), vertex(ring + 1, s), vertex(ring + 1, s + 1), vertex(ring, s + 1));
  for (int64_t s = 0; s < segments; ++s)
    add_triangle(mesh, vertex(rings - 1, s), vertex(rings, s), vertex(rings - 1, s + 1));
}

void make_plane(const MeshShape& shape, Mesh& mesh) {
  const int64_t n = shape.segments;
  for (int64_t row = 0; row <= n; ++row) {
    for (int64_t column = 0; column <= n; ++column) {
      const float u = fraction(column, n);
      const float v = fraction(row, n);
      add_vertex(mesh, {(u - 0.5f) * shape.size.x, 0, (v - 0.5f) * shape.size.z}, {0, 1, 0}, u, v, {1, 0, 0});
    }
  }
  for (int64_t row = 0; row < n; ++row) {
    for (int64_t column = 0; column < n; ++column) {
      const int64_t a = row * (n + 1) + column;
      const int64_t below = a + n + 1;
      add_quad(mesh, a, below, below + 1, a + 1);
    }
  }
}

void make_box(const MeshShape& shape, Mesh& mesh) {
  struct Face {
    glm::vec3 normal, right, up;
  };
  constexpr Face faces[] = {
      {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}},
  };
  const glm::vec3 half = shape.size * 0.5f;
  for (const Face& face : faces) {
    const auto first = static_cast<int64_t>(mesh.vertices.size()) / lower::vertex_word::stride;
    const auto add = [&](float right, float up, float u, float v) {
      add_vertex(mesh, (face.normal + face.right * right + face.up * up) * half, face.normal, u, v,
                 face.right);
    };
    add(-1, -1, 0, 1);
    add(1, -1, 1, 1);
    add(1, 1, 1, 0);
    add(-1, 1, 0, 0);
    add_quad(mesh, first, first + 1, first + 2, first + 3);
  }
}

}  // namespace

int64_t vertex_count(const MeshShape& shape) {
  const int64_t segments = shape.segments;
  switch (shape.kind) {
    case MeshKind::sphere: return 2 * segments + (shape.rings - 1) * (segments + 1);
    case MeshKind::plane: return (segments + 1) * (segments + 1);
    case MeshKind::box: return 24;
  }
  return 0;
}

int64_t triangle_count(const MeshShape& shape) {
  const int64_t segments = shape.segments;
  switch (shape.kind) {
    case MeshKind::sphere: return 2 * segments * (shape.rings - 1);
    case MeshKind::plane: return 2 * segments * segments;
    case MeshKind::box: return 12;
  }
  return 0;
}

Mesh make_mesh(const MeshShape& shape) {
  Mesh mesh;
  const lanes::FpGuard guard;
  mesh.vertices.reserve(static_cast<size_t>(vertex_count(shape)) * lower::vertex_word::stride);
  mesh.indices.reserve(static_cast<size_t>(triangle_count(shape)) * 3);
  switch (shape.kind) {
    case MeshKind::sphere: make_sphere(shape, mesh); break;
    case MeshKind::plane: make_plane(shape, mesh); break;
    case MeshKind::box: make_box(shape, mesh); break;
  }
  for (size_t i = 0; i < mesh.vertices.size(); i += lower::vertex_word::stride) {
    const float* p = &mesh.vertices[i + lower::vertex_word::position];
    if (i == 0) mesh.low = mesh.high = {p[0], p[1], p[2]};
    for (int axis = 0; axis < 3; ++axis) {
      mesh.low[axis] = std::min(mesh.low[axis], p[axis]);
      mesh.high[axis] = std::max(mesh.high[axis], p[axis]);
    }
  }
  return mesh;
}

}  // namespace isoshade::scene
