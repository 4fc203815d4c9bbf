// SPDX-License-Identifier: Apache-2.0
// The signature column of functions.def: the argument types of a row's variants.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

template <class... T>
struct Types {};

/// A signature is a list of variants, and a variant a list of argument types. Rows whose signature begins with g are
/// defined on floats; their vector variants work componentwise.
template <class F>
struct Signatures {
  template <int N>
  using V = lanes::vec<F, N>;
  template <int N>
  using M = mat<F, N>;

  using f_f = Types<Types<F>>;
  using f_ff = Types<Types<F, F>>;
  using g_g = Types<Types<F>, Types<V<2>>, Types<V<3>>, Types<V<4>>>;
  using g_gg = Types<Types<F, F>, Types<V<2>, V<2>>, Types<V<3>, V<3>>, Types<V<4>, V<4>>>;
  using g_ggg =
      Types<Types<F, F, F>, Types<V<2>, V<2>, V<2>>, Types<V<3>, V<3>, V<3>>, Types<V<4>, V<4>, V<4>>>;
  using g_ggh = Types<Types<F, F, F>,  // h: like g, or a float for all components
                      Types<V<2>, V<2>, V<2>>, Types<V<3>, V<3>, V<3>>, Types<V<4>, V<4>, V<4>>,
                      Types<V<2>, V<2>, F>, Types<V<3>, V<3>, F>, Types<V<4>, V<4>, F>>;
  using g_ggggg = Types<Types<F, F, F, F, F>, Types<V<2>, V<2>, V<2>, V<2>, V<2>>,
                        Types<V<3>, V<3>, V<3>, V<3>, V<3>>, Types<V<4>, V<4>, V<4>, V<4>, V<4>>>;
  using f_v = Types<Types<V<2>>, Types<V<3>>, Types<V<4>>>;
  using f_vv = Types<Types<V<2>, V<2>>, Types<V<3>, V<3>>, Types<V<4>, V<4>>>;
  using v_v = f_v;
  using v_vv = f_vv;
  using v_vvf = Types<Types<V<2>, V<2>, F>, Types<V<3>, V<3>, F>, Types<V<4>, V<4>, F>>;
  using f_v3 = Types<Types<V<3>>>;
  using f_v2 = Types<Types<V<2>>>;
  using f_v2f = Types<Types<V<2>, F>>;
  using f_v3fff = Types<Types<V<3>, F, F, F>>;
  using v2_v2f = Types<Types<V<2>, F>>;
  using v2_v2v2v2fv2 = Types<Types<V<2>, V<2>, V<2>, F, V<2>>>;
  using v3_v2 = f_v2;
  using v3_v2f = f_v2f;
  using v3_v3 = f_v3;
  using v3_v3fff = f_v3fff;
  using v3_v3v3 = Types<Types<V<3>, V<3>>>;
  using v_mv = Types<Types<M<3>, V<3>>, Types<M<4>, V<4>>>;
  using m_mm = Types<Types<M<3>, M<3>>, Types<M<4>, M<4>>>;
  using m_m = Types<Types<M<3>>, Types<M<4>>>;
  using f_m = m_m;
  using m3_m = m_m;
  using v3_m4v3 = Types<Types<M<4>, V<3>>>;
};

}  // namespace isoshade::functions
