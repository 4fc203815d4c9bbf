// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

using scene::Camera;
using scene::Object;
namespace word = lower::light_word;

glm::vec4 clip_of(const scene::View& view, glm::vec3 point) {
  return scene::multiply(view.projection, glm::vec4(point, 1));
}

void expect_near(const glm::vec4& a, const glm::vec4& b, float tolerance = 1e-5f) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

TEST(Placement, AnglesAreExactAtQuarterTurnsAndSymmetric) {
  const lanes::FpGuard guard;
  constexpr float sines[] = {0, 1, 0, -1};
  for (int quarter = -40; quarter <= 40; ++quarter) {
    const scene::SinCos angle = scene::sin_cos_of_degrees(90.0f * static_cast<float>(quarter));
    EXPECT_EQ(angle.sin, sines[quarter & 3]);
    EXPECT_EQ(angle.cos, sines[(quarter + 1) & 3]);
  }
  for (int64_t part = 0; part <= 36; ++part) {
    const scene::SinCos angle = scene::sin_cos_of_turn(part, 36);
    const scene::SinCos mirrored = scene::sin_cos_of_turn(36 - part, 36);
    const double radians = static_cast<double>(part) / 36 * 2 * M_PI;
    EXPECT_NEAR(angle.sin, std::sin(radians), 1.5e-7);
    EXPECT_NEAR(angle.cos, std::cos(radians), 1.5e-7);
    EXPECT_EQ(angle.sin, -mirrored.sin);
    EXPECT_EQ(angle.cos, mirrored.cos);
  }
}

TEST(Placement, PerspectiveDepthIsReversedWithAnInfiniteFarPlane) {
  const lanes::FpGuard guard;
  Camera camera;
  camera.position = {1, 2, 3};
  camera.target = {1, 2, 2};
  camera.near = 0.25f;
  const scene::View view = scene::make_view(camera, 640, 360);
  const glm::vec4 near = clip_of(view, {1, 2, 2.75f});
  EXPECT_EQ(near.z, near.w);
  const glm::vec4 far = clip_of(view, {1, 2, 3 - 1e6f});
  EXPECT_EQ(far.z, 0.25f);
  EXPECT_EQ(far.w, 1e6f);
  EXPECT_EQ(view.eye, glm::vec4(1, 2, 3, 1));
}

TEST(Placement, FieldOfViewIsVerticalAndPixelsAreSquare) {
  const lanes::FpGuard guard;
  Camera camera;
  camera.fov = 90;
  const scene::View view = scene::make_view(camera, 200, 100);
  const glm::vec4 top_right = clip_of(view, {20, 10, -10});
  EXPECT_NEAR(top_right.x, top_right.w, 1e-5f);
  EXPECT_NEAR(top_right.y, top_right.w, 1e-5f);
}

TEST(Placement, OrthographicDepthIsLinear) {
  const lanes::FpGuard guard;
  Camera camera;
  camera.projection = scene::Projection::orthographic;
  camera.position = {0, 0, 10};
  camera.target = {0, 0, 0};
  camera.height = 4;
  camera.near = 2;
  camera.far = 18;
  const scene::View view = scene::make_view(camera, 100, 100);
  expect_near(clip_of(view, {2, 2, 8}), {1, 1, 1, 1});
  expect_near(clip_of(view, {-2, -2, 0}), {-1, -1, 0.5f, 1});
  expect_near(clip_of(view, {0, 0, -8}), {0, 0, 0, 1});
  EXPECT_EQ(view.eye, glm::vec4(0, 0, 1, 0));
}

TEST(Placement, ScalesThenRotatesThenTranslates) {
  const lanes::FpGuard guard;
  Object object;
  object.transform.scale = {2, 3, 4};
  object.transform.rotate = {90, 0, 90};  // about x, then about z
  object.transform.translate = {10, 20, 30};
  const glm::mat4 model = scene::model_matrix(object, {});
  EXPECT_EQ(scene::multiply(model, glm::vec4(1, 0, 0, 1)), glm::vec4(10, 22, 30, 1));
  EXPECT_EQ(scene::multiply(model, glm::vec4(0, 1, 0, 1)), glm::vec4(10, 20, 33, 1));
  EXPECT_EQ(scene::multiply(model, glm::vec4(0, 0, 1, 1)), glm::vec4(14, 20, 30, 1));
}

TEST(Placement, QuaternionsMatchEulerAngles) {
  const lanes::FpGuard guard;
  Object by_angle;
  by_angle.transform.rotate = {0, 60, 0};
  Object by_quaternion;
  by_quaternion.transform.rotation = {{0, 0.5f, 0, 0.8660254f}};
  for (const glm::vec4& point : {glm::vec4(1, 0, 0, 1), glm::vec4(0, 1, 0, 1), glm::vec4(0, 0, 1, 1)}) {
    expect_near(scene::multiply(scene::model_matrix(by_angle, {}), point),
                scene::multiply(scene::model_matrix(by_quaternion, {}), point), 1e-6f);
  }
}

TEST(Placement, NormalsStayPerpendicularUnderScalingAndMirroring) {
  const lanes::FpGuard guard;
  for (const float mirror : {1.0f, -1.0f}) {
    Object object;
    object.transform.scale = {mirror * 4, 1, 1};
    object.transform.rotate = {0, 0, 30};
    const glm::mat4 model = scene::model_matrix(object, {});
    // The plane x + y = 0, which the scale tilts.
    const glm::vec4 tangent = scene::multiply(model, glm::vec4(1, -1, 0, 0));
    const glm::mat3 normals = scene::normal_matrix(model);
    const glm::vec3 normal = normals * glm::vec3(1, 1, 0);
    EXPECT_NEAR(scene::dot(normal, glm::vec3(tangent)), 0.0f, 1e-5f);
    const glm::vec4 outward = scene::multiply(model, glm::vec4(1, 1, 0, 0));
    EXPECT_GT(scene::dot(normal, glm::vec3(outward)), 0.0f);
  }
}

TEST(Placement, InverseMatricesMapPointsBack) {
  const lanes::FpGuard guard;
  scene::Object object;
  object.transform.scale = {-2, 0.25f, 3};
  object.transform.rotate = {20, 130, -40};
  object.transform.translate = {5, -6, 7};
  const glm::mat4 model = scene::model_matrix(object, {});
  const scene::View view = scene::make_view({.position = {1, 2, 3}, .target = {-4, 0, 1}}, 640, 360);
  const std::pair<glm::mat4, glm::mat4> pairs[] = {{model, scene::affine_inverse(model)},
                                                   {view.view, view.inverse}};
  for (const auto& [there, back] : pairs) {
    const glm::mat4 product = scene::multiply(back, there);
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) EXPECT_NEAR(product[c][r], c == r ? 1.0f : 0.0f, 1e-5f);
  }
  EXPECT_EQ(scene::multiply(view.view, glm::vec4(1, 2, 3, 1)), glm::vec4(0, 0, 0, 1));
}

TEST(Placement, LightRecordsPointTowardsTheLight) {
  const lanes::FpGuard guard;
  scene::Light sun;
  sun.direction = {0, -2, 0};
  sun.color = {1, 0.5f, 0.25f};
  sun.intensity = 4;
  const auto record = scene::light_record(sun);
  EXPECT_EQ(record[word::kind], 0.0f);
  EXPECT_EQ(record[word::direction + 1], 1.0f);
  EXPECT_EQ(record[word::color + 2], 1.0f);
  EXPECT_EQ(record[word::range], 0.0f);
}

TEST(Placement, SpotFalloffRunsFromInnerToOuterAngle) {
  const lanes::FpGuard guard;
  scene::Light spot;
  spot.kind = scene::LightKind::spot;
  spot.inner_angle = 20;
  spot.outer_angle = 60;
  spot.range = 5;
  const auto record = scene::light_record(spot);
  const auto falloff = [&](float cosine) {
    return cosine * record[word::cone_scale] + record[word::cone_offset];
  };
  EXPECT_NEAR(falloff(std::cos(20 * static_cast<float>(M_PI) / 180)), 1.0f, 1e-6f);
  EXPECT_NEAR(falloff(0.5f), 0.0f, 1e-6f);
  EXPECT_EQ(record[word::range], 0.04f);
  scene::Light point;
  point.kind = scene::LightKind::point;
  EXPECT_EQ(scene::light_record(point)[word::cone_scale], 0.0f);
  EXPECT_EQ(scene::light_record(point)[word::cone_offset], 1.0f);
  spot.inner_angle = 0;
  spot.outer_angle = 0.01f;
  for (const float value : scene::light_record(spot)) EXPECT_TRUE(std::isfinite(value));
}

TEST(Placement, ExtremeScenesStayFinite) {
  const lanes::FpGuard guard;
  Camera camera;
  camera.position = {1e9f, 1e9f, 1e9f};
  camera.target = {-1e9f, 1e9f, 1e9f};
  camera.fov = 0.01f;
  camera.near = 1e9f;
  Object object;
  object.transform.scale = {1e6f, -1e6f, 1e-6f};
  object.transform.translate = {-1e9f, -1e9f, -1e9f};
  object.repeat = {{65536, {1e9f, 1e9f, 1e9f}, {}}};
  const glm::mat4 model = scene::model_matrix(object, {{65535, 0, 0}});
  const glm::mat4 projected = scene::multiply(scene::make_view(camera, 1, 8192).projection, model);
  const glm::mat3 normals = scene::normal_matrix(model);
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(projected[c][r]));
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_TRUE(std::isfinite(normals[c][r]));
}

TEST(Placement, CanonicalFlushesDenormalsAndUnifiesNans) {
  EXPECT_EQ(std::signbit(scene::canonical(-1e-40f)), true);
  EXPECT_EQ(scene::canonical(1e-40f), 0.0f);
  EXPECT_EQ(std::bit_cast<uint32_t>(scene::canonical(std::bit_cast<float>(0xffc12345u))), 0x7fc00000u);
  EXPECT_EQ(scene::canonical(-1.5f), -1.5f);
}

}  // namespace
}  // namespace isoshade
