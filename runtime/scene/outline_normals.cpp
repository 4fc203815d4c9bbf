// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "compiler/functions/inverse_trigonometric.h"
#include "compiler/functions/octahedral.h"
#include "compiler/functions/vector.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade::scene {
namespace {

namespace word = lower::vertex_word;

glm::vec3 vector_at(const Mesh& mesh, size_t vertex, int at) {
  const float* v = &mesh.vertices[vertex * word::stride + static_cast<size_t>(at)];
  return {v[0], v[1], v[2]};
}

/// Numbers the welds, the sets of vertices at one position, in the order of their first vertices.
class Welds {
 public:
  explicit Welds(const Mesh& mesh) : of_(static_cast<size_t>(vertices_of(mesh))) {
    // An open hash table with at least half of its slots free.
    const size_t slots = std::bit_ceil(2 * of_.size() + 1);
    constexpr uint32_t free = ~0u;
    std::vector<uint32_t> first_vertex_at(slots, free);  // of the weld in a slot
    for (size_t v = 0; v < of_.size(); ++v) {
      const Position position = position_of(mesh, v);
      size_t slot = hash(position) & (slots - 1);
      while (first_vertex_at[slot] != free && position_of(mesh, first_vertex_at[slot]) != position)
        slot = (slot + 1) & (slots - 1);
      if (first_vertex_at[slot] == free) {
        first_vertex_at[slot] = static_cast<uint32_t>(v);
        of_[v] = count_++;
      } else {
        of_[v] = of_[first_vertex_at[slot]];
      }
    }
  }

  size_t count() const { return count_; }
  uint32_t of(size_t vertex) const { return of_[vertex]; }

  /// The vertices of all welds, one weld after the other; those of weld i begin at first[i] and end at first[i + 1].
  struct Members {
    std::vector<uint32_t> vertices, first;
  };
  Members members() const {
    Members all{std::vector<uint32_t>(of_.size()), std::vector<uint32_t>(count_ + 2)};
    for (const uint32_t weld : of_) ++all.first[weld + 2];
    for (size_t i = 2; i < all.first.size(); ++i) all.first[i] += all.first[i - 1];
    for (size_t v = 0; v < of_.size(); ++v) all.vertices[all.first[of_[v] + 1]++] = static_cast<uint32_t>(v);
    return all;
  }

 private:
  using Position = std::array<uint32_t, 3>;  ///< bits; -0 is 0
  static Position position_of(const Mesh& mesh, size_t vertex) {
    Position position;
    for (size_t i = 0; i < 3; ++i)
      position[i] = std::bit_cast<uint32_t>(mesh.vertices[vertex * word::stride + word::position + i] + 0.0f);
    return position;
  }
  static size_t hash(const Position& position) {
    uint64_t hash = 0;
    for (const uint32_t bits : position) hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    return static_cast<size_t>(hash ^ (hash >> 32));
  }

  std::vector<uint32_t> of_;
  uint32_t count_ = 0;
};

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

/// One triangle a lane.
using F = lanes::Float<4, 1>;
constexpr size_t width = lanes::lane_count<F>;

/// Of `width` triangles: the unit normals of their faces, 0 of those without area, and the angles at their corners.
struct Faces {
  float normals[3][width];  ///< by component
  float angles[3][width];   ///< by corner
};

using Vector = lanes::vec<F, 3>;

/// The angle between unit vectors; accurate also for nearly parallel ones, unlike the arc cosine.
F angle_between(Vector a, Vector b) {
  const Vector sine = functions::cross(a, b);
  return functions::atan2(sqrt(functions::dot(sine, sine)), functions::dot(a, b));
}

/// The triangles whose corners begin at `first` in Mesh::indices; those beyond the last repeat it.
Faces faces_from(const Mesh& mesh, size_t first) {
  float positions[3][3][width];  // by corner and component
  for (size_t lane = 0; lane < width; ++lane) {
    const size_t triangle = std::min(first + 3 * lane, mesh.indices.size() - 3);
    for (size_t i = 0; i < 3; ++i)
      for (size_t c = 0; c < 3; ++c)
        positions[i][c][lane] = mesh.vertices[mesh.indices[triangle + i] * word::stride + word::position + c];
  }
  const auto corner = [&](size_t i) {
    return Vector(lanes::load_lanes<F>(positions[i][0]), lanes::load_lanes<F>(positions[i][1]),
                  lanes::load_lanes<F>(positions[i][2]));
  };
  const auto minus = [](Vector a) { return Vector(negate(a.x), negate(a.y), negate(a.z)); };
  const Vector a = corner(0), b = corner(1), c = corner(2);
  const Vector edges[3] = {functions::normalize(b - a), functions::normalize(c - b), functions::normalize(a - c)};
  const Vector normal = functions::normalize(functions::cross(edges[0], edges[1]));
  Faces faces;
  lanes::store_lanes(faces.normals[0], normal.x);
  lanes::store_lanes(faces.normals[1], normal.y);
  lanes::store_lanes(faces.normals[2], normal.z);
  for (size_t i = 0; i < 3; ++i)
    lanes::store_lanes(faces.angles[i], angle_between(edges[i], minus(edges[(i + 2) % 3])));
  return faces;
}

/// Calls body(i) for all i in [0, count), on all threads if there are any.
template <class Body>
void for_each(threads::Workers* workers, size_t count, const Body& body) {
  if (workers != nullptr) return workers->for_each(count, body);
  for (size_t i = 0; i < count; ++i) body(i);
}

/// Calls body(i) likewise, many to a task.
template <class Body>
void for_each_of_many(threads::Workers* workers, size_t count, const Body& body) {
  constexpr size_t task = 1024;
  for_each(count > task ? workers : nullptr, (count + task - 1) / task, [&](size_t t) {
    for (size_t i = t * task; i < std::min(count, (t + 1) * task); ++i) body(i);
  });
}

/// The sums of the faces at each weld.
std::vector<Sum> sums_of(const Mesh& mesh, const Welds& welds, threads::Workers* workers) {
  const size_t blocks = (mesh.indices.size() / 3 + width - 1) / width;
  std::vector<Faces> faces(blocks);
  for_each_of_many(workers, blocks, [&](size_t b) { faces[b] = faces_from(mesh, 3 * width * b); });
  std::vector<Sum> sums(welds.count());
  for (size_t t = 0; 3 * t + 2 < mesh.indices.size(); ++t) {
    const Faces& block = faces[t / width];
    const size_t lane = t % width;
    const glm::vec3 face(block.normals[0][lane], block.normals[1][lane], block.normals[2][lane]);
    if (face == glm::vec3(0)) continue;
    for (size_t i = 0; i < 3; ++i) {
      Sum& sum = sums[welds.of(mesh.indices[3 * t + i])];
      const float angle = block.angles[i][lane];
      sum.normal += face * angle;
      sum.angle += angle;
    }
  }
  return sums;
}

/// Runs after the outline normals are known.
void add_corner_normals(Mesh& mesh, const Welds& welds, threads::Workers* workers) {
  const Welds::Members members = welds.members();
  for_each_of_many(workers, welds.count(), [&](size_t weld) {
    const auto vertices = std::span(members.vertices)
                              .subspan(members.first[weld], members.first[weld + 1] - members.first[weld]);
    std::vector<glm::vec3> normals;
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
  });
}

}  // namespace

void add_outline_normals(Mesh& mesh, threads::Workers* workers) {
  if (mesh.vertices.empty()) return;
  const Welds welds(mesh);
  const std::vector<Sum> sums = sums_of(mesh, welds, workers);
  for_each_of_many(workers, static_cast<size_t>(vertices_of(mesh)), [&](size_t v) {
    const Sum& sum = sums[welds.of(v)];
    // Where normals cancel out, only rounding errors are left.
    const bool has_one = dot(sum.normal, sum.normal) > 1e-6f * sum.angle * sum.angle;
    const glm::vec3 normal = has_one ? normalize(sum.normal) : vector_at(mesh, v, word::normal);
    for (int i = 0; i < 3; ++i)
      mesh.vertices[v * word::stride + static_cast<size_t>(word::outline_normal + i)] = canonical(normal[i]);
  });
  add_corner_normals(mesh, welds, workers);
}

}  // namespace isoshade::scene
