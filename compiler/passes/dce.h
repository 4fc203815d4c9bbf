// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Drops functions that the entries do not reach through calls. The others are put callees before callers, in
/// the order in which they are called; `entries` are changed to where they are then. Buffers stay. Needs: a
/// valid module without dead calls (renumber). Leaves: every function reached.
void dce(ir::Module& module, std::vector<uint32_t>& entries);

}  // namespace isoshade::passes
