// SPDX-License-Identifier: Apache-2.0
// Files that are written whole or not at all.
#pragma once

#include <string>
#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade::scene {

/// Writes a file through a temporary one beside it, which then takes its name: readers see the old bytes or
/// the new ones. A symbolic link is kept, and the file that it names is written, which need not be there yet. What is
/// no regular file (a pipe, /dev/null) is written directly; "-" is standard output. Reports what goes wrong, and then
/// leaves the old file as it was.
bool write_file(const std::string& path, std::string_view bytes, support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
