// SPDX-License-Identifier: Apache-2.0
// Pixels that are not finite: how many there are, and which object or post made them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

struct Plan;

/// Pixels of which a channel is infinite or NaN.
struct NonFinite {
  int64_t count = 0;
  int x = 0, y = 0;  ///< the first, row by row from the top
};

/// `rgba`: 4 floats a pixel, `width` pixels a row.
NonFinite find_non_finite(std::span<const float> rgba, int width);

/// Where the pixels that are not finite come from.
struct NonFiniteReport {
  NonFinite drawn;   ///< before the posts
  int object = -1;   ///< the first word of the record of the object that the first of `drawn` shows; -1: unknown
  struct Post {
    size_t post;  ///< in Scene::posts
    NonFinite made;
  };
  std::vector<Post> posts;  ///< that made some though every image they read was finite
  NonFinite result;         ///< after the posts that have run

  bool none() const { return drawn.count == 0 && posts.empty() && result.count == 0; }
};

/// The first word of the record of the object that a sample shows, of those that are opaque; -1 if it shows none. `depth`: of the sample as it was
/// drawn, which tells whether a cut-out let it show what is behind.
int object_at(std::span<const int32_t> triangles, int x, int y, float depth);

/// Warns of pixels that are not finite, at the object or post that made them. `plan`: the plan of `scene`.
void warn_non_finite(const scene::Scene& scene, const Plan& plan, const NonFiniteReport& report,
                     support::Diagnostics& diagnostics);

}  // namespace isoshade::render
