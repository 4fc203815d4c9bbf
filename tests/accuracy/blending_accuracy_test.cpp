// SPDX-License-Identifier: Apache-2.0
// Blended passes against the reference, and what they read against the scene.
#include <algorithm>
#include <cmath>

#include "backends/reference/backend.h"
#include "tests/equivalence/blending_scenes.h"

namespace isoshade::equivalence {
namespace {

class BlendingAccuracy : public SceneFolder {
 protected:
  BlendingAccuracy() { write_panes(folder_); }
};

TEST_F(BlendingAccuracy, ByTheReferenceIsClose) {
  const render::Plan made = plan({40, 30}, 1, forty_layers());
  const backends::Image image = draw(made, *cpu_backend()), exact = draw(made, *reference::create());
  ASSERT_EQ(image.rgba.size(), exact.rgba.size());
  float most = 0;
  for (size_t i = 0; i < image.rgba.size(); ++i)
    most = std::max(most, std::abs(image.rgba[i] - exact.rgba[i]) / std::max(1.0f, std::abs(exact.rgba[i])));
  EXPECT_LT(most, 2e-6f);
  EXPECT_EQ(image.depth, exact.depth);
}

TEST_F(BlendingAccuracy, SceneDepthTellsHowFarWhatIsOpaqueIs) {
  folder_.write("solid.json", R"({"isoshade": 1, "effect": "solid", "passes": [{"name": "p", "color": [1, 1, 1]}]})");
  folder_.write("lens.json", R"json({"isoshade": 1, "effect": "lens", "nodes": {
    "d": {"type": "scenedepth"}, "p": {"type": "position", "space": "view"},
    "x": {"type": "expression", "code": "color4(far + p.z, 0, 0, 1)", "far": "d.linear", "p": "p"}},
    "passes": [{"name": "base", "cull": "none", "blend": "over", "color": "x"}]})json");
  const auto plane = [](const std::string& name, const std::string& effect, const std::string& z) {
    return '"' + name + R"(": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": ")" + effect +
           R"(.json", "transform": {"rotate": [90, 0, 0], "translate": [0, 0, )" + z + "]}}";
  };
  const render::Plan made = plan({9, 7}, 1, R"("objects": {)" + plane("wall", "solid", "-1") + ", " +
                                                plane("pane", "over", "0") + ", " + plane("lens", "lens", "1") + "}");
  const backends::Image image = draw(made, *cpu_backend());
  EXPECT_NEAR(image.rgba[4 * (3 * 9 + 4)], 2, 1e-5) << "from the lens to the wall, whatever is blended between them";
}

}  // namespace
}  // namespace isoshade::equivalence
