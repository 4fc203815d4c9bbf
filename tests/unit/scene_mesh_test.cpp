// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/sha256.h"
#include "runtime/scene/mesh.h"

namespace isoshade {
namespace {

using scene::Mesh;
using scene::MeshKind;
using scene::MeshShape;
namespace word = lower::vertex_word;

const std::vector<MeshShape> shapes = {
    {MeshKind::sphere, {1, 1, 1}, 64, 32},        {MeshKind::sphere, {1, 1, 1}, 3, 2},
    {MeshKind::sphere, {0.3f, 0.3f, 0.3f}, 7, 5}, {MeshKind::plane, {2, 0, 3}, 1, 32},
    {MeshKind::plane, {2, 0, 3}, 9, 32},          {MeshKind::box, {1, 2, 3}, 64, 32},
};

glm::vec3 vector_at(const Mesh& mesh, size_t vertex, int at) {
  const float* v = &mesh.vertices[vertex * word::stride + static_cast<size_t>(at)];
  return {v[0], v[1], v[2]};
}

std::string hash_of(const Mesh& mesh) {
  support::Sha256 hash;
  hash.add(mesh.vertices.data(), mesh.vertices.size() * sizeof(float));
  hash.add(mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
  return hash.hex();
}

TEST(Mesh, CountsAreKnownBeforehand) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    EXPECT_EQ(static_cast<int64_t>(mesh.vertices.size()), scene::vertex_count(shape) * word::stride);
    EXPECT_EQ(static_cast<int64_t>(mesh.indices.size()), scene::triangle_count(shape) * 3);
    for (const uint32_t index : mesh.indices) ASSERT_LT(index, mesh.vertices.size() / word::stride);
  }
}

TEST(Mesh, NormalsAreUnitAndAgreeWithTheWinding) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
      const glm::vec3 a = vector_at(mesh, mesh.indices[t], word::position);
      const glm::vec3 b = vector_at(mesh, mesh.indices[t + 1], word::position);
      const glm::vec3 c = vector_at(mesh, mesh.indices[t + 2], word::position);
      const glm::vec3 face = glm::cross(b - a, c - a);
      ASSERT_GT(glm::length(face), 0.0f) << "triangle " << t / 3 << " has no area";
      for (size_t corner = 0; corner < 3; ++corner) {
        const glm::vec3 normal = vector_at(mesh, mesh.indices[t + corner], word::normal);
        ASSERT_NEAR(glm::length(normal), 1.0f, 3e-7f);
        ASSERT_GT(glm::dot(normal, face), 0.0f) << "triangle " << t / 3;
      }
    }
  }
}

TEST(Mesh, ClosedMeshesHaveEveryEdgeTwiceInOppositeDirections) {
  using Point = std::array<float, 3>;
  for (const MeshShape& shape : shapes) {
    if (shape.kind == MeshKind::plane) continue;
    const Mesh mesh = scene::make_mesh(shape);
    const auto point = [&](size_t i) {
      const glm::vec3 p = vector_at(mesh, mesh.indices[i], word::position);
      return Point{p.x, p.y, p.z};  // by value: corners that share a point must share its bits
    };
    std::map<std::pair<Point, Point>, int> edges;
    for (size_t t = 0; t < mesh.indices.size(); t += 3)
      for (size_t e = 0; e < 3; ++e) ++edges[{point(t + e), point(t + (e + 1) % 3)}];
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
  }
}

TEST(Mesh, SpheresAreRoundAndTheirPolesPoints) {
  const Mesh mesh = scene::make_mesh({MeshKind::sphere, {2, 2, 2}, 64, 32});
  for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v)
    ASSERT_NEAR(glm::length(vector_at(mesh, v, word::position)), 2.0f, 1e-6f);
  EXPECT_EQ(mesh.low, glm::vec3(-2));  // through the poles and quarters exactly
  EXPECT_EQ(mesh.high, glm::vec3(2));
  const float v_of_top = mesh.vertices[word::texcoord + 1];
  EXPECT_EQ(v_of_top, 0.0f);
  EXPECT_EQ(vector_at(mesh, 0, word::position), glm::vec3(0, 2, 0));
}

TEST(Mesh, TextureRunsRightAndDownSeenFromOutside) {
  const Mesh sphere = scene::make_mesh({MeshKind::sphere, {1, 1, 1}, 4, 2});
  // The equator, from the seam at -z over -x, +z and +x.
  const size_t equator = 4;
  EXPECT_EQ(vector_at(sphere, equator, word::position), glm::vec3(0, 0, -1));
  EXPECT_EQ(vector_at(sphere, equator + 1, word::position), glm::vec3(-1, 0, 0));
  EXPECT_EQ(vector_at(sphere, equator + 2, word::position), glm::vec3(0, 0, 1));
  EXPECT_EQ(sphere.vertices[(equator + 2) * word::stride + word::texcoord], 0.5f);
  const Mesh plane = scene::make_mesh({MeshKind::plane, {2, 0, 4}, 1, 32});
  EXPECT_EQ(vector_at(plane, 0, word::position), glm::vec3(-1, 0, -2));
  EXPECT_EQ(plane.vertices[word::texcoord], 0.0f);
}

TEST(Mesh, HoldsNoDenormalsAndNoNegativeZeros) {
  for (const MeshShape& shape : shapes) {
    for (const float value : scene::make_mesh(shape).vertices) {
      ASSERT_TRUE(std::isnormal(value) || value == 0) << value;
    }
  }
}

TEST(Mesh, IsTheSameBitsOnEveryMachine) {
  // Recorded with g++ 12 on x86-64; any compiler and any level of optimisation must give it.
  EXPECT_EQ(hash_of(scene::make_mesh({MeshKind::sphere, {1, 1, 1}, 64, 32})),
            "1f29203aa1d5e3ad885cb43c5326166f874597df591cb650c1be006f224535db");
  EXPECT_EQ(hash_of(scene::make_mesh({MeshKind::box, {1, 2, 3}, 64, 32})),
            "f2c1f47c9c5d58766b419413adc849fa08ad4e19f1e0fa0c96e60c3a77fed4c0");
}

}  // namespace
}  // namespace isoshade
