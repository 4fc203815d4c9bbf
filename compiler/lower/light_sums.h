// SPDX-License-Identifier: Apache-2.0
// Sums over lights. Where no light arrives from a light, that is where its colour is 0, a sum that depends on the colour
// leaves the light out: then no bit tells whether a black light, or one out of reach, is in the scene.
#pragma once

#include <cstdint>

#include "compiler/check/typed_graph.h"

namespace isoshade::lower {

/// Whether what the node sums up depends on the colours of the lights.
bool sums_colors(const check::TypedGraph& graph, uint32_t sum);

/// Whether this is so of every sum over lights of a document and of the functions that it calls.
bool leaves_out_black_lights(const check::TypedGraph& graph);

}  // namespace isoshade::lower
