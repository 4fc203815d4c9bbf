// SPDX-License-Identifier: Apache-2.0
// Whether a light may be left out of the sums of a pass where none of its light arrives.
#pragma once

#include <string>

#include "compiler/check/typed_graph.h"
#include "compiler/functions/tier.h"

namespace isoshade::prove {

struct BlackLights {
  /// A light whose colour is 0 adds +0 or -0 to every sum, so that a sum has the same bits without it (a sum is never
  /// -0). This relies on what the runtime sees to before it leaves a light out: the values that a scene gives lie within
  /// what `isoshade check` assumes (Planner::is_ordinary).
  bool add_nothing = false;
  std::string reason;  ///< why that is not known; empty if it is
};

/// Of the colour of a pass of an effect.
BlackLights judge_black_lights(const check::TypedGraph& graph, size_t pass, functions::Tier tier);

}  // namespace isoshade::prove
