// SPDX-License-Identifier: Apache-2.0
// Reading the maps of an environment. Its first record in `textures` is that of roughness 0; the other levels of roughness
// follow, then the irradiance (functions/environment.h).
#pragma once

#include <optional>

#include "compiler/interface/binding.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/kernel.h"

namespace isoshade::lower {

/// Declares what a document asks its host for, unless it is declared:
///   environment_at(direction: vec3, roughness: float) -> (radiance: vec3)
///   irradiance_at(direction: vec3) -> (radiance: vec3)      irradiance / pi
/// Directions have any length but 0. Called only where there is an environment.
void declare_environment(ir::Module& module, interface::Interface& host, interface::Host what);

/// Gives the declared functions bodies that read the frame's buffers.
void define_environment(ir::Module& module, const interface::Interface& interface);

/// Whether the frame has an environment. `known`: LightKinds::environment.
ir::ValueId has_environment(Kernel& k, std::optional<bool> known);

}  // namespace isoshade::lower
