// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/host_math.h"

#include <bit>

#include "compiler/functions/matrix.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"
#include "compiler/ir/float_bits.h"

namespace isoshade::scene {
namespace {

constexpr float half_pi = 1.57079637f;
constexpr float radians_per_degree = 0.0174532924f;

/// `angle` is at most an eighth of a turn; `quarters` quarter turns are added.
SinCos add_quarters(float angle, int quarters) {
  const float s = functions::sin(angle);
  const float c = functions::cos(angle);
  switch (quarters & 3) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

/// Removes the sign of zeros, so that equal points of a mesh have equal bits.
float positive_zero(float x) { return x == 0 ? 0.0f : x; }

/// Conversion to the function library's types, and back.
template <int N>
functions::vec<float, N> to_lanes(const glm::vec<N, float>& a) {
  if constexpr (N == 3) return {a[0], a[1], a[2]};
  if constexpr (N == 4) return {a[0], a[1], a[2], a[3]};
}

template <int N>
functions::mat<float, N> to_lanes(const glm::mat<N, N, float>& a) {
  functions::mat<float, N> result;
  for (int c = 0; c < N; ++c) result.column[c] = to_lanes<N>(a[c]);
  return result;
}

template <int N>
glm::vec<N, float> to_glm(const functions::vec<float, N>& a) {
  glm::vec<N, float> result;
  for (int i = 0; i < N; ++i) result[i] = a[i];
  return result;
}

template <int N>
glm::mat<N, N, float> to_glm(const functions::mat<float, N>& a) {
  glm::mat<N, N, float> result;
  for (int c = 0; c < N; ++c) result[c] = to_glm<N>(a[c]);
  return result;
}

}  // namespace

SinCos sin_cos_of_radians(float radians) { return {functions::sin(radians), functions::cos(radians)}; }

SinCos sin_cos_of_turn(int64_t part, int64_t whole) {
  // Counted in eighths of `whole`, so that everything but the angle is an integer.
  const int64_t quarters = (8 * part + whole) / (2 * whole);
  const int64_t rest = 4 * part - quarters * whole;  // of a quarter turn, in 1/whole; at most half of it
  // Computed with the magnitude, so that the quotient is odd, as the library's sin is.
  const float magnitude = static_cast<float>(rest < 0 ? -rest : rest) / static_cast<float>(whole) * half_pi;
  const SinCos result = add_quarters(rest < 0 ? -magnitude : magnitude, static_cast<int>(quarters));
  return {positive_zero(result.sin), positive_zero(result.cos)};
}

SinCos sin_cos_of_degrees(float degrees) {
  const float quarters = functions::floor(degrees / 90.0f + 0.5f);
  const float rest = degrees - quarters * 90.0f;  // exact: both are multiples of one small unit
  const SinCos result = add_quarters(rest * radians_per_degree, static_cast<int>(quarters));
  return {positive_zero(result.sin), positive_zero(result.cos)};
}

glm::mat4 multiply(const glm::mat4& a, const glm::mat4& b) {
  return to_glm(functions::matmul(to_lanes<4>(a), to_lanes<4>(b)));
}

glm::mat3 multiply(const glm::mat3& a, const glm::mat3& b) {
  return to_glm(functions::matmul(to_lanes<3>(a), to_lanes<3>(b)));
}

glm::vec4 multiply(const glm::mat4& a, const glm::vec4& b) {
  return to_glm(functions::transform(to_lanes<4>(a), to_lanes<4>(b)));
}

glm::mat3 normal_matrix(const glm::mat4& model) {
  return to_glm(functions::normal_matrix(to_lanes<4>(model)));
}

glm::mat4 affine_inverse(const glm::mat4& a) {
  const glm::vec3 x(a[0]), y(a[1]), z(a[2]), origin(a[3]);
  const glm::vec3 cofactors[3] = {cross(y, z), cross(z, x), cross(x, y)};
  const float determinant = dot(x, cofactors[0]);
  glm::mat4 inverse(1);
  for (int r = 0; r < 3; ++r) {
    const glm::vec3 row = cofactors[r] / determinant;
    for (int c = 0; c < 3; ++c) inverse[c][r] = row[c];
    inverse[3][r] = -dot(row, origin);
  }
  return inverse;
}

glm::mat3 rotation_of_quaternion(const std::array<float, 4>& quaternion) {
  const glm::vec4 q = normalize(glm::vec4(quaternion[0], quaternion[1], quaternion[2], quaternion[3]));
  const float x = q.x, y = q.y, z = q.z, w = q.w;
  glm::mat3 rotation;
  rotation[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  rotation[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  rotation[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  return rotation;
}

float dot(const glm::vec3& a, const glm::vec3& b) { return functions::dot(to_lanes<3>(a), to_lanes<3>(b)); }

glm::vec3 cross(const glm::vec3& a, const glm::vec3& b) {
  return to_glm(functions::cross(to_lanes<3>(a), to_lanes<3>(b)));
}

glm::vec3 normalize(const glm::vec3& a) { return to_glm(functions::normalize(to_lanes<3>(a))); }

glm::vec4 normalize(const glm::vec4& a) { return to_glm(functions::normalize(to_lanes<4>(a))); }

bool parallel(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 perpendicular = cross(normalize(a), normalize(b));
  return !(dot(perpendicular, perpendicular) >= 1e-8f);
}

float canonical(float value) {
  return std::bit_cast<float>(ir::canonical_float(std::bit_cast<uint32_t>(value)));
}

}  // namespace isoshade::scene
