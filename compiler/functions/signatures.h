// SPDX-License-Identifier: Apache-2.0
// What the signature column of functions.def means: the argument types of its variants, and the overloads on
// traced values, which record a call where the same name on floats computes.
#pragma once

#include <string_view>

#include "compiler/functions/flat.h"
#include "compiler/functions/library.h"

namespace isoshade::functions::traced {

template <class... T>
struct Types {};

template <int N>
using V = lanes::vec<Float, N>;
template <int N>
using M = mat<Float, N>;

// SIGNATURE(code, variants): one variant a list of argument types.
using Signature_f_f = Types<Types<Float>>;
using Signature_f_ff = Types<Types<Float, Float>>;
using Signature_f_fff = Types<Types<Float, Float, Float>>;
using Signature_g_g = Types<Types<Float>, Types<V<2>>, Types<V<3>>, Types<V<4>>>;
using Signature_g_gg = Types<Types<Float, Float>, Types<V<2>, V<2>>, Types<V<3>, V<3>>, Types<V<4>, V<4>>>;
using Signature_g_ggg = Types<Types<Float, Float, Float>, Types<V<2>, V<2>, V<2>>, Types<V<3>, V<3>, V<3>>,
                              Types<V<4>, V<4>, V<4>>>;
using Signature_g_ggf = Types<Types<Float, Float, Float>, Types<V<2>, V<2>, Float>, Types<V<3>, V<3>, Float>,
                              Types<V<4>, V<4>, Float>>;
using Signature_f_v = Types<Types<V<2>>, Types<V<3>>, Types<V<4>>>;
using Signature_f_vv = Types<Types<V<2>, V<2>>, Types<V<3>, V<3>>, Types<V<4>, V<4>>>;
using Signature_v_v = Signature_f_v;
using Signature_v_vv = Signature_f_vv;
using Signature_v_vvf = Types<Types<V<2>, V<2>, Float>, Types<V<3>, V<3>, Float>, Types<V<4>, V<4>, Float>>;
using Signature_v3_v3v3 = Types<Types<V<3>, V<3>>>;
using Signature_vN_mNvN = Types<Types<M<3>, V<3>>, Types<M<4>, V<4>>>;
using Signature_mN_mNmN = Types<Types<M<3>, M<3>>, Types<M<4>, M<4>>>;
using Signature_mN_mN = Types<Types<M<3>>, Types<M<4>>>;

/// Records a call of the row's variant that fits the arguments.
template <class Result, class... T>
Result call(std::string_view row, const T&... arguments) {
  ir::Builder& b = builder_of(arguments...);
  std::vector<ir::ValueId> values;
  (Flat<T>::values(b, arguments, values), ...);
  const std::vector<ir::ValueId> results = call_library(b, row, values);
  std::span<const ir::ValueId> rest(results);
  return Flat<Result>::take(b, rest);
}

#define CALLS_f_f(name) \
  inline Float name(Float a) { return call<Float>(#name, a); }
#define CALLS_f_ff(name) \
  inline Float name(Float a, Float b) { return call<Float>(#name, a, b); }
#define CALLS_f_fff(name) \
  inline Float name(Float a, Float b, Float c) { return call<Float>(#name, a, b, c); }
#define CALLS_v_v(name) \
  template <int N>      \
  V<N> name(V<N> a) {   \
    return call<V<N>>(#name, a); \
  }
#define CALLS_v_vv(name)         \
  template <int N>               \
  V<N> name(V<N> a, V<N> b) {    \
    return call<V<N>>(#name, a, b); \
  }
#define CALLS_v_vvf(name)               \
  template <int N>                      \
  V<N> name(V<N> a, V<N> b, Float c) {  \
    return call<V<N>>(#name, a, b, c);  \
  }
#define CALLS_f_v(name)           \
  template <int N>                \
  Float name(V<N> a) {            \
    return call<Float>(#name, a); \
  }
#define CALLS_f_vv(name)             \
  template <int N>                   \
  Float name(V<N> a, V<N> b) {       \
    return call<Float>(#name, a, b); \
  }
#define CALLS_g_g(name) CALLS_f_f(name) CALLS_v_v(name)
#define CALLS_g_gg(name) CALLS_f_ff(name) CALLS_v_vv(name)
#define CALLS_g_ggg(name)                \
  CALLS_f_fff(name)                      \
  template <int N>                       \
  V<N> name(V<N> a, V<N> b, V<N> c) {    \
    return call<V<N>>(#name, a, b, c);   \
  }
#define CALLS_g_ggf(name) CALLS_f_fff(name) CALLS_v_vvf(name)
#define CALLS_v3_v3v3(name) \
  inline V<3> name(V<3> a, V<3> b) { return call<V<3>>(#name, a, b); }
#define CALLS_vN_mNvN(name)         \
  template <int N>                  \
  V<N> name(M<N> a, V<N> b) {       \
    return call<V<N>>(#name, a, b); \
  }
#define CALLS_mN_mNmN(name)         \
  template <int N>                  \
  M<N> name(M<N> a, M<N> b) {       \
    return call<M<N>>(#name, a, b); \
  }
#define CALLS_mN_mN(name)        \
  template <int N>               \
  M<N> name(M<N> a) {            \
    return call<M<N>>(#name, a); \
  }

#define FUNCTION(name, signature, ulp, domain, reference) CALLS_##signature(name)
#include "compiler/functions/functions.def"
#undef FUNCTION

}  // namespace isoshade::functions::traced
