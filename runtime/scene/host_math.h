// SPDX-License-Identifier: Apache-2.0
// Arithmetic of the host whose results reach pixels: plain float, in an order written here, with the function
// library in place of the C library. Computed under lanes::FpGuard, which the callers hold.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace isoshade::scene {

struct SinCos {
  float sin, cos;
};
/// Of part/whole of a full turn, 0 <= part <= whole. Exact at quarters, and symmetric about them.
SinCos sin_cos_of_turn(int64_t part, int64_t whole);
/// |degrees| <= max_degrees. Exact at multiples of 90.
SinCos sin_cos_of_degrees(float degrees);
inline constexpr float max_degrees = 3600;

// GLM holds matrices and vectors; what is computed with them is the library's, in the order that it has.

glm::mat4 multiply(const glm::mat4& a, const glm::mat4& b);
glm::mat3 multiply(const glm::mat3& a, const glm::mat3& b);
glm::vec4 multiply(const glm::mat4& a, const glm::vec4& b);
/// Takes normals where `model` takes points; they want normalising then. Mirrored transforms turn them
/// outside.
glm::mat3 normal_matrix(const glm::mat4& model);

/// Of x y z w, which are not all 0; they are normalised.
glm::mat3 rotation_of_quaternion(const std::array<float, 4>& quaternion);

/// Of a matrix whose last row is 0 0 0 1 and whose first three columns span space.
glm::mat4 affine_inverse(const glm::mat4& a);

float dot(const glm::vec3& a, const glm::vec3& b);
glm::vec3 cross(const glm::vec3& a, const glm::vec3& b);
/// Also for vectors whose squares overflow or vanish; 0 gives 0.
glm::vec3 normalize(const glm::vec3& a);
glm::vec4 normalize(const glm::vec4& a);
/// Of two vectors neither of which is 0: whether the sine of the angle between them is below 1e-4.
bool parallel(const glm::vec3& a, const glm::vec3& b);

/// The form in which floats stand in the arrays of a frame: no denormals, one NaN.
float canonical(float value);

}  // namespace isoshade::scene
