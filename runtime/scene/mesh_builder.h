// SPDX-License-Identifier: Apache-2.0
// Helpers to build meshes. The callers hold lanes::FpGuard.
#pragma once

#include <cstdint>

#include "runtime/scene/mesh.h"
#include "runtime/threads/workers.h"

namespace isoshade::scene {

/// part/whole in [0, 1]
inline float fraction(int64_t part, int64_t whole) {
  return static_cast<float>(part) / static_cast<float>(whole);
}

/// Adds a white vertex with the same texture coordinates in both sets, whose normal, tangent and bitangent (up in the texture) are right-handed. Its outline and corner
/// normals are still 0.
void add_vertex(Mesh& mesh, glm::vec3 position, glm::vec3 normal, float u, float v, glm::vec3 tangent);
/// Corners in counter-clockwise order seen from outside.
void add_triangle(Mesh& mesh, int64_t a, int64_t b, int64_t c);
void add_quad(Mesh& mesh, int64_t a, int64_t b, int64_t c, int64_t d);
int64_t vertices_of(const Mesh& mesh);

// Each fills an empty mesh, except for the outline normals and the bounding box.
void make_sphere(const MeshShape& shape, Mesh& mesh);
void make_icosphere(const MeshShape& shape, Mesh& mesh);
void make_cylinder(const MeshShape& shape, Mesh& mesh);
void make_cone(const MeshShape& shape, Mesh& mesh);
void make_torus(const MeshShape& shape, Mesh& mesh);
void make_lathe(const MeshShape& shape, Mesh& mesh);

/// Computes outline normals, along which a vertex moves when the surface is offset: the normalised sum of the unit
/// normals of all triangles that meet at exactly its position, weighted by their angles there. Where they cancel out,
/// as on a sheet with two sides, it is the shading normal. Triangles without area do not count. Also computes corner
/// normals: up to three very different shading normals of the vertices at the position; if there is only one, the
/// outline normal. Works on the threads of `workers` if there are any; the bits do not depend on that.
void add_outline_normals(Mesh& mesh, threads::Workers* workers = nullptr);
void find_box(Mesh& mesh);

}  // namespace isoshade::scene
