// SPDX-License-Identifier: Apache-2.0
// What the parts of a plan are made from, so that a part is kept where that is the same as before.
#pragma once

#include <string>
#include <vector>

#include "runtime/scene/scene.h"

namespace isoshade::render {

/// All that a scene gives to each part of a plan, as bytes: floats as their bits, so that -0 and 0 differ. Equal keys
/// give equal parts. What only the views depend on (the camera, lights, the time, values of posts) is in none of them.
struct PlanKeys {
  std::string programs;              ///< effects, posts, and the kinds of lights that they are compiled for
  std::string environment;           ///< its maps
  std::vector<std::string> meshes;   ///< of each object
  std::vector<std::string> objects;  ///< the placement of each and its parameters, also at the frame before
};
PlanKeys keys_of(const scene::Scene& scene);

/// The object at the frame before; the same one if it has not changed.
const scene::Object& object_before(const scene::Scene& scene, size_t object);

/// The key of a mesh.
std::string key_of(const scene::MeshShape& shape);

}  // namespace isoshade::render
