// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
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

TEST(Mesh, TangentsAreUnitAndRunAlongUWithTheirNormalsAndUpRightHanded) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
      const auto corner = [&](size_t i, int at) { return vector_at(mesh, mesh.indices[t + i], at); };
      const auto uv = [&](size_t i) { return glm::vec2(corner(i, word::texcoord)); };
      // The texture's gradients over the triangle.
      const glm::vec3 e1 = corner(1, word::position) - corner(0, word::position);
      const glm::vec3 e2 = corner(2, word::position) - corner(0, word::position);
      const glm::vec2 d1 = uv(1) - uv(0), d2 = uv(2) - uv(0);
      const float sign = d1.x * d2.y - d2.x * d1.y < 0 ? -1.0f : 1.0f;
      const glm::vec3 along_u = sign * (d2.y * e1 - d1.y * e2), along_v = sign * (d1.x * e2 - d2.x * e1);
      for (size_t i = 0; i < 3; ++i) {
        const glm::vec3 tangent = corner(i, word::tangent), normal = corner(i, word::normal);
        ASSERT_NEAR(glm::length(tangent), 1.0f, 3e-7f);
        const bool pole = std::abs(normal.y) > 0.999f && shape.kind == MeshKind::sphere;
        ASSERT_NEAR(glm::dot(tangent, normal), 0.0f, pole ? 1e-4f : 3e-7f);
        ASSERT_GT(glm::dot(tangent, along_u), 0.0f) << "triangle " << t / 3;
        ASSERT_LT(glm::dot(glm::cross(normal, tangent), along_v), 0.0f) << "triangle " << t / 3;
        const float* rest = &mesh.vertices[mesh.indices[t + i] * word::stride + word::tangent + 3];
        ASSERT_EQ(std::vector<float>(rest, rest + 5), (std::vector<float>{1, 1, 1, 1, 1}));
      }
    }
  }
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
            "9ac6349b6b550ea4a3c596fdf657355b7a64f0dbe302d515eeb483aa2f3157f6");
  EXPECT_EQ(hash_of(scene::make_mesh({MeshKind::box, {1, 2, 3}, 64, 32})),
            "fba70acdc19de1bfa02ffd2e4c42eeb2b04b7c99350a3f913225e40c976f41c1");
}

}  // namespace
}  // namespace isoshade
