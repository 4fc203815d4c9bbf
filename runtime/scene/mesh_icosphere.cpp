// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "compiler/functions/inverse_trigonometric.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade::scene {
namespace {

using Corners = std::array<uint32_t, 3>;

constexpr float pi = 3.14159274f;

/// Points on the unit sphere, and triangles.
struct Ball {
  std::vector<glm::vec3> points;
  std::vector<Corners> triangles;
};

/// The icosahedron with a vertex at each pole.
Ball icosahedron() {
  Ball ball;
  const float height = 1.0f / std::sqrt(5.0f);
  const auto add_ring = [&](int64_t offset, float y) {
    for (int64_t i = 0; i < 5; ++i) {
      const SinCos longitude = sin_cos_of_turn(2 * i + offset, 10);
      ball.points.push_back(
          normalize(glm::vec3(-2 * height * longitude.sin, y, -2 * height * longitude.cos)));
    }
  };
  ball.points.emplace_back(0, 1, 0);
  add_ring(0, height);
  add_ring(1, -height);
  ball.points.emplace_back(0, -1, 0);
  for (uint32_t i = 0; i < 5; ++i) {
    const uint32_t upper = 1 + i, next_upper = 1 + (i + 1) % 5;
    const uint32_t lower = 6 + i, next_lower = 6 + (i + 1) % 5;
    ball.triangles.push_back({0, upper, next_upper});
    ball.triangles.push_back({upper, lower, next_upper});
    ball.triangles.push_back({lower, next_lower, next_upper});
    ball.triangles.push_back({lower, 11, next_lower});
  }
  return ball;
}

/// Numbers of pairs: an open hash table.
class Pairs {
 public:
  /// For at most so many pairs.
  explicit Pairs(size_t most) : slots_(std::bit_ceil(2 * most + 1)) {}

  /// The number of the pair, and whether it is new; it then gets the number `next`.
  std::pair<uint32_t, bool> try_emplace(uint32_t a, uint32_t b, size_t next) {
    const uint64_t pair = uint64_t{a} << 32 | b, mixed = pair * 0x9e3779b97f4a7c15u;
    size_t at = static_cast<size_t>(mixed ^ (mixed >> 32)) & (slots_.size() - 1);
    while (slots_[at].is_used && slots_[at].pair != pair) at = (at + 1) & (slots_.size() - 1);
    const bool is_new = !slots_[at].is_used;
    if (is_new) slots_[at] = {pair, static_cast<uint32_t>(next), true};
    return {slots_[at].number, is_new};
  }

 private:
  struct Slot {
    uint64_t pair = 0;
    uint32_t number = 0;
    bool is_used = false;
  };
  std::vector<Slot> slots_;
};

/// Divides each triangle into four.
Ball subdivided(const Ball& coarse) {
  Ball fine{coarse.points, {}};
  Pairs middles(coarse.triangles.size() * 3 / 2);  // one for each edge
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [number, is_new] = middles.try_emplace(std::min(a, b), std::max(a, b), fine.points.size());
    if (is_new) fine.points.push_back(normalize(coarse.points[a] + coarse.points[b]));
    return number;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Corners& corners : {Corners{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      fine.triangles.push_back(corners);
  }
  return fine;
}

bool is_pole(const glm::vec3& p) { return p.x == 0 && p.z == 0; }

/// Longitude as a fraction of a turn, from -z over -x; in [0, 1).
float longitude_of(const glm::vec3& p) {
  const float turn = functions::atan2(-p.x, -p.z) / (2 * pi);
  return turn < 0 ? turn + 1 : turn;
}

/// Latitude from 0 at the north pole to 1 at the south pole.
float latitude_of(const glm::vec3& p) { return functions::atan2(std::sqrt(p.x * p.x + p.z * p.z), p.y) / pi; }

struct Placing {
  float u;
  glm::vec3 tangent;
};

/// The u of the corners: a triangle across the seam continues beyond 1; a corner at a pole has the mean of the other two.
std::array<Placing, 3> place(const std::array<glm::vec3, 3>& points) {
  std::array<Placing, 3> corners;
  float low = 1, high = 0;
  for (size_t i = 0; i < 3; ++i) {
    if (is_pole(points[i])) continue;
    corners[i] = {longitude_of(points[i]), normalize(glm::vec3(points[i].z, 0, -points[i].x))};
    low = std::min(low, corners[i].u);
    high = std::max(high, corners[i].u);
  }
  for (size_t i = 0; i < 3; ++i)
    if (!is_pole(points[i]) && high - low > 0.5f && corners[i].u < 0.5f) corners[i].u += 1;
  for (size_t i = 0; i < 3; ++i) {
    if (!is_pole(points[i])) continue;
    const Placing &next = corners[(i + 1) % 3], &after = corners[(i + 2) % 3];
    corners[i] = {(next.u + after.u) * 0.5f, normalize(next.tangent + after.tangent)};
  }
  return corners;
}

}  // namespace

void make_icosphere(const MeshShape& shape, Mesh& mesh) {
  Ball ball = icosahedron();
  for (int i = 0; i < shape.rings; ++i) ball = subdivided(ball);
  Pairs known(3 * ball.triangles.size());  // by point and bits of u
  for (const Corners& triangle : ball.triangles) {
    const std::array<Placing, 3> placed =
        place({ball.points[triangle[0]], ball.points[triangle[1]], ball.points[triangle[2]]});
    std::array<int64_t, 3> vertices;
    for (size_t i = 0; i < 3; ++i) {
      const glm::vec3& point = ball.points[triangle[i]];
      const auto [number, is_new] = known.try_emplace(triangle[i], std::bit_cast<uint32_t>(placed[i].u),
                                                      static_cast<size_t>(vertices_of(mesh)));
      vertices[i] = number;
      if (is_new)
        add_vertex(mesh, point * shape.size.x, point, placed[i].u, latitude_of(point), placed[i].tangent);
    }
    add_triangle(mesh, vertices[0], vertices[1], vertices[2]);
  }
}

}  // namespace isoshade::scene
