// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/chromaticities.h"

#include <cmath>

namespace isoshade::scene {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows

constexpr Chromaticities rec709{{0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, {0.3127f, 0.3290f}};
// Lam, 1985; the matrix of ICC.1:2010, annex E.
constexpr Matrix bradford{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

Vector multiply(const Matrix& a, const Vector& b) {
  Vector result;
  for (size_t r = 0; r < 3; ++r) result[r] = a[r][0] * b[0] + a[r][1] * b[1] + a[r][2] * b[2];
  return result;
}

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix result;
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) result[r][c] = a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c];
  return result;
}

std::optional<Matrix> inverse(const Matrix& a) {
  Matrix adjugate;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) {
      const size_t r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      adjugate[r][c] = a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1];
    }
  }
  const double determinant = a[0][0] * adjugate[0][0] + a[0][1] * adjugate[1][0] + a[0][2] * adjugate[2][0];
  if (!(std::abs(determinant) > 1e-9)) return std::nullopt;
  for (Vector& row : adjugate)
    for (double& value : row) value = value / determinant;
  return adjugate;
}

Vector xyz(const std::array<float, 2>& xy) {
  const double x = xy[0], y = xy[1];
  return {x, y, 1 - x - y};
}

/// XYZ with Y = 1.
Vector white_of(const Chromaticities& from) {
  const Vector white = xyz(from.white);
  return {white[0] / white[1], 1, white[2] / white[1]};
}

std::optional<Matrix> to_xyz(const Chromaticities& from) {
  const Vector columns[] = {xyz(from.red), xyz(from.green), xyz(from.blue)};
  Matrix primaries;
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) primaries[r][c] = columns[c][r];
  const auto inverted = inverse(primaries);
  if (!inverted) return std::nullopt;
  const Vector scale = multiply(*inverted, white_of(from));
  for (Vector& row : primaries)
    for (size_t c = 0; c < 3; ++c) row[c] = row[c] * scale[c];
  return primaries;
}

bool near_rec709(const Chromaticities& from) {
  const auto near = [](const std::array<float, 2>& a, const std::array<float, 2>& b) {
    return std::abs(a[0] - b[0]) <= 0.0005f && std::abs(a[1] - b[1]) <= 0.0005f;
  };
  return near(from.red, rec709.red) && near(from.green, rec709.green) && near(from.blue, rec709.blue) &&
         near(from.white, rec709.white);
}

}  // namespace

ToRec709 to_rec709(const Chromaticities& from) {
  if (near_rec709(from)) return {true, std::nullopt};
  if (!(from.white[1] > 0.001f)) return {};
  const auto source = to_xyz(from);
  if (!source) return {};
  const Vector here = multiply(bradford, white_of(from)), there = multiply(bradford, white_of(rec709));
  Matrix adapted = bradford;
  for (size_t r = 0; r < 3; ++r)
    for (double& value : adapted[r]) value = value * (there[r] / here[r]);
  adapted = multiply(*inverse(bradford), adapted);
  const Matrix whole = multiply(multiply(*inverse(*to_xyz(rec709)), adapted), *source);
  ColorMatrix matrix;
  for (size_t i = 0; i < 9; ++i) {
    // Real primaries give numbers near 1; much larger ones would make texels infinite.
    if (!(std::abs(whole[i / 3][i % 3]) < 1000)) return {};
    matrix[i] = static_cast<float>(whole[i / 3][i % 3]);
  }
  return {true, matrix};
}

void transform(const ColorMatrix& m, std::span<float> rgba) {
  for (size_t i = 0; i + 3 < rgba.size(); i += 4) {
    const float r = rgba[i], g = rgba[i + 1], b = rgba[i + 2];
    for (size_t c = 0; c < 3; ++c) rgba[i + c] = m[3 * c] * r + m[3 * c + 1] * g + m[3 * c + 2] * b;
  }
}

}  // namespace isoshade::scene
