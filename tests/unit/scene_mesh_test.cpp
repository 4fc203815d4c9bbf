// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>
#include <map>

#include "compiler/functions/octahedral.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/sha256.h"
#include "runtime/scene/mesh.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade {
namespace {

using scene::Mesh;
using scene::MeshKind;
using scene::MeshShape;
namespace word = lower::vertex_word;

MeshShape lathe(std::vector<scene::ProfilePoint> profile) {
  return {MeshKind::lathe, {1, 1, 1}, 12, 1, true, std::move(profile)};
}

const std::vector<MeshShape> shapes = {
    {MeshKind::sphere, {1, 1, 1}, 64, 32},
    {MeshKind::sphere, {1, 1, 1}, 3, 2},
    {MeshKind::sphere, {0.3f, 0.3f, 0.3f}, 7, 5},
    {MeshKind::plane, {2, 0, 3}, 1, 32},
    {MeshKind::plane, {2, 0, 3}, 9, 32},
    {MeshKind::box, {1, 2, 3}, 64, 32},
    {MeshKind::icosphere, {1, 1, 1}, 1, 0},
    {MeshKind::icosphere, {2, 2, 2}, 1, 3},
    {MeshKind::cylinder, {1, 2, 1}, 64, 1},
    {MeshKind::cylinder, {0.5f, 3, 1}, 3, 4},
    {MeshKind::cone, {1, 2, 1}, 64, 1},
    {MeshKind::cone, {2, 0.5f, 1}, 5, 3},
    {MeshKind::torus, {1, 0.25f, 1}, 64, 32},
    {MeshKind::torus, {1, 0.9f, 1}, 7, 5},
    lathe({{0, 0}, {1, 0}, {1.5f, 1}, {1, 2}, {0, 2.5f}}),  // round
    lathe({{0, 0, false}, {1, 0, false}, {1.2f, 2, false}, {1, 2, false}, {0.8f, 0.2f, false}, {0, 0.2f}}),
    lathe({{1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0}}),  // a ring
    lathe({{1, 0, false}, {2, 0}, {2, 1, false}, {1, 0.5f}, {1, 0}}),
};

glm::vec3 vector_at(const Mesh& mesh, size_t vertex, int at) {
  const float* v = &mesh.vertices[vertex * word::stride + static_cast<size_t>(at)];
  return {v[0], v[1], v[2]};
}

/// Of some words of each vertex, and the indices.
std::string hash_of(const Mesh& mesh, int first, int last) {
  support::Sha256 hash;
  for (size_t v = 0; v < mesh.vertices.size(); v += word::stride)
    hash.add(&mesh.vertices[v + static_cast<size_t>(first)],
             static_cast<size_t>(last - first) * sizeof(float));
  hash.add(mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
  return hash.hex();
}

TEST(Mesh, IndicesAreInRange) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    EXPECT_EQ(mesh.indices.size() % 3, 0u);
    EXPECT_FALSE(mesh.indices.empty());
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

TEST(Mesh, ClosedMeshesAreWatertightAndOriented) {
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

TEST(Mesh, SpheresHaveTheirRadiusAndExactPoles) {
  const Mesh mesh = scene::make_mesh({MeshKind::sphere, {2, 2, 2}, 64, 32});
  for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v)
    ASSERT_NEAR(glm::length(vector_at(mesh, v, word::position)), 2.0f, 1e-6f);
  EXPECT_EQ(mesh.low, glm::vec3(-2));  // through the poles and quarters exactly
  EXPECT_EQ(mesh.high, glm::vec3(2));
  const float v_of_top = mesh.vertices[word::texcoord + 1];
  EXPECT_EQ(v_of_top, 0.0f);
  EXPECT_EQ(vector_at(mesh, 0, word::position), glm::vec3(0, 2, 0));
}

TEST(Mesh, TexcoordsRunRightAndDownSeenFromOutside) {
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

TEST(Mesh, TangentsAreUnitAlongUAndRightHanded) {
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

TEST(Mesh, ContainsNoDenormalsOrNegativeZeros) {
  for (const MeshShape& shape : shapes) {
    for (const float value : scene::make_mesh(shape).vertices) {
      ASSERT_TRUE(std::isnormal(value) || value == 0) << value;
    }
  }
}

TEST(Mesh, HasTheSameBitsOnEveryMachine) {
  // Recorded with g++ 12 on x86-64; any compiler and any level of optimisation must give it.
  struct Recorded {
    MeshShape shape;
    const char* shading;
    const char* outline;
  };
  const Recorded recorded[] = {
      {{MeshKind::sphere, {1, 1, 1}, 64, 32},
       "9ac6349b6b550ea4a3c596fdf657355b7a64f0dbe302d515eeb483aa2f3157f6",
       "8f7de80c90aff2e578796caff015ebb0e4dc93815b739e65e7f6846880798f77"},
      {{MeshKind::box, {1, 2, 3}, 64, 32},
       "fba70acdc19de1bfa02ffd2e4c42eeb2b04b7c99350a3f913225e40c976f41c1",
       "4ea79da1e394847411817209deb42f25561ed60fbc86d2ffcf3d8135e1c96296"},
      {{MeshKind::icosphere, {1, 1, 1}, 1, 4},
       "5fa623959f1fed473fa2ea453011644a3fcd82fddd591f0dd893468fc6e09cdf",
       "b7268f0f03accede8e18bd47abb4544bea90e7006a9f4e9785a9a65ee2137c6c"},
      {{MeshKind::cone, {1, 2, 1}, 64, 1},
       "063995bfe5839b86dbe46769fd34bae88dd365886d1de71983d025d373827726",
       "0a49889c070b5adb2109592af7c5ff42d12dbf2725260292d9394967f6bdd136"},
      {{MeshKind::torus, {1, 0.25f, 1}, 64, 32},
       "f780683c94db38b6c705156f4badfb1167f5af1e6f0ec7d0de923a6efc33ad8c",
       "d907f09edc60036798ffe7dc6f5fbc336c858d0d2bee0603297c4b1b937e81ab"},
      {lathe({{0, 0}, {1, 0, false}, {1.5f, 1}, {1, 2}, {0, 2.5f}}),
       "e522fc733bbeb2d2a028c9d6eebc80d9e6ad47adf1f07e5c3d068a654a4936ed",
       "d4661d03e6554b1c4d2da12f06dbfeff43f8c503f48a13688e3b7bd76b32e4cf"},
  };
  for (const Recorded& expected : recorded) {
    const Mesh mesh = scene::make_mesh(expected.shape);
    EXPECT_EQ(hash_of(mesh, 0, word::outline_normal), expected.shading);
    EXPECT_EQ(hash_of(mesh, word::outline_normal, word::corner_normals), expected.outline);
  }
}

TEST(OutlineNormals, PointDiagonallyAtCubeCorners) {
  // Whichever way the two triangles of a face lie: it is the angle that counts.
  for (const float size : {1.0f, 2e-6f, 1e6f}) {
    const Mesh cube = scene::make_mesh({MeshKind::box, glm::vec3(size), 1, 1});
    for (size_t v = 0; v < cube.vertices.size() / word::stride; ++v) {
      const glm::vec3 corner = vector_at(cube, v, word::position) / (0.5f * size);
      const glm::vec3 outline = vector_at(cube, v, word::outline_normal);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(outline[axis], corner[axis] / std::sqrt(3.0f), 3e-7f);
    }
  }
}

TEST(OutlineNormals, AreUnitAndSharedByVerticesAtOnePosition) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    std::map<std::array<float, 3>, glm::vec3> known;
    for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v) {
      const glm::vec3 p = vector_at(mesh, v, word::position);
      const glm::vec3 outline = vector_at(mesh, v, word::outline_normal);
      ASSERT_NEAR(glm::length(outline), 1.0f, 3e-7f);
      ASSERT_EQ(known.try_emplace({p.x, p.y, p.z}, outline).first->second, outline);
    }
  }
}

TEST(OutlineNormals, MatchTheNormalsOfSmoothMeshes) {
  for (const MeshShape& shape : {shapes[0], MeshShape{MeshKind::icosphere, {1, 1, 1}, 1, 4},
                                 MeshShape{MeshKind::torus, {1, 0.25f, 1}, 64, 32}}) {
    const Mesh mesh = scene::make_mesh(shape);
    for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v)
      ASSERT_GT(glm::dot(vector_at(mesh, v, word::outline_normal), vector_at(mesh, v, word::normal)),
                0.9999f);
  }
}

glm::vec3 corner_normal(const Mesh& mesh, size_t vertex, int which) {
  const lanes::FpGuard guard;
  const size_t at = vertex * word::stride + static_cast<size_t>(word::corner_normals + which);
  const auto n = functions::octahedral_decode(mesh.vertices[at]);
  return glm::normalize(glm::vec3(n[0], n[1], n[2]));
}

TEST(CornerNormals, AreTheThreeFaceNormalsAtBoxCorners) {
  const Mesh box = scene::make_mesh({MeshKind::box, glm::vec3(2, 3, 5), 1, 1});
  for (size_t v = 0; v < box.vertices.size() / word::stride; ++v) {
    const glm::vec3 corner = glm::sign(vector_at(box, v, word::position));
    glm::vec3 sum(0);
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 normal = corner_normal(box, v, i);
      EXPECT_EQ(glm::abs(normal.x) + glm::abs(normal.y) + glm::abs(normal.z), 1.0f);
      sum += normal;
    }
    EXPECT_EQ(sum, corner);
  }
}

TEST(CornerNormals, AreSharedAtOnePositionAndEqualOutlineNormalsIfSmooth) {
  for (const MeshShape& shape : shapes) {
    const Mesh mesh = scene::make_mesh(shape);
    std::map<std::array<float, 3>, std::array<glm::vec3, 3>> known;
    for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v) {
      const glm::vec3 p = vector_at(mesh, v, word::position);
      const std::array<glm::vec3, 3> corners{corner_normal(mesh, v, 0), corner_normal(mesh, v, 1),
                                             corner_normal(mesh, v, 2)};
      ASSERT_EQ(known.try_emplace({p.x, p.y, p.z}, corners).first->second, corners);
      if (shape.kind != MeshKind::torus && shape.kind != MeshKind::icosphere) continue;
      for (const glm::vec3& corner : corners)
        ASSERT_GT(glm::dot(corner, vector_at(mesh, v, word::outline_normal)), 0.999f);
    }
  }
}

TEST(CornerNormals, PackingErrorIsAtMost1100Microradians) {
  const lanes::FpGuard guard;
  for (int i = 0; i < 20'000; ++i) {
    const float z = std::sin(0.37f * static_cast<float>(i)), angle = 1.7f * static_cast<float>(i);
    const float ring = std::sqrt(1 - z * z);
    const glm::vec3 v(ring * std::cos(angle), ring * std::sin(angle), z);
    const auto n = functions::octahedral_decode(functions::octahedral_encode({v.x, v.y, v.z}));
    const glm::vec3 unpacked = glm::normalize(glm::vec3(n[0], n[1], n[2]));
    ASSERT_LE(glm::length(glm::cross(unpacked, v)), 1.1e-3f) << v.x << " " << v.y << " " << v.z;
    ASSERT_GT(glm::dot(unpacked, v), 0);
  }
}

TEST(OutlineNormals, FallBackToShadingNormalsIfSidesCancel) {
  Mesh sheet = scene::make_mesh({MeshKind::plane, {1, 0, 1}, 1, 1});
  const size_t words = sheet.vertices.size(), corners = sheet.indices.size();
  for (size_t i = 0; i < words; ++i) {
    const auto place = static_cast<int>(i % word::stride);
    sheet.vertices.push_back(place == word::normal + 1 ? -sheet.vertices[i] : sheet.vertices[i]);
  }
  for (size_t i = 0; i < corners; ++i)
    sheet.indices.push_back(sheet.indices[corners - 1 - i] + static_cast<uint32_t>(words / word::stride));
  scene::add_outline_normals(sheet);
  for (size_t v = 0; v < sheet.vertices.size() / word::stride; ++v)
    EXPECT_EQ(vector_at(sheet, v, word::outline_normal), glm::vec3(0, v < words / word::stride ? 1 : -1, 0));
}

TEST(Lathe, HasHardEdgesWhereItsProfileIsNotSmooth) {
  const auto normals_at_the_rim = [](bool smooth) {
    const Mesh mesh = scene::make_mesh(lathe({{0, 0}, {1, 0, smooth}, {1, 1, false}}));
    std::vector<float> ups;
    for (size_t v = 0; v < mesh.vertices.size() / word::stride; ++v)
      if (vector_at(mesh, v, word::position) == glm::vec3(0, 0, -1))
        ups.push_back(vector_at(mesh, v, word::normal).y);
    return ups;
  };
  EXPECT_EQ(normals_at_the_rim(false), (std::vector<float>{0, 0, -1, -1}));  // the seam's two ends of each
  const std::vector<float> smooth = normals_at_the_rim(true);
  ASSERT_EQ(smooth.size(), 2u);
  EXPECT_NEAR(smooth[0], -std::sqrt(0.5f), 1e-6f);
}

TEST(Icosphere, SubdivisionQuadruplesTheTriangles) {
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(scene::make_mesh({MeshKind::icosphere, {1, 1, 1}, 1, i}).indices.size(), 60u << (2 * i));
}

TEST(Cylinder, IsOpenWithoutCaps) {
  MeshShape shape{MeshKind::cylinder, {1, 2, 1}, 8, 1};
  EXPECT_EQ(scene::make_mesh(shape).indices.size(), 3u * (16 + 8 + 8));
  shape.caps = false;
  EXPECT_EQ(scene::make_mesh(shape).indices.size(), 3u * 16);
}

}  // namespace
}  // namespace isoshade
