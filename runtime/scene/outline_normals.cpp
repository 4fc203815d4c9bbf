// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "compiler/functions/inverse_trigonometric.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade::scene {
namespace {

namespace word = lower::vertex_word;

struct Position {
  std::array<uint32_t, 3> bits;
  bool operator==(const Position&) const = default;
};

struct Hash {
  size_t operator()(const Position& position) const {
    uint64_t hash = 0;
    for (const uint32_t bits : position.bits) hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    return static_cast<size_t>(hash ^ (hash >> 32));
  }
};

glm::vec3 vector_at(const Mesh& mesh, size_t vertex, int at) {
  const float* v = &mesh.vertices[vertex * word::stride + static_cast<size_t>(at)];
  return {v[0], v[1], v[2]};
}

Position position_of(const glm::vec3& p) {
  Position position;
  for (int i = 0; i < 3; ++i)
    position.bits[static_cast<size_t>(i)] = std::bit_cast<uint32_t>(p[i] + 0.0f);  // -0 is 0
  return position;
}

/// Of a weld: all vertices at one position.
struct Sum {
  glm::vec3 normal{0, 0, 0};
  float angle = 0;
};

/// Between unit vectors; also of nearly parallel ones, where the arc cosine would know little.
float angle_between(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 sine = cross(a, b);
  return functions::atan2(std::sqrt(dot(sine, sine)), dot(a, b));
}

}  // namespace

void add_outline_normals(Mesh& mesh) {
  const auto vertices = static_cast<size_t>(vertices_of(mesh));
  std::vector<size_t> weld_of(vertices);
  std::unordered_map<Position, size_t, Hash> welds;
  welds.reserve(vertices);
  for (size_t v = 0; v < vertices; ++v)
    weld_of[v] =
        welds.try_emplace(position_of(vector_at(mesh, v, word::position)), welds.size()).first->second;

  std::vector<Sum> sums(welds.size());
  for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::array<glm::vec3, 3> edges;  // from each corner to the next
    for (size_t i = 0; i < 3; ++i) {
      edges[i] = normalize(vector_at(mesh, mesh.indices[t + (i + 1) % 3], word::position) -
                           vector_at(mesh, mesh.indices[t + i], word::position));
    }
    const glm::vec3 face = normalize(cross(edges[0], edges[1]));
    if (face == glm::vec3(0)) continue;
    for (size_t i = 0; i < 3; ++i) {
      Sum& sum = sums[weld_of[mesh.indices[t + i]]];
      const float angle = angle_between(edges[i], -edges[(i + 2) % 3]);
      sum.normal += face * angle;
      sum.angle += angle;
    }
  }
  for (size_t v = 0; v < vertices; ++v) {
    const Sum& sum = sums[weld_of[v]];
    // What is left where normals cancel out is rounding.
    const bool has_one = dot(sum.normal, sum.normal) > 1e-6f * sum.angle * sum.angle;
    const glm::vec3 normal = has_one ? normalize(sum.normal) : vector_at(mesh, v, word::normal);
    for (int i = 0; i < 3; ++i)
      mesh.vertices[v * word::stride + static_cast<size_t>(word::outline_normal + i)] = canonical(normal[i]);
  }
}

}  // namespace isoshade::scene
