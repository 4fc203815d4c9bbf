// SPDX-License-Identifier: Apache-2.0
// Linear floats to the bytes of an image file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace isoshade::scene {

enum class Encoding : uint8_t { srgb, linear };

/// Multiplies colours by `exposure`, divides them by alpha, encodes them (alpha stays linear), clamps to [0, 1] and
/// quantises to floor(255 x + 0.5). NaN gives 0. `rgba` holds 4 floats a pixel; so do the bytes that come out.
/// The colours of a rendered image are multiplied by alpha, those of a PNG are not. Where alpha is not between 0 and 1,
/// nothing is divided. The same bytes on every machine.
std::vector<uint8_t> encode(std::span<const float> rgba, Encoding encoding, float exposure);

}  // namespace isoshade::scene
