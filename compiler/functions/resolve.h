// SPDX-License-Identifier: Apache-2.0
// From samples to pixels.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// The mean of two samples side by side and the two below them, by rows.
/// Domain: all floats; finite samples have a finite mean. One that is infinite or NaN makes it so; a quarter of less
/// than 2^-124 is 0.
/// Error: 2^-23 of the mean of the magnitudes: the quarters are exact, of the sums one follows another.
template <class F>
F mean_of_four(F a, F b, F c, F d) {
  const F quarter(0.25f);
  return (a * quarter + b * quarter) + (c * quarter + d * quarter);
}

}  // namespace isoshade::functions
