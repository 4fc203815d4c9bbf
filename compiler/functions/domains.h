// SPDX-License-Identifier: Apache-2.0
// What functions take, and what they give beyond it, in words.
#pragma once

#include <string_view>

#include "compiler/functions/tier.h"

namespace isoshade::functions {

/// What the docstring of a row's body in a tier says after "Domain:". A tier without a body of its own has the
/// default's. Empty for what is no row.
std::string_view domain_of(std::string_view row, Tier tier = Tier::standard);

}  // namespace isoshade::functions
