// SPDX-License-Identifier: Apache-2.0
// The end of the pipeline, for the files of this folder that make programs.
#pragma once

#include "compiler/driver/driver.h"

namespace isoshade::driver {

/// Runs all passes on a lowered program. The reference leaves it as lowered, except for what decides visibility, which
/// must be the same on every backend.
void finish(Program& program, uint32_t kernel, const CompileOptions& options, support::Source source = nullptr);

/// Gives a copy of a program a number of its own.
void set_number(Program& program);

/// The vertex program of passes that leave vertices where the mesh has them; without a name.
const Program& plain_vertex_program();

}  // namespace isoshade::driver
