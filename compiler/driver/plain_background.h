// SPDX-License-Identifier: Apache-2.0
// Posts that make one color of a background of one color.
#pragma once

#include "compiler/functions/tier.h"
#include "compiler/lower/lower.h"

namespace isoshade::driver {

/// Of a post that looks at no pixel but its own (lower::is_pointwise): whether it makes the same of all pixels without a
/// surface that have the same color, as fog does and a sky does not.
bool keeps_background_plain(const lower::Lowered& post, functions::Tier tier);

}  // namespace isoshade::driver
