// SPDX-License-Identifier: Apache-2.0
// Host arithmetic whose results affect pixels: plain float in a fixed order, with the function library in place of the
// C library. The callers hold lanes::FpGuard.
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
/// For part/whole of a full turn, 0 <= part <= whole. Exact at quarter turns, and symmetric about them.
SinCos sin_cos_of_turn(int64_t part, int64_t whole);
/// |degrees| <= max_degrees. Exact at multiples of 90.
SinCos sin_cos_of_degrees(float degrees);
inline constexpr float max_degrees = 3600;
/// For all finite numbers.
SinCos sin_cos_of_radians(float radians);

// GLM provides the types of matrices and vectors; the function library computes with them, in its order.

glm::mat4 multiply(const glm::mat4& a, const glm::mat4& b);
glm::mat3 multiply(const glm::mat3& a, const glm::mat3& b);
glm::vec4 multiply(const glm::mat4& a, const glm::vec4& b);
/// Transforms normals as `model` transforms points; the results must be normalised. Under mirroring transforms they
/// still point outwards.
glm::mat3 normal_matrix(const glm::mat4& model);

/// For x y z w, not all 0; it is normalised first.
glm::mat3 rotation_of_quaternion(const std::array<float, 4>& quaternion);

/// The inverse of a matrix whose last row is 0 0 0 1 and whose upper left 3 x 3 part is invertible.
glm::mat4 affine_inverse(const glm::mat4& a);

float dot(const glm::vec3& a, const glm::vec3& b);
glm::vec3 cross(const glm::vec3& a, const glm::vec3& b);
/// Also for vectors whose squares overflow or underflow; 0 gives 0.
glm::vec3 normalize(const glm::vec3& a);
glm::vec4 normalize(const glm::vec4& a);
/// Whether the sine of the angle between two vectors, neither of which is 0, is below 1e-4.
bool parallel(const glm::vec3& a, const glm::vec3& b);

/// The canonical form of floats in the buffers of a frame: no denormals, one NaN.
float canonical(float value);

}  // namespace isoshade::scene
