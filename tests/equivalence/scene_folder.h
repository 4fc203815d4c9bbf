// SPDX-License-Identifier: Apache-2.0
// A folder with effects, and plans of scenes that use them.
#pragma once

#include <deque>
#include <string>

#include "tests/equivalence/scenes.h"
#include "tests/unit/scene_documents.h"
#include "tests/unit/temporary_folder.h"

namespace isoshade::equivalence {

struct Size {
  int width, height;
};

inline std::string text(Size size, int samples) {
  return std::to_string(size.width) + "x" + std::to_string(size.height) + ", " + std::to_string(samples) + " samples";
}

class SceneFolder : public ::testing::Test {
 protected:
  /// The plan of a scene with these members.
  render::Plan plan(Size size, int samples, const std::string& members, bool skip = true) {
    support::Diagnostics diagnostics;
    const auto document = isoshade::testing::document_of(isoshade::testing::scene_text(members), diagnostics,
                                                         (folder_.path() / "scene.json").string());
    auto scene = document ? scene::parse_scene(*document, diagnostics) : std::nullopt;
    EXPECT_TRUE(scene) << diagnostics.text();
    scenes_.push_back(scene ? std::move(*scene) : scene::Scene());
    scenes_.back().samples = samples;
    return equivalence::plan(scenes_.back(), size.width, size.height, skip);
  }

  isoshade::testing::TemporaryFolder folder_;
  std::deque<scene::Scene> scenes_;
};

}  // namespace isoshade::equivalence
