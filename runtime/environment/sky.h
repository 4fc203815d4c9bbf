// SPDX-License-Identifier: Apache-2.0
// The sky of a scene as a map. The function sky_with_sun of the library says what is seen in each direction.
#pragma once

#include <optional>

#include "compiler/check/library.h"
#include "compiler/driver/program.h"
#include "runtime/environment/prefilter.h"
#include "runtime/scene/scene.h"

namespace isoshade::environment {

/// The function (direction: vec3) -> (radiance: vec3) of a sky, as an eval program. Reports a library that lacks it.
std::optional<driver::Program> sky_program(const scene::Sky& sky, check::Library& library,
                                           support::Diagnostics& diagnostics);

/// Level 0 of the sky; see project().
Pyramid paint_sky(const scene::Sky& sky, const driver::Program& program, float rotate, float intensity,
                  const PrefilterOptions& options);

}  // namespace isoshade::environment
