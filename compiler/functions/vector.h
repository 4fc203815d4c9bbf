// SPDX-License-Identifier: Apache-2.0
// What every body is written with: the ops of runtime/lanes, and ways to write one body for all widths.
#pragma once

#include <utility>

#include "compiler/functions/matrix_type.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::functions {

using namespace lanes;

/// All components equal `s`.
template <int N, class F>
vec<F, N> splat(F s) {
  if constexpr (N == 2) return vec<F, 2>(s, s);
  if constexpr (N == 3) return vec<F, 3>(s, s, s);
  if constexpr (N == 4) return vec<F, 4>(s, s, s, s);
}

/// f of the components of its arguments, one after another.
template <class F, int N, class Function, class... Rest>
vec<F, N> componentwise(Function f, vec<F, N> first, Rest... rest) {
  if constexpr (N == 2) return vec<F, 2>(f(first[0], rest[0]...), f(first[1], rest[1]...));
  if constexpr (N == 3)
    return vec<F, 3>(f(first[0], rest[0]...), f(first[1], rest[1]...), f(first[2], rest[2]...));
  if constexpr (N == 4)
    return vec<F, 4>(f(first[0], rest[0]...), f(first[1], rest[1]...), f(first[2], rest[2]...),
                     f(first[3], rest[3]...));
}

}  // namespace isoshade::functions
