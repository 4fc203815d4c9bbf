// SPDX-License-Identifier: Apache-2.0
// How far results are from the reference.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backends/reference/real.h"

namespace isoshade::bench {

struct Errors {
  double max_ulp = 0, mean_ulp = 0;
  double max_absolute = 0;
};

/// In units in the last place of the exact result, at most no_digit. Where the exact result is no number, so must be
/// the computed one; beyond the floats' range it may be an infinity or a zero. Without last place is what is exactly 0:
/// there every other result is no_digit off.
Errors errors_of(std::span<const int32_t> results, std::span<const reference::Real> exact);

}  // namespace isoshade::bench
