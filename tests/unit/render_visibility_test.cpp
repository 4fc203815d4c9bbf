// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "runtime/lanes/float_rules.h"
#include "runtime/render/visibility.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"

namespace isoshade {
namespace {

using render::outside_view;

constexpr int width = 200;
constexpr int height = 100;

/// At the origin, looking along -z; the sides of the view are at 45 degrees above and below.
glm::mat4 projection() {
  const lanes::FpGuard guard;
  scene::Camera camera;
  camera.fov = 90;
  camera.near = 1;
  return scene::make_view(camera, width, height).projection;
}

bool cube_outside(glm::vec3 centre, float half) {
  return outside_view(centre - half, centre + half, projection(), width, height);
}

TEST(Visibility, KeepsBoxesThatReachIntoTheView) {
  EXPECT_FALSE(cube_outside({0, 0, -10}, 1));
  EXPECT_FALSE(cube_outside({0, 11, -10}, 1));   // its lower edge, at the back
  EXPECT_FALSE(cube_outside({-21, 0, -10}, 1));  // twice as wide as high
  EXPECT_FALSE(cube_outside({0, 0, 0}, 2));      // around the camera
  EXPECT_FALSE(cube_outside({0, 0, 0}, 1e6f));   // around everything
  EXPECT_FALSE(cube_outside({0, 0, -1e8f}, 1));  // the view has no end
}

TEST(Visibility, SkipsBoxesOutsideOnePlane) {
  EXPECT_TRUE(cube_outside({0, 0, 10}, 1));         // behind
  EXPECT_TRUE(cube_outside({0, 0, -0.5f}, 0.25f));  // before the near plane
  EXPECT_TRUE(cube_outside({0, 13, -10}, 1));
  EXPECT_TRUE(cube_outside({0, -13, -10}, 1));
  EXPECT_TRUE(cube_outside({24, 0, -10}, 1));
  EXPECT_TRUE(cube_outside({-24, 0, -10}, 1));
}

TEST(Visibility, LeavesAMarginForSnapping) {
  // A pixel is a fiftieth of the half height.
  EXPECT_FALSE(cube_outside({0, 10.05f, -10}, 0.01f));
  EXPECT_TRUE(cube_outside({0, 10.5f, -10}, 0.01f));
}

TEST(Visibility, KeepsBoxesWithNonFiniteBounds) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const glm::mat4 view = projection();
  EXPECT_FALSE(outside_view({-inf, 20, -10}, {inf, 21, -10}, view, width, height));
  EXPECT_FALSE(outside_view({nan, 20, 10}, {nan, 21, 11}, view, width, height));
  EXPECT_FALSE(outside_view({0, 0, 5}, {1, 1, 6}, glm::mat4(nan), width, height));
}

TEST(Visibility, NeverSkipsABoxWithAPointInTheView) {
  // Boxes around random points in the view, through random transforms.
  uint32_t state = 1;
  const auto random = [&](float low, float high) {
    state = state * 1664525u + 1013904223u;
    return low + (high - low) * static_cast<float>(state >> 8) * 0x1p-24f;
  };
  const glm::mat4 view = projection();
  const lanes::FpGuard guard;
  for (int i = 0; i < 20000; ++i) {
    scene::Object object;
    object.transform.rotate = {random(-180, 180), random(-180, 180), random(-180, 180)};
    object.transform.scale = glm::vec3(random(0.001f, 1000), random(0.001f, 1000), random(0.001f, 1000));
    const float z = -std::exp2(random(0.01f, 20));
    object.transform.translate = {z * random(-1.99f, 1.99f), z * random(-0.99f, 0.99f), z};
    const glm::mat4 projected = scene::multiply(view, scene::model_matrix(object, {}));
    const glm::vec3 low{random(-1, 0), random(-1, 0), random(-1, 0)};
    const glm::vec3 high{random(0, 1), random(0, 1), random(0, 1)};
    ASSERT_FALSE(outside_view(low, high, projected, width, height)) << i;
  }
}

}  // namespace
}  // namespace isoshade
