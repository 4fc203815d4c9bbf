// SPDX-License-Identifier: Apache-2.0
// Functions that choose.
#pragma once

#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// The lesser. NaN in `b` gives `a`; NaN in `a` gives `a`; min(+0, -0) is the first. Exact.
template <class F>
F min(F a, F b) {
  return select(b < a, b, a);
}

template <class F, int N>
vec<F, N> min(vec<F, N> a, vec<F, N> b) {
  return componentwise([](F x, F y) { return min(x, y); }, a, b);
}

/// The greater. NaN in `b` gives `a`; NaN in `a` gives `a`; max(+0, -0) is the first. Exact.
template <class F>
F max(F a, F b) {
  return select(a < b, b, a);
}

template <class F, int N>
vec<F, N> max(vec<F, N> a, vec<F, N> b) {
  return componentwise([](F x, F y) { return max(x, y); }, a, b);
}

}  // namespace isoshade::functions
