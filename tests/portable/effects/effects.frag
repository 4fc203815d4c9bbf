#version 450
#extension GL_GOOGLE_include_directive : require
// Three effects in one shader, with what they ask for.

#include "cartoon.glsl"
#include "cook_torrance.glsl"
#include "gltf_pbr.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 texcoord;
layout(location = 0) out vec4 color;
layout(binding = 0) uniform sampler2D images[6];
layout(push_constant) uniform Push {
  vec3 camera;
  vec3 near_light;
  float seconds;
};

int isoshade_light_count() { return 2; }

isoshade_Light isoshade_light(int index, vec3 at) {
  if (index == 0) return isoshade_Light(vec3(0.6, 0.0, 0.8), vec3(1.0, 0.9, 0.75));
  vec3 way = near_light - at;
  return isoshade_Light(normalize(way), vec3(4.0) / dot(way, way));
}

isoshade_Light isoshade_light_change(int index, vec3 at, vec3 change) {
  isoshade_Light here = isoshade_light(index, at), there = isoshade_light(index, at + change);
  return isoshade_Light(there.direction - here.direction, there.color - here.color);
}

vec4 isoshade_texel(int image, int x, int y) { return texelFetch(images[image], ivec2(x, y), 0); }

isoshade_ImageSize isoshade_image_size(int image) {
  ivec2 size = textureSize(images[image], 0);
  return isoshade_ImageSize(size.x, size.y, 0);
}

int isoshade_image_layer(int image, int layer) { return image; }

bool isoshade_has_environment() { return true; }
vec3 isoshade_environment(vec3 direction, float roughness) { return vec3(0.5 + 0.1 * roughness); }
vec3 isoshade_irradiance(vec3 direction) { return vec3(0.5) + direction; }
int isoshade_pass_index() { return 2; }
int isoshade_pass_count() { return 5; }

void main() {
  vec3 view = normalize(camera - position);
  cook_torrance_Surface metal;
  metal.position = position;
  metal.normal = normal;
  metal.view_direction = view;
  cook_torrance_Parameters metal_parameters;
  metal_parameters.base_color = vec3(0.8, 0.5, 0.3);
  metal_parameters.metallic = 0.25;
  metal_parameters.roughness = 0.3;
  metal_parameters.ambient = 0.5;
  metal_parameters.horizon_color = vec3(0.6, 0.7, 0.8);
  metal_parameters.zenith_color = vec3(0.2, 0.3, 0.6);
  metal_parameters.ground_color = vec3(0.2, 0.15, 0.1);

  cartoon_Surface drawn;
  drawn.position = position;
  drawn.normal = normal;
  drawn.texcoord = texcoord;
  drawn.view_direction = view;
  drawn.position_ddx = dFdx(position);
  drawn.position_ddy = dFdy(position);
  drawn.normal_ddx = dFdx(normal);
  drawn.normal_ddy = dFdy(normal);
  drawn.texcoord_ddx = dFdx(texcoord);
  drawn.texcoord_ddy = dFdy(texcoord);
  drawn.view_direction_ddx = dFdx(view);
  drawn.view_direction_ddy = dFdy(view);
  cartoon_Parameters drawn_parameters;
  drawn_parameters.color = vec3(0.9, 0.8, 0.7);
  drawn_parameters.main_tex_tiling = vec2(3.0, 2.0);
  drawn_parameters.ambient = vec3(0.1, 0.1, 0.15);
  drawn_parameters.specular = vec3(1.0);
  drawn_parameters.specular_scale = 0.04;
  drawn_parameters.specular2 = vec3(0.2, 0.3, 0.4);
  drawn_parameters.specular2_scale = 0.6;
  drawn_parameters.outline = 0.0;
  drawn_parameters.outline_color = vec3(0.0);
  drawn_parameters.outline_normals = 0;
  drawn_parameters.outline_width_mode = 0;
  drawn_parameters.main_tex = 0;
  drawn_parameters.ramp = 5;

  gltf_pbr_Surface standard;
  standard.position = position;
  standard.normal = normal;
  standard.texcoord = texcoord;
  standard.texcoord1 = texcoord.yx;
  standard.view_direction = view;
  standard.tangent = tangent.xyz;
  standard.bitangent = cross(normal, tangent.xyz) * tangent.w;
  standard.color = vec4(1.0);
  standard.texcoord_ddx = dFdx(texcoord);
  standard.texcoord_ddy = dFdy(texcoord);
  standard.texcoord1_ddx = dFdx(texcoord.yx);
  standard.texcoord1_ddy = dFdy(texcoord.yx);
  gltf_pbr_Parameters standard_parameters;
  standard_parameters.base_color = vec3(1.0, 0.9, 0.8);
  standard_parameters.metallic = 0.5;
  standard_parameters.roughness = 0.6;
  standard_parameters.normal_scale = 0.5;
  standard_parameters.occlusion_strength = 0.5;
  standard_parameters.emissive_color = vec3(0.05, 0.0, 0.1);
  standard_parameters.ambient = 0.4;
  standard_parameters.horizon_color = vec3(0.6, 0.7, 0.8);
  standard_parameters.zenith_color = vec3(0.2, 0.3, 0.6);
  standard_parameters.ground_color = vec3(0.2, 0.15, 0.1);
  standard_parameters.base_color_texture = 0;
  standard_parameters.metallic_roughness_texture = 0;
  standard_parameters.normal_texture = 1;
  standard_parameters.occlusion_texture = 5;
  standard_parameters.emissive_texture = -1;
  standard_parameters.base_color_texture_set = 0;
  standard_parameters.base_color_texture_u = vec3(1.0, 0.0, 0.0);
  standard_parameters.base_color_texture_v = vec3(0.0, 1.0, 0.0);
  standard_parameters.base_color_texture_wrap_u = 0;
  standard_parameters.base_color_texture_wrap_v = 1;
  standard_parameters.base_color_texture_filter = 2;
  standard_parameters.metallic_roughness_texture_set = 1;
  standard_parameters.metallic_roughness_texture_u = vec3(1.0, 0.0, 0.0);
  standard_parameters.metallic_roughness_texture_v = vec3(0.0, 1.0, 0.0);
  standard_parameters.metallic_roughness_texture_wrap_u = 1;
  standard_parameters.metallic_roughness_texture_wrap_v = 2;
  standard_parameters.metallic_roughness_texture_filter = 2;
  standard_parameters.normal_texture_set = 0;
  standard_parameters.normal_texture_u = vec3(1.0, 0.0, 0.0);
  standard_parameters.normal_texture_v = vec3(0.0, 1.0, 0.0);
  standard_parameters.normal_texture_wrap_u = 2;
  standard_parameters.normal_texture_wrap_v = 0;
  standard_parameters.normal_texture_filter = 2;
  standard_parameters.occlusion_texture_set = 1;
  standard_parameters.occlusion_texture_u = vec3(1.0, 0.0, 0.0);
  standard_parameters.occlusion_texture_v = vec3(0.0, 1.0, 0.0);
  standard_parameters.occlusion_texture_wrap_u = 0;
  standard_parameters.occlusion_texture_wrap_v = 1;
  standard_parameters.occlusion_texture_filter = 2;
  standard_parameters.emissive_texture_set = 0;
  standard_parameters.emissive_texture_u = vec3(1.0, 0.0, 0.0);
  standard_parameters.emissive_texture_v = vec3(0.0, 1.0, 0.0);
  standard_parameters.emissive_texture_wrap_u = 1;
  standard_parameters.emissive_texture_wrap_v = 2;
  standard_parameters.emissive_texture_filter = 2;
  standard_parameters.unlit = false;

  color = cook_torrance_shade(metal, metal_parameters) + cartoon_base_shade(drawn, drawn_parameters) +
          cartoon_outline_shade(drawn, drawn_parameters) + gltf_pbr_shade(standard, standard_parameters);
}
