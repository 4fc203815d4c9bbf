// SPDX-License-Identifier: Apache-2.0
// Meshes made by rule. One shape is one set of bits on every machine.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace isoshade::scene {

enum class MeshKind : uint8_t { sphere, plane, box };

inline constexpr int64_t max_segments = 1024;  ///< of a mesh, along each direction

/// What a mesh is made from. Equal shapes give equal meshes.
struct MeshShape {
  MeshKind kind = MeshKind::sphere;
  glm::vec3 size{1, 1, 1};  ///< sphere: the radius in each component; plane: x and z; box: x, y and z
  int segments = 64;        ///< sphere: around the axis; plane: along x and along z
  int rings = 32;           ///< sphere: from pole to pole
  bool operator==(const MeshShape&) const = default;
};

/// Vertices are records of lower::vertex_word, indices triples. Seen from outside (a plane: from above),
/// triangles run counter-clockwise; none is degenerate.
struct Mesh {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;
  glm::vec3 low{0, 0, 0}, high{0, 0, 0};  ///< the box around all positions
};

/// What make_mesh will make of a shape, without making it.
int64_t vertex_count(const MeshShape& shape);
int64_t triangle_count(const MeshShape& shape);

/// All are centred on the origin. Sphere: poles at +y (v = 0) and -y, the seam of u at -z. Plane: in y = 0,
/// facing +y, u along +x and v along +z. Box: each face of its own 4 vertices. Tangents run along u, normal x
/// tangent against v; vertices are white.
Mesh make_mesh(const MeshShape& shape);

}  // namespace isoshade::scene
