// SPDX-License-Identifier: Apache-2.0
// What meshes are built with. Computed under lanes::FpGuard, which the callers hold.
#pragma once

#include <cstdint>

#include "runtime/scene/mesh.h"

namespace isoshade::scene {

/// part/whole in [0, 1]
inline float fraction(int64_t part, int64_t whole) {
  return static_cast<float>(part) / static_cast<float>(whole);
}

/// White, and with normal, tangent and the way up in the texture right-handed. Its outline and corner normals are still 0.
void add_vertex(Mesh& mesh, glm::vec3 position, glm::vec3 normal, float u, float v, glm::vec3 tangent);
/// Counter-clockwise from outside.
void add_triangle(Mesh& mesh, int64_t a, int64_t b, int64_t c);
void add_quad(Mesh& mesh, int64_t a, int64_t b, int64_t c, int64_t d);
int64_t vertices_of(const Mesh& mesh);

// Each fills an empty mesh with all but the outline normals and the box.
void make_sphere(const MeshShape& shape, Mesh& mesh);
void make_icosphere(const MeshShape& shape, Mesh& mesh);
void make_cylinder(const MeshShape& shape, Mesh& mesh);
void make_cone(const MeshShape& shape, Mesh& mesh);
void make_torus(const MeshShape& shape, Mesh& mesh);
void make_lathe(const MeshShape& shape, Mesh& mesh);

/// Gives every vertex the direction that its point moves in when the whole surface grows: the sum of the
/// unit normals of all triangles that meet at exactly its position, each by its angle there, normalised.
/// Where they cancel out, as on a sheet with two sides, the shading normal. Triangles without area count
/// nothing. Gives it its corner normals, too: up to three shading normals of the vertices at its position, far apart
/// from each other; where there is one, the outline normal.
void add_outline_normals(Mesh& mesh);
void find_box(Mesh& mesh);

}  // namespace isoshade::scene
