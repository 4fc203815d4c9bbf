// SPDX-License-Identifier: Apache-2.0
// What options of several subcommands take, and how they are checked.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "compiler/interface/skips.h"
#include "runtime/cli/arguments.h"

namespace isoshade::cli {

extern const CLI::Validator size_text, range_text, varied_text, time_text, frames_text, limit_text;
/// "error", or "no-" followed by the id of a warning.
extern const CLI::Validator warning_text;
extern const CLI::IsMember backend_names, lane_names, division_names;
/// The backends that must agree in every bit.
extern const CLI::Validator compared_names;

void add_fail_on_nan(CLI::App& app, bool& fail);
void add_precision(CLI::App& app, functions::Tier& precision);
void add_lanes(CLI::App& app, BackendChoice& choice);
void add_choice(CLI::App& app, BackendChoice& choice, bool has_vulkan = true);
/// --format and --quality; `with_floats`: also formats of floats, and --compression.
void add_output_choice(CLI::App& app, OutputChoice& choice, bool with_floats);
/// --no-skip: what is named is not skipped, and nothing with "all".
void add_no_skip(CLI::App& app, interface::Skips& skips);
/// The arguments behind the command's name, in order, with "all" behind each --no-skip that no names follow.
std::vector<std::string> with_skip_names(int argc, char** argv);
void add_changes(CLI::App& app, SceneChanges& changes);

}  // namespace isoshade::cli
