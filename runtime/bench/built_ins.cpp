// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/subject.h"

namespace isoshade::bench {

const char* const built_in_definitions = R"(float iso_rsqrt(float a) {
  return inversesqrt(a);
}
float iso_exp2(float a) {
  return exp2(a);
}
float iso_exp(float a) {
  return exp(a);
}
float iso_log2(float a) {
  return log2(a);
}
float iso_log(float a) {
  return log(a);
}
float iso_pow(float a, float b) {
  return pow(a, b);
}
float iso_pow_5(float a) {
  return pow(a, 5.0);
}
float iso_sin(float a) {
  return sin(a);
}
float iso_cos(float a) {
  return cos(a);
}
float iso_srgb_encode(float a) {
  return a < 0.0031308 ? 12.92 * a : 1.055 * pow(a, 1.0 / 2.4) - 0.055;
}
float iso_srgb_decode(float a) {
  return a <= 0.04045 ? a / 12.92 : pow((a + 0.055) / 1.055, 2.4);
}
vec3 iso_normalize(vec3 a) {
  return normalize(a);
}
float iso_length(vec3 a) {
  return length(a);
}
float iso_dot(vec3 a, vec3 b) {
  return dot(a, b);
}
float iso_min(float a, float b) {
  return min(a, b);
}
float iso_max(float a, float b) {
  return max(a, b);
}
float iso_mip_level(vec2 a, vec2 b) {
  return 0.5 * log2(max(dot(a, a), dot(b, b)));
}
vec2 iso_normalize(vec2 a) {
  return normalize(a);
}
float iso_length(vec2 a) {
  return length(a);
}
float iso_dot(vec2 a, vec2 b) {
  return dot(a, b);
}
vec3 iso_cross(vec3 a, vec3 b) {
  return cross(a, b);
}
vec3 iso_reflect(vec3 a, vec3 b) {
  return reflect(a, b);
}
float iso_clamp(float a, float b, float c) {
  return clamp(a, b, c);
}
float iso_saturate(float a) {
  return clamp(a, 0.0, 1.0);
}
float iso_mix(float a, float b, float c) {
  return mix(a, b, c);
}
float iso_fract(float a) {
  return fract(a);
}
float iso_step(float a, float b) {
  return step(a, b);
}
float iso_smoothstep(float a, float b, float c) {
  return smoothstep(a, b, c);
}
float toon_highlight(float spec, float scale, float width, float least_scale) {
  return smoothstep(-width, width, spec + scale - 1.0) * step(least_scale, scale);
}
)";

}  // namespace isoshade::bench
