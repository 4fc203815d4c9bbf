// SPDX-License-Identifier: Apache-2.0
// The rows of functions.def on traced values: each records a call to the library function. They are not templates over
// the scalar type, so overload resolution prefers them to the bodies.
#pragma once

#include <string_view>
#include <vector>

#include "compiler/functions/flat.h"
#include "compiler/functions/library.h"

namespace isoshade::functions::traced {

/// Records a call of the row's variant for these argument types.
template <class Result, class... T>
Result call(std::string_view row, const T&... arguments) {
  ir::Builder& b = builder_of(arguments...);
  std::vector<ir::ValueId> values;
  (Flat<T>::values(b, arguments, values), ...);
  const std::vector<ir::ValueId> results = call_library(b, row, values);
  std::span<const ir::ValueId> rest(results);
  return Flat<Result>::take(b, rest);
}

// clang-format off
#define CALL_1(result, name, A) result name(A a) { return call<result>(#name, a); }
#define CALL_2(result, name, A, B) result name(A a, B b) { return call<result>(#name, a, b); }
#define CALL_3(result, name, A, B, C) result name(A a, B b, C c) { return call<result>(#name, a, b, c); }
#define CALL_4(result, name, A, B, C, D) \
  result name(A a, B b, C c, D d) { return call<result>(#name, a, b, c, d); }
#define CALL_5(result, name, A, B, C, D, E) \
  result name(A a, B b, C c, D d, E e) { return call<result>(#name, a, b, c, d, e); }

#define CALLS_f_f(name) inline CALL_1(Float, name, Float)
#define CALLS_f_ff(name) inline CALL_2(Float, name, Float, Float)
#define CALLS_f_fff(name) inline CALL_3(Float, name, Float, Float, Float)
#define CALLS_v_v(name) template <int N> CALL_1(V<N>, name, V<N>)
#define CALLS_v_vv(name) template <int N> CALL_2(V<N>, name, V<N>, V<N>)
#define CALLS_v_vvv(name) template <int N> CALL_3(V<N>, name, V<N>, V<N>, V<N>)
#define CALLS_v_vvf(name) template <int N> CALL_3(V<N>, name, V<N>, V<N>, Float)
#define CALLS_g_g(name) CALLS_f_f(name) CALLS_v_v(name)
#define CALLS_g_gg(name) CALLS_f_ff(name) CALLS_v_vv(name)
#define CALLS_g_ggg(name) CALLS_f_fff(name) CALLS_v_vvv(name)
#define CALLS_g_ggh(name) CALLS_g_ggg(name) CALLS_v_vvf(name)
#define CALLS_g_ggggg(name) \
  inline CALL_5(Float, name, Float, Float, Float, Float, Float) \
  template <int N> CALL_5(V<N>, name, V<N>, V<N>, V<N>, V<N>, V<N>)
#define CALLS_f_v(name) template <int N> CALL_1(Float, name, V<N>)
#define CALLS_f_vv(name) template <int N> CALL_2(Float, name, V<N>, V<N>)
#define CALLS_f_v2(name) inline CALL_1(Float, name, V<2>)
#define CALLS_f_v2f(name) inline CALL_2(Float, name, V<2>, Float)
#define CALLS_f_v3fff(name) inline CALL_4(Float, name, V<3>, Float, Float, Float)
#define CALLS_f_v3(name) inline CALL_1(Float, name, V<3>)
#define CALLS_v2_v2f(name) inline CALL_2(V<2>, name, V<2>, Float)
#define CALLS_v2_v2v2v2fv2(name) inline CALL_5(V<2>, name, V<2>, V<2>, V<2>, Float, V<2>)
#define CALLS_v3_v2(name) inline CALL_1(V<3>, name, V<2>)
#define CALLS_v3_v2f(name) inline CALL_2(V<3>, name, V<2>, Float)
#define CALLS_v3_v3fff(name) inline CALL_4(V<3>, name, V<3>, Float, Float, Float)
#define CALLS_v3_v3(name) inline CALL_1(V<3>, name, V<3>)
#define CALLS_v3_v3v3(name) inline CALL_2(V<3>, name, V<3>, V<3>)
#define CALLS_v_mv(name) template <int N> CALL_2(V<N>, name, M<N>, V<N>)
#define CALLS_m_mm(name) template <int N> CALL_2(M<N>, name, M<N>, M<N>)
#define CALLS_m_m(name) template <int N> CALL_1(M<N>, name, M<N>)
#define CALLS_f_m(name) template <int N> CALL_1(Float, name, M<N>)
#define CALLS_m3_m(name) template <int N> CALL_1(M<3>, name, M<N>)
#define CALLS_v3_m4v3(name) inline CALL_2(V<3>, name, M<4>, V<3>)
// clang-format on

#define FUNCTION(name, signature, ulp, domain, reference, unit) CALLS_##signature(name)
#include "compiler/functions/functions.def"

}  // namespace isoshade::functions::traced
