// SPDX-License-Identifier: Apache-2.0
#include "cook_torrance.h"

#include "points.h"

void program::shade_cook_torrance(const Attributes& attributes, const Host& host, float* rgba) {
  isoshade::shaders::cook_torrance::Parameters parameters{};
  parameters.base_color = vec3<float>(0.8f, 0.5f, 0.3f);
  parameters.metallic = 0.25f;
  parameters.roughness = 0.3f;
  parameters.ambient = 0.5f;
  parameters.horizon_color = vec3<float>(0.6f, 0.7f, 0.8f);
  parameters.zenith_color = vec3<float>(0.2f, 0.3f, 0.6f);
  parameters.ground_color = vec3<float>(0.2f, 0.15f, 0.1f);
  using Surface = isoshade::shaders::cook_torrance::Surface<F>;
  shade_points<Surface>(
      attributes,
      [&](const Surface& surface) {
        return isoshade::shaders::cook_torrance::shade(host, surface, parameters);
      },
      rgba);
}
