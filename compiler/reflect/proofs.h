// SPDX-License-Identifier: Apache-2.0
// What can be proved of a document, for its reflection.
#pragma once

#include <optional>

#include "compiler/driver/shader.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::reflect {

/// What `isoshade check` finds of a document, for the values for which it is compiled. Takes seconds where much is left to
/// prove. Reports a document that is too large and returns nothing.
std::optional<List<Proof>> proofs_of(const driver::Shader& shader, support::Diagnostics& diagnostics);

}  // namespace isoshade::reflect
