// SPDX-License-Identifier: Apache-2.0
// The end of the pipeline, for the files of this folder that make programs.
#pragma once

#include "compiler/driver/driver.h"

namespace isoshade::driver {

/// Runs all passes on a lowered program. The reference leaves it as lowered, except for what decides visibility, which
/// must be the same on every backend. `room`: the word from which on the records of its draws have room for what is the
/// same for a draw; none: they have none.
void finish(Program& program, uint32_t kernel, const CompileOptions& options, support::Source source = nullptr,
            std::optional<uint32_t> room = {});

/// What is the same all over a draw of the stage, whose record has room from word `first` on; none if it has no draws.
std::optional<passes::DrawRate> draw_rate(Stage stage, uint32_t first);

/// Gives a copy of a program a number of its own.
void set_number(Program& program);

/// The vertex program of passes that leave vertices where the mesh has them; without a name.
const Program& plain_vertex_program();

}  // namespace isoshade::driver
