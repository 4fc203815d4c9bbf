// SPDX-License-Identifier: Apache-2.0
// "animate": values of a scene that move.
#pragma once

#include <vector>

#include "compiler/graph/document.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

/// Writes the values that the animations of a scene document have at a time, in seconds, into the document; parse_scene
/// checks them as all others. Numbers are interpolated in double, each component by itself; a quaternion is then scaled to
/// length 1. At the time of a key, the value is that of the key, bit for bit. Reports paths that lead to nothing or to
/// what cannot move, values that the place does not take, and keys that are not in order; then returns false.
bool animate(graph::Document& document, double time, support::Diagnostics& diagnostics);

/// The parameters of objects and posts that the animations of a scene document change.
std::vector<AnimatedParameter> animated_parameters(const graph::Document& document);

}  // namespace isoshade::scene
