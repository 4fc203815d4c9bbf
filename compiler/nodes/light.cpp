// SPDX-License-Identifier: Apache-2.0
// Lights, whose properties exist only under a sum over all lights, and the environment.
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
       "The sum of `in` over the lights of the scene, in scene order, starting from 0. If `in` depends on `lightcolor`, lights "
       "whose colour is 0 at the surface point are left out.",
       {{"in", AnyFloat, "the contribution of one light"}},
       AnyFloat,
       SumLights{}},
      {"environment",
       "The radiance of the scene's environment in a direction in world space, of any length: what a surface of the given "
       "roughness reflects from there. `exists`: whether the scene has an environment.",
       {{"direction", Vector3, "towards the environment"},
        {"roughness", Float, "alpha of GGX, 0 to 1: the radiance is averaged over its lobe around the direction", 0.0f},
        {"default", Color3, "the result without an environment", 0.0f}},
       {{"out", Color3}, {"exists", Boolean}},
       Environment::radiance},
      {"irradiance",
       "The light that a surface receives from the scene's environment, as the radiance of a white diffuse surface: the "
       "irradiance divided by pi.",
       {{"direction", Vector3, "the normal of the surface in world space, of any length", SurfaceValue{Surface::normal}},
        {"default", Color3, "the result without an environment", 0.0f}},
       Color3,
       Environment::irradiance},
  };
}

}  // namespace isoshade::nodes
