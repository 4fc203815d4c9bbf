// SPDX-License-Identifier: Apache-2.0
// Parameters whose values are known become constants.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// The bits of a value, one word a component; nothing if they are not known.
using KnownWords = std::optional<std::vector<uint32_t>>;

/// Takes the parameters with known words out of a function: each keeps its value's id, which an instruction at the head
/// now defines. `words`: one for each parameter. Callers are left as they are.
void bind_parameters(ir::Function& function, std::span<const KnownWords> words);

}  // namespace isoshade::passes
