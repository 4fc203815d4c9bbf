// SPDX-License-Identifier: Apache-2.0
// The node worldposition finds the points again that a camera sees, which are computed in double.
#include <cmath>

#include "runtime/lanes/float_rules.h"
#include "runtime/scene/placement.h"
#include "tests/equivalence/screen.h"

namespace isoshade::equivalence {
namespace {

constexpr const char* positions = R"json({"isoshade": 1, "post": "p", "nodes": {"d": {"type": "scenedepth"}, "p": {"type": "worldposition"},
  "color": {"type": "expression", "code": "color4(p.x, p.y, p.z, sky ? 1000 + d : d)", "p": "p", "d": "d.linear",
            "sky": "d.issky"}}, "outputs": {"color": "color"}})json";

/// Points that a camera sees are found again from their pixel and their depth.
void expect_points_found_again(const scene::Camera& camera) {
  constexpr int width = 31, height = 17;
  Pixels depth{width, height, std::vector<float>(width * height)};
  std::vector<glm::vec3> points(depth.floats.size());
  const lanes::FpGuard guard;
  const scene::View view = scene::make_view(camera, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // A point on the ray of the pixel, by the inverse of the projection in double.
      const bool perspective = camera.projection == scene::Projection::perspective;
      const double distance = 1.0 + 0.37 * x + 0.21 * y, aspect = double{width} / height;
      const double half = perspective ? std::tan(camera.fov * M_PI / 360) * distance : camera.height / 2.0;
      const double across = ((x + 0.5) / width * 2 - 1) * half * aspect,
                   up = (1 - (y + 0.5) / height * 2) * half;
      const size_t i = static_cast<size_t>(y) * width + static_cast<size_t>(x);
      for (int c = 0; c < 3; ++c)
        points[i][c] = static_cast<float>(view.inverse[3][c] + view.inverse[0][c] * across +
                                          view.inverse[1][c] * up - view.inverse[2][c] * distance);
      depth.floats[i] = static_cast<float>(
          perspective ? camera.near / distance : (camera.far - distance) / (camera.far - camera.near));
    }
  }
  depth.floats[0] = 0;
  Screen screen(std::make_shared<support::SourceFile>("post.json", positions), width, height, depth,
                {{1, 1, std::vector<float>(4)}});
  scene::store_camera(camera, width, height, screen.view);
  const std::vector<float> found = screen.interpreted();
  for (size_t i = 1; i < points.size(); ++i)
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(found[4 * i + static_cast<size_t>(c)], points[i][c], 2e-4f) << i << " " << c;
  const float sky = camera.projection == scene::Projection::perspective ? 1e9f : camera.far;
  EXPECT_EQ(found[3], 1000 + sky);
  EXPECT_NEAR(found[4 * 40 + 3], 1 + 0.37f * 9 + 0.21f, 1e-4f);
}

TEST(WorldPosition, IsReconstructedInPerspective) {
  scene::Camera camera;
  camera.position = {3, 40, -7};
  camera.target = {1, 38, -12};
  camera.fov = 50;
  expect_points_found_again(camera);
}

TEST(WorldPosition, IsReconstructedInOrthographic) {
  scene::Camera camera;
  camera.projection = scene::Projection::orthographic;
  camera.position = {3, 40, -7};
  camera.target = {1, 38, -12};
  camera.height = 6;
  camera.far = 60;
  expect_points_found_again(camera);
}

}  // namespace
}  // namespace isoshade::equivalence
