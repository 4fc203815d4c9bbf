// SPDX-License-Identifier: Apache-2.0
// Everything that a document goes through before it is run.
#pragma once

#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade {

/// Compiles the text as whatever kind of document it is, to GLSL and C++; a scene is read, its files are not. No
/// document reads files beyond the library. Returns what was reported: a document has errors or a program.
support::Diagnostics feed(std::string_view text);

}  // namespace isoshade
