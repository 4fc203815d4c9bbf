// SPDX-License-Identifier: Apache-2.0
#include "gltf_pbr.h"

#include "points.h"

void program::shade_gltf_pbr(const Attributes& attributes, const Host& host, float* rgba) {
  isoshade::shaders::gltf_pbr::Parameters parameters{};
  parameters.base_color = vec3<float>(1.0f, 0.9f, 0.8f);
  parameters.metallic = 0.5f;
  parameters.roughness = 0.6f;
  parameters.normal_scale = 0.5f;
  parameters.occlusion_strength = 0.5f;
  parameters.emissive_color = vec3<float>(0.05f, 0.0f, 0.1f);
  parameters.ambient = 0.4f;
  parameters.horizon_color = vec3<float>(0.6f, 0.7f, 0.8f);
  parameters.zenith_color = vec3<float>(0.2f, 0.3f, 0.6f);
  parameters.ground_color = vec3<float>(0.2f, 0.15f, 0.1f);
  parameters.base_color_texture = 0;
  parameters.metallic_roughness_texture = 0;
  parameters.normal_texture = 1;
  parameters.occlusion_texture = 5;
  parameters.emissive_texture = -1;
  // Modes: periodic, clamp, mirror; filters: closest, linear, trilinear.
  parameters.base_color_texture_set = 0;
  parameters.base_color_texture_u = vec3<float>(1.0f, 0.0f, 0.0f);
  parameters.base_color_texture_v = vec3<float>(0.0f, 1.0f, 0.0f);
  parameters.base_color_texture_wrap_u = 0;
  parameters.base_color_texture_wrap_v = 0;
  parameters.base_color_texture_filter = 2;
  parameters.metallic_roughness_texture_set = 1;
  parameters.metallic_roughness_texture_u = vec3<float>(3.0f, 0.5f, -1.0f);
  parameters.metallic_roughness_texture_v = vec3<float>(-0.5f, 2.0f, 0.25f);
  parameters.metallic_roughness_texture_wrap_u = 2;
  parameters.metallic_roughness_texture_wrap_v = 1;
  parameters.metallic_roughness_texture_filter = 2;
  parameters.normal_texture_set = 0;
  parameters.normal_texture_u = vec3<float>(2.0f, 0.0f, 0.0f);
  parameters.normal_texture_v = vec3<float>(0.0f, 2.0f, 0.0f);
  parameters.normal_texture_wrap_u = 1;
  parameters.normal_texture_wrap_v = 0;
  parameters.normal_texture_filter = 1;
  parameters.occlusion_texture_set = 1;
  parameters.occlusion_texture_u = vec3<float>(1.0f, 0.0f, 0.5f);
  parameters.occlusion_texture_v = vec3<float>(0.0f, 1.0f, 0.5f);
  parameters.occlusion_texture_wrap_u = 0;
  parameters.occlusion_texture_wrap_v = 2;
  parameters.occlusion_texture_filter = 0;
  parameters.emissive_texture_set = 0;
  parameters.emissive_texture_u = vec3<float>(1.0f, 0.0f, 0.0f);
  parameters.emissive_texture_v = vec3<float>(0.0f, 1.0f, 0.0f);
  parameters.emissive_texture_wrap_u = 0;
  parameters.emissive_texture_wrap_v = 0;
  parameters.emissive_texture_filter = 2;
  parameters.unlit = false;
  using Surface = isoshade::shaders::gltf_pbr::Surface<F>;
  shade_points<Surface>(
      attributes,
      [&](const Surface& surface) { return isoshade::shaders::gltf_pbr::shade(host, surface, parameters); },
      rgba);
}
