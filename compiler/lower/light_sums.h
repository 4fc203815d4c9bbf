// SPDX-License-Identifier: Apache-2.0
// Sums over lights. Where no light arrives from a light, that is where its colour is 0, a sum that depends on the colour
// leaves the light out: then no bit tells whether a black light, or one out of reach, is in the scene.
#pragma once

#include <cstdint>
#include <optional>

#include "compiler/check/typed_graph.h"

namespace isoshade::lower {

/// Whether what the node sums up depends on the colours of the lights.
bool sums_colors(const check::TypedGraph& graph, uint32_t sum);

struct LightSum {
  const check::TypedGraph* document = nullptr;
  uint32_t node = 0;
};

/// A sum over lights, of a document or a function that it calls, that does not depend on their colours and so has a term for
/// every light.
std::optional<LightSum> sum_of_black_lights(const check::TypedGraph& graph);

/// Whether there is none.
inline bool leaves_out_black_lights(const check::TypedGraph& graph) { return !sum_of_black_lights(graph); }

}  // namespace isoshade::lower
