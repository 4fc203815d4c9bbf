// SPDX-License-Identifier: Apache-2.0
// Lights. What a light gives is only known under a sum over all lights.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {

std::vector<Row> light_rows() {
  return {
      {"lightdirection",
       "The unit vector from the point towards the light, in world space. Only under sum_lights.",
       {},
       Vector3,
       Light::direction},
      {"lightcolor",
       "The light that arrives, linear, falloff included. Only under sum_lights.",
       {},
       Color3,
       Light::color},
      {"sum_lights",
       "The sum of `in` over the lights of the scene, from 0, in scene order.",
       {{"in", AnyFloat, "what one light adds"}},
       AnyFloat,
       SumLights{}},
  };
}

}  // namespace isoshade::nodes
