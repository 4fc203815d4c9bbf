// SPDX-License-Identifier: Apache-2.0
// Colours of files that say what their red, green and blue are.
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

/// What colours are multiplied by to become those of Rec. 709 with white D65, which sRGB shares.
struct ToRec709 {
  bool valid = false;                 ///< false: the primaries span no colours
  std::optional<ColorMatrix> matrix;  ///< none where they are those of Rec. 709, each number within 0.0005
};

/// The matrix is inverse(M(Rec. 709)) B M(from): M takes red, green and blue to XYZ so that their sum is the white with
/// Y = 1 (SMPTE RP 177), B takes one white to the other (linearised Bradford, as ICC.1:2010 annex E has it). So white
/// stays white. It is computed in doubles by + - * / alone, and rounded once to floats.
ToRec709 to_rec709(const Chromaticities& from);

/// Of 4 floats a pixel, the fourth of which stays. Colours outside of Rec. 709 get negative numbers. The caller holds
/// lanes::FpGuard.
void transform(const ColorMatrix& matrix, std::span<float> rgba);

}  // namespace isoshade::scene
