// SPDX-License-Identifier: Apache-2.0
// The vector overloads of rows that are defined on floats (signatures g_...). Include it after the bodies.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

#define WIDEN_g_g(name)                                   \
  template <class F, int N>                               \
  vec<F, N> name(vec<F, N> a) {                           \
    return componentwise([](F x) { return name(x); }, a); \
  }
#define WIDEN_g_gg(name)                                             \
  template <class F, int N>                                          \
  vec<F, N> name(vec<F, N> a, vec<F, N> b) {                         \
    return componentwise([](F x, F y) { return name(x, y); }, a, b); \
  }
#define WIDEN_g_ggg(name)                                                       \
  template <class F, int N>                                                     \
  vec<F, N> name(vec<F, N> a, vec<F, N> b, vec<F, N> c) {                       \
    return componentwise([](F x, F y, F z) { return name(x, y, z); }, a, b, c); \
  }
#define WIDEN_g_ggh(name)                                                \
  WIDEN_g_ggg(name) template <class F, int N>                            \
  vec<F, N> name(vec<F, N> a, vec<F, N> b, F c) {                        \
    return componentwise([c](F x, F y) { return name(x, y, c); }, a, b); \
  }
#define WIDEN_g_ggggg(name)                                                                           \
  template <class F, int N>                                                                           \
  vec<F, N> name(vec<F, N> a, vec<F, N> b, vec<F, N> c, vec<F, N> d, vec<F, N> e) {                   \
    return componentwise([](F v, F w, F x, F y, F z) { return name(v, w, x, y, z); }, a, b, c, d, e); \
  }
#define WIDEN_f_f(name)
#define WIDEN_f_ff(name)
#define WIDEN_f_v(name)
#define WIDEN_f_vv(name)
#define WIDEN_v_v(name)
#define WIDEN_v_vv(name)
#define WIDEN_v_vvf(name)
#define WIDEN_f_v3(name)
#define WIDEN_f_v2(name)
#define WIDEN_f_v2f(name)
#define WIDEN_f_v3fff(name)
#define WIDEN_v3_v2(name)
#define WIDEN_v3_v2f(name)
#define WIDEN_v3_v3fff(name)
#define WIDEN_v2_v2f(name)
#define WIDEN_v2_v2v2v2fv2(name)
#define WIDEN_v3_v3(name)
#define WIDEN_v3_v3v3(name)
#define WIDEN_v_mv(name)
#define WIDEN_m_mm(name)
#define WIDEN_m_m(name)
#define WIDEN_f_m(name)
#define WIDEN_m3_m(name)
#define WIDEN_v3_m4v3(name)

#define FUNCTION(name, signature, ulp, domain, reference, unit) WIDEN_##signature(name)
#include "compiler/functions/functions.def"

}  // namespace isoshade::functions
