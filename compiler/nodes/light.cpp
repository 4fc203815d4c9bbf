// SPDX-License-Identifier: Apache-2.0
// Lights. Their properties exist only under a sum over all lights.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {

std::vector<Row> light_rows() {
  return {
      {"lightdirection",
       "The unit vector from the surface point towards the light, in world space. Only under sum_lights.",
       {},
       Vector3,
       Light::direction},
      {"lightcolor",
       "The linear colour of the light that arrives at the surface point, including falloff. Only under sum_lights.",
       {},
       Color3,
       Light::color},
      {"sum_lights",
       "The sum of `in` over the lights of the scene, in scene order, starting from 0.",
       {{"in", AnyFloat, "the contribution of one light"}},
       AnyFloat,
       SumLights{}},
  };
}

}  // namespace isoshade::nodes
