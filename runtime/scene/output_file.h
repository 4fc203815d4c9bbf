// SPDX-License-Identifier: Apache-2.0
// Files that are written completely or not at all.
#pragma once

#include <string>
#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade::scene {

/// Writes a temporary file in the same folder and renames it, so that readers see the old bytes or the new ones. Follows
/// a symbolic link and keeps it; its target need not exist. Writes directly to what is not a regular file (a pipe,
/// /dev/null); "-" is standard output. Reports failures, and then leaves the old file unchanged.
bool write_file(const std::string& path, std::string_view bytes, support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
