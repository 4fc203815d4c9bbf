// SPDX-License-Identifier: Apache-2.0
// How much of a light arrives past what stands in its way.
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::lower {

/// The number of layer records from a shadow map to the next: a target without colour has two.
inline constexpr int shadow_map_records = 2;

/// Adds shadow_at(light: int uniform, position: vec3) -> (visible: float): the part of the light that arrives at a
/// position in world space, 0 to 1. `light` is the first word of its record. Of the texels of its shadow map that a square
/// of the width `softness` around the position covers, it is the part by area that shows nothing nearer to the light.
/// Positions outside of the map are lit.
/// Source: percentage-closer filtering, Reeves, Salesin and Cook, "Rendering Antialiased Shadows with Depth Maps", 1987.
void add_shadow_at(ir::Module& module);

}  // namespace isoshade::lower
