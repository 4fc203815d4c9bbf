// SPDX-License-Identifier: Apache-2.0
// The reference column of functions.def, for any number type. It is the definition of each library function: errors are
// measured against it, and the reference backend computes with it.
#pragma once

#include "backends/reference/color.h"
#include "backends/reference/noise.h"

namespace isoshade::reference::rows {

/// Stands for an argument that a row does not have: rows name x, y, z, u and v.
struct Absent {};

// Converts integers, which a row may also give.
template <class R>
R promoted(std::type_identity_t<R> x) {
  return x;
}
template <class R, int N>
Vector<R, N> promoted(Vector<R, N> v) {
  return v;
}
template <class R, int N>
Matrix<R, N> promoted(Matrix<R, N> m) {
  return m;
}

template <class T>
struct NumberOf {
  using type = T;
};
template <class R, int N>
struct NumberOf<Vector<R, N>> {
  using type = R;
};
template <class R, int N>
struct NumberOf<Matrix<R, N>> {
  using type = R;
};

/// dot_row::exact(x, y) and so on.
#define FUNCTION(row, signature, ulp, domain, reference_, unit)                                   \
  struct row##_row {                                                                              \
    template <class X, class Y = Absent, class Z = Absent, class U = Absent, class V = Absent>    \
    static auto exact([[maybe_unused]] X x, [[maybe_unused]] Y y = {}, [[maybe_unused]] Z z = {}, \
                      [[maybe_unused]] U u = {}, [[maybe_unused]] V v = {}) {                     \
      return promoted<typename NumberOf<X>::type>(reference_);                                    \
    }                                                                                             \
  };
#include "compiler/functions/functions.def"

}  // namespace isoshade::reference::rows
