// SPDX-License-Identifier: Apache-2.0
// Linear floats to the bytes of an image file.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::scene {

enum class Encoding : uint8_t { srgb, linear };
inline constexpr std::string_view encoding_names[] = {"srgb", "linear"};

/// Multiplies colours by `exposure`, divides them by alpha, encodes them (alpha stays linear), clamps to [0, 1] and
/// quantises to floor(255 x + 0.5). NaN becomes 0. `rgba` has 4 floats per pixel, the result 4 bytes.
/// Rendered images have premultiplied alpha, PNG files do not. Where alpha is not between 0 and 1, colours are not
/// divided. The result is the same on every machine.
std::vector<uint8_t> encode(std::span<const float> rgba, Encoding encoding, float exposure);

}  // namespace isoshade::scene
