// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "runtime/lanes/lanes.h"

namespace isoshade::functions {

/// An N x N matrix of columns; m[c][r] is column c, row r.
template <class F, int N>
struct mat {
  lanes::vec<F, N> column[N];
  const lanes::vec<F, N>& operator[](int i) const { return column[i]; }
};

}  // namespace isoshade::functions
