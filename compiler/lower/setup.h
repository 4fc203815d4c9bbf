// SPDX-License-Identifier: Apache-2.0
// The kernel that makes triangle records on a device.
#pragma once

#include <cstdint>

#include "compiler/ir/module.h"

namespace isoshade::lower {

/// The words of a surface in `inputs`: what its triangles have in common. Floats as bits.
namespace surface_word {
inline constexpr int object =
    0;  ///< the last word of its triangles' records, but for what depends on the triangle
inline constexpr int if_turned = 1;     ///< flags of those that turn counter-clockwise on the grid
inline constexpr int if_straight = 2;   ///< flags of the others
inline constexpr int culls_turned = 3;  ///< 0 or 1
inline constexpr int culls_straight = 4;
inline constexpr int width = 5;  ///< of the target, in pixels
inline constexpr int height = 6;
inline constexpr int near_planes =
    7;  ///< four floats: the guard planes, functions::GuardPlanes, a little nearer
inline constexpr int far_planes = 11;  ///< and a little farther
inline constexpr int is_biased = 15;   ///< 0 or 1
inline constexpr int bias = 16;        ///< three floats: functions::DepthBiasOf
inline constexpr int stride = 19;
}  // namespace surface_word

/// What becomes of a triangle.
namespace setup_state {
inline constexpr int dropped = 0;  ///< nothing; its record has no area
inline constexpr int kept = 1;     ///< its record is to be drawn
inline constexpr int cut = 2;      ///< the host clips it; its record has no area
}  // namespace setup_state

/// Adds `setup`; returns its index:
///   setup (first: vec4, second: vec4, third: vec4, a: int, b: int, c: int, surface: int uniform) -> (state: int, 16 ints)
/// The positions in clip space and the numbers of a triangle's vertices, and the first word of its surface in `inputs`, give
/// the state of the triangle and its record.
uint32_t add_setup_kernel(ir::Module& module);

}  // namespace isoshade::lower
