// SPDX-License-Identifier: Apache-2.0
// Pictures of the precision tiers, against that of the default.
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

TEST(TierPictures, DifferFromTheDefaultButStayNearIt) {
  const auto cpu = cpu_backend();
  const backends::Image expected = draw(plan(scene_path("material_balls"), 320, 180), *cpu);
  for (const functions::Tier tier : {functions::Tier::fast, functions::Tier::precise}) {
    const backends::Image image = draw(plan(scene_path("material_balls"), 320, 180, true, tier), *cpu);
    EXPECT_NE(image.rgba, expected.rgba) << functions::tier_name(tier);
    for (size_t i = 0; i < image.rgba.size(); ++i)
      ASSERT_NEAR(image.rgba[i], expected.rgba[i], 1e-3f + 1e-3f * expected.rgba[i])
          << functions::tier_name(tier);
  }
}

}  // namespace
}  // namespace isoshade::equivalence
