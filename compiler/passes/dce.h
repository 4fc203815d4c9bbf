// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Dead code elimination: drops the functions that the entries do not reach through calls. The others are sorted,
/// callees before callers, in the order in which they are called; `entries` is updated to the new indices. Buffers
/// stay.
/// Needs: a valid module without dead calls (renumber). Leaves: only functions that are reached.
void dce(ir::Module& module, std::vector<uint32_t>& entries);

}  // namespace isoshade::passes
