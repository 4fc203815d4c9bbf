// SPDX-License-Identifier: Apache-2.0
// The node `image`: what its ports mean to those who lower it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace isoshade::nodes {

/// A lowering: reads a texture.
struct Image {};

/// The ports of the row, in order.
namespace image_port {
inline constexpr size_t file = 0, default_value = 1, texcoord = 2, uaddressmode = 3, vaddressmode = 4,
                        filtertype = 5, colorspace = 6;
}  // namespace image_port

// In the order of the ports' choices.

/// What lies beyond the edges of a texture: `constant` is the port `default`.
enum class AddressMode : uint8_t { periodic, clamp, mirror, constant };

/// How texels become a value: the nearest one; in proportion between the nearest four; so, but between the two mip
/// levels whose texels are nearest to the size of the pixel.
enum class Filter : uint8_t { closest, linear, trilinear };

/// What the numbers of a file mean. `automatic`: sRGB where they have 8 bits and are read as a colour, else linear.
enum class ColorSpace : uint8_t { automatic, srgb, linear };

}  // namespace isoshade::nodes
