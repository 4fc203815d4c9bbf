// SPDX-License-Identifier: Apache-2.0
// Conversion of colours from files that state their primaries.
#pragma once

#include <array>
#include <optional>
#include <span>

namespace isoshade::scene {

/// CIE 1931 x and y.
struct Chromaticities {
  std::array<float, 2> red, green, blue, white;
};

/// Row by row.
using ColorMatrix = std::array<float, 9>;

/// The conversion to the primaries of Rec. 709 and white D65, which sRGB shares.
struct ToRec709 {
  bool valid = false;  ///< false: the primaries are degenerate
  std::optional<ColorMatrix> matrix;  ///< none if they are those of Rec. 709, each number within 0.0005
};

/// The matrix is inverse(M(Rec. 709)) B M(from): M takes red, green and blue to XYZ so that their sum is the white with
/// Y = 1 (SMPTE RP 177), B adapts one white to the other (linearised Bradford, ICC.1:2010 annex E). So white
/// stays white. Computed in doubles with + - * / only, then rounded once to floats.
ToRec709 to_rec709(const Chromaticities& from);

/// Converts pixels of 4 floats; the fourth float is kept. Colours outside Rec. 709 become negative. The caller holds
/// lanes::FpGuard.
void transform(const ColorMatrix& matrix, std::span<float> rgba);

}  // namespace isoshade::scene
