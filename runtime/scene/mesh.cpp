// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/mesh.h"

#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/mesh_formats.h"
#include "runtime/scene/model.h"

namespace isoshade::scene {

namespace word = lower::vertex_word;

void add_vertex(Mesh& mesh, glm::vec3 position, glm::vec3 normal, float u, float v, glm::vec3 tangent) {
  float record[word::stride] = {
      position.x, position.y, position.z, normal.x, normal.y, normal.z, u, v,  //
      tangent.x,  tangent.y,  tangent.z,  1,        1,        1,        1, 1};
  record[word::texcoord1] = u;
  record[word::texcoord1 + 1] = v;
  for (float& value : record) value = canonical(value);
  mesh.vertices.insert(mesh.vertices.end(), std::begin(record), std::end(record));
}

void add_triangle(Mesh& mesh, int64_t a, int64_t b, int64_t c) {
  for (const int64_t index : {a, b, c}) mesh.indices.push_back(static_cast<uint32_t>(index));
}

void add_quad(Mesh& mesh, int64_t a, int64_t b, int64_t c, int64_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

int64_t vertices_of(const Mesh& mesh) { return static_cast<int64_t>(mesh.vertices.size()) / word::stride; }

void find_box(Mesh& mesh) {
  for (size_t i = 0; i < mesh.vertices.size(); i += word::stride) {
    const float* p = &mesh.vertices[i + word::position];
    if (i == 0) mesh.low = mesh.high = {p[0], p[1], p[2]};
    for (int axis = 0; axis < 3; ++axis) {
      mesh.low[axis] = std::min(mesh.low[axis], p[axis]);
      mesh.high[axis] = std::max(mesh.high[axis], p[axis]);
    }
  }
}

namespace {

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
    const int64_t first = vertices_of(mesh);
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

int64_t most_vertices(const MeshShape& shape) {
  const int64_t around = int64_t{shape.segments} + 1, along = int64_t{shape.rings} + 1;
  switch (shape.kind) {
    case MeshKind::sphere:
    case MeshKind::torus: return around * along;
    case MeshKind::plane: return around * around;
    case MeshKind::box: return 24;
    // Points, and a second time those on the seam and at the poles.
    case MeshKind::icosphere: return (int64_t{10} << (2 * shape.rings)) + (int64_t{8} << shape.rings) + 16;
    case MeshKind::cylinder:
    case MeshKind::cone: return around * (along + 4);
    case MeshKind::lathe: return around * 2 * static_cast<int64_t>(shape.profile.size());
    case MeshKind::file: support::bug("a file is not a mesh made by rule");
  }
  support::bug("a mesh of no kind");
}

Mesh make_mesh(const MeshShape& shape, threads::Workers* workers) {
  Mesh mesh;
  const lanes::FpGuard guard;
  switch (shape.kind) {
    case MeshKind::sphere: make_sphere(shape, mesh); break;
    case MeshKind::plane: make_plane(shape, mesh); break;
    case MeshKind::box: make_box(shape, mesh); break;
    case MeshKind::icosphere: make_icosphere(shape, mesh); break;
    case MeshKind::cylinder: make_cylinder(shape, mesh); break;
    case MeshKind::cone: make_cone(shape, mesh); break;
    case MeshKind::torus: make_torus(shape, mesh); break;
    case MeshKind::lathe: make_lathe(shape, mesh); break;
    case MeshKind::file: support::bug("a file is not a mesh made by rule");
  }
  add_outline_normals(mesh, workers);
  find_box(mesh);
  return mesh;
}

void fit_to_unit_size(Mesh& mesh) {
  const lanes::FpGuard guard;
  const glm::vec3 size = mesh.high - mesh.low, middle = mesh.low + size * 0.5f;
  const float longest = std::max(size.x, std::max(size.y, size.z));
  if (longest == 0) return;
  for (size_t i = 0; i < mesh.vertices.size(); i += word::stride) {
    float* p = &mesh.vertices[i + word::position];
    for (int axis = 0; axis < 3; ++axis) p[axis] = canonical((p[axis] - middle[axis]) / longest);
  }
  find_box(mesh);
}

Model model_of(Mesh mesh) {
  Model model{std::move(mesh), {}};
  ModelPart& all = model.parts.emplace_back();
  all.index_count = model.mesh.indices.size();
  all.vertex_count = model.mesh.vertices.size() / word::stride;
  return model;
}

std::optional<Model> make_model(const MeshShape& shape, const support::Span& where,
                                support::Diagnostics& diagnostics) {
  if (shape.kind == MeshKind::file) {
    auto model = mesh_formats[shape.format].load(shape.file, where, diagnostics);
    if (model && shape.fit) fit_to_unit_size(model->mesh);
    return model;
  }
  return model_of(make_mesh(shape));
}

}  // namespace isoshade::scene
