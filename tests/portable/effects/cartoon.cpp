// SPDX-License-Identifier: Apache-2.0
#include "cartoon.h"

#include "points.h"

void program::shade_cartoon(const Attributes& attributes, const Host& host, float* rgba) {
  isoshade::shaders::cartoon::Parameters parameters{};
  parameters.color = vec3<float>(0.9f, 0.8f, 0.7f);
  parameters.main_tex_tiling = vec2<float>(3.0f, 2.0f);
  parameters.ambient = vec3<float>(0.1f, 0.1f, 0.15f);
  parameters.specular = vec3<float>(1.0f, 1.0f, 1.0f);
  parameters.specular_scale = 0.04f;
  parameters.specular2 = vec3<float>(0.2f, 0.3f, 0.4f);
  parameters.specular2_scale = 0.6f;
  parameters.main_tex = 0;
  parameters.ramp = 5;
  using Surface = isoshade::shaders::cartoon::Surface<F>;
  shade_points<Surface>(
      attributes,
      [&](const Surface& surface) {
        return isoshade::shaders::cartoon::base_shade(host, surface, parameters);
      },
      rgba);
}
