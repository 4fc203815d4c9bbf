// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "compiler/functions/inverse_trigonometric.h"
#include "compiler/functions/octahedral.h"
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

/// A weld: all vertices at one position.
struct Sum {
  glm::vec3 normal{0, 0, 0};
  float angle = 0;
};

// Cosines: of normals of one smooth surface, and of the two sides of a sheet.
constexpr float alike = 0.999f, opposite = -0.99f;

/// Up to three very different normals of the surfaces that meet at a position; `smooth` if there is only one.
std::array<glm::vec3, 3> corner_normals(const std::vector<glm::vec3>& normals, const glm::vec3& smooth) {
  // Chooses the normal that is least similar to those chosen so far.
  const auto next = [&](auto likeness) { return *std::ranges::min_element(normals, {}, likeness); };
  const glm::vec3 first = next([&](const glm::vec3& n) { return dot(n, smooth); });
  const auto to_first = [&](const glm::vec3& n) { return dot(n, first) < opposite ? 1.0f : dot(n, first); };
  const glm::vec3 second = next(to_first);
  if (to_first(second) > alike) return {smooth, smooth, smooth};
  const auto to_both = [&](const glm::vec3& n) {
    return dot(n, second) < opposite ? 1.0f : std::max(to_first(n), dot(n, second));
  };
  const glm::vec3 third = next(to_both);
  return {first, second, to_both(third) > alike ? first : third};
}

/// The angle between unit vectors; accurate also for nearly parallel ones, unlike the arc cosine.
float angle_between(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 sine = cross(a, b);
  return functions::atan2(std::sqrt(dot(sine, sine)), dot(a, b));
}

/// Runs after the outline normals are known; vertices are welded in the same way.
void add_corner_normals(Mesh& mesh, const std::vector<size_t>& weld_of, size_t welds) {
  std::vector<std::vector<uint32_t>> vertices_of_weld(welds);
  for (size_t v = 0; v < weld_of.size(); ++v)
    vertices_of_weld[weld_of[v]].push_back(static_cast<uint32_t>(v));
  std::vector<glm::vec3> normals;
  for (const std::vector<uint32_t>& vertices : vertices_of_weld) {
    normals.clear();
    for (const uint32_t v : vertices)
      if (const glm::vec3 normal = vector_at(mesh, v, word::normal); normal != glm::vec3(0))
        normals.push_back(normal);
    const glm::vec3 outline = vector_at(mesh, vertices[0], word::outline_normal);
    const glm::vec3 smooth = outline == glm::vec3(0) ? glm::vec3(0, 1, 0) : outline;
    if (normals.empty()) normals.push_back(smooth);
    const std::array<glm::vec3, 3> corners = corner_normals(normals, smooth);
    for (const uint32_t v : vertices)
      for (size_t i = 0; i < 3; ++i)
        mesh.vertices[v * word::stride + word::corner_normals + i] =
            functions::octahedral_encode({corners[i].x, corners[i].y, corners[i].z});
  }
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
    // Where normals cancel out, only rounding errors are left.
    const bool has_one = dot(sum.normal, sum.normal) > 1e-6f * sum.angle * sum.angle;
    const glm::vec3 normal = has_one ? normalize(sum.normal) : vector_at(mesh, v, word::normal);
    for (int i = 0; i < 3; ++i)
      mesh.vertices[v * word::stride + static_cast<size_t>(word::outline_normal + i)] = canonical(normal[i]);
  }
  add_corner_normals(mesh, weld_of, welds.size());
}

}  // namespace isoshade::scene
