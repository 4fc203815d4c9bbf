// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/vec2.hpp>

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

namespace word = lower::vertex_word;

/// The directions of u and v at a vertex: sums of unit vectors, one per triangle.
struct Gradients {
  glm::vec3 along_u{0, 0, 0}, along_v{0, 0, 0};
};

glm::vec3 vector_at(const float* vertex, int at) { return {vertex[at], vertex[at + 1], vertex[at + 2]}; }

/// For a triangle; zeros if it has no area in the texture. `texcoord_word`: of the set of texture coordinates.
Gradients gradients_of(const float* a, const float* b, const float* c, int texcoord_word) {
  const glm::vec3 origin = vector_at(a, word::position);
  const glm::vec3 e1 = vector_at(b, word::position) - origin, e2 = vector_at(c, word::position) - origin;
  const auto texcoord = [&](const float* vertex) {
    return glm::vec2(vertex[texcoord_word], vertex[texcoord_word + 1]);
  };
  const glm::vec2 d1 = texcoord(b) - texcoord(a), d2 = texcoord(c) - texcoord(a);
  const float area = d1.x * d2.y - d2.x * d1.y;
  if (area == 0 || !std::isfinite(area)) return {};
  const float sign = area < 0 ? -1.0f : 1.0f;
  return {normalize((e1 * d2.y - e2 * d1.y) * sign), normalize((e2 * d1.x - e1 * d2.x) * sign)};
}

}  // namespace

glm::vec3 perpendicular_to(const glm::vec3& normal) {
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  glm::vec3 axis(0);
  axis[least] = 1;
  const glm::vec3 result = normalize(cross(axis, normal));
  return result == glm::vec3(0) ? glm::vec3(1, 0, 0) : result;
}

void add_tangents(Mesh& mesh, int64_t first, size_t first_index, int set) {
  const int texcoord_word = set == 0 ? word::texcoord : word::texcoord1;
  std::vector<Gradients> sums(static_cast<size_t>(mesh.vertices.size() / word::stride) -
                              static_cast<size_t>(first));
  const auto record = [&](size_t vertex) { return &mesh.vertices[vertex * word::stride]; };
  for (size_t t = first_index; t + 2 < mesh.indices.size(); t += 3) {
    const uint32_t* corners = &mesh.indices[t];
    const Gradients own = gradients_of(record(corners[0]), record(corners[1]), record(corners[2]), texcoord_word);
    for (int i = 0; i < 3; ++i) {
      Gradients& sum = sums[corners[i] - static_cast<size_t>(first)];
      sum.along_u += own.along_u;
      sum.along_v += own.along_v;
    }
  }
  for (size_t i = 0; i < sums.size(); ++i) {
    float* vertex = record(static_cast<size_t>(first) + i);
    const glm::vec3 normal = vector_at(vertex, word::normal);
    glm::vec3 tangent = normalize(sums[i].along_u - normal * dot(normal, sums[i].along_u));
    // Where the normal lies along u, only rounding errors are left.
    if (!(std::abs(dot(tangent, normal)) < 0.01f) || tangent == glm::vec3(0))
      tangent = perpendicular_to(normal);
    const float sign = dot(cross(normal, tangent), sums[i].along_v) > 0 ? -1.0f : 1.0f;
    for (int axis = 0; axis < 3; ++axis) vertex[word::tangent + axis] = canonical(tangent[axis]);
    vertex[word::tangent + 3] = sign;
  }
}

}  // namespace isoshade::scene
