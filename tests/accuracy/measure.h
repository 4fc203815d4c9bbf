// SPDX-License-Identifier: Apache-2.0
// The error of a function of the library against its reference, in units in the last place.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "backends/reference/rows.h"
#include "compiler/functions/all.h"
#include "compiler/functions/signatures.h"
#include "runtime/lanes/lanes.h"
#include "tests/accuracy/samples.h"

namespace isoshade::accuracy {

/// With 64 bits of significand and 15 of exponent, and unaffected by FTZ and DAZ.
using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64);
template <int N>
using Vector = reference::Vector<Real, N>;
template <int N>
using Matrix = reference::Matrix<Real, N>;

/// The worst case found.
struct Error {
  double ulp = 0;
  std::string where;
  uint64_t cases = 0;
};

inline Real last_place(Real unit) {
  return std::ldexp(Real{1}, std::max(unit == 0 ? -126 : std::ilogb(unit), -126) - 23);
}

/// The error of `result`. What overflows or underflows in rounding is an infinity or a zero, without error.
/// NaN as the unit means that the function is not defined there; a bound of 0 ULP demands the float nearest
/// to `exact`.
inline double error(float result, Real exact, Real unit, double bound) {
  if (std::isnan(unit)) return 0;
  if (std::isnan(result) || std::isnan(exact)) return std::isnan(result) == std::isnan(exact) ? 0 : INFINITY;
  const Real limit = 0x1p128L;
  const Real r = std::clamp(static_cast<Real>(result), -limit, limit);
  const Real e = std::clamp(exact, -limit, limit);
  if (std::abs(e) < 0x1p-126L && result == 0) return 0;
  if (bound == 0 && result == static_cast<float>(exact)) return 0;
  return static_cast<double>(std::abs(r - e) / last_place(std::abs(unit)));
}

// Floats and compounds of them, as reference values and as lists.
inline Real precise(float x) { return x; }
template <int N>
Vector<N> precise(const lanes::vec<float, N>& v) {
  return reference::vector<N>([&](int i) { return precise(v[i]); });
}
template <int N>
Matrix<N> precise(const functions::mat<float, N>& m) {
  return reference::columns<N>([&](int i) { return precise(m[i]); });
}

template <class Visit>
void each(Visit visit, float result, Real exact, Real unit) {
  visit(result, exact, unit);
}
template <class Visit, int N>
void each(Visit visit, const lanes::vec<float, N>& result, const Vector<N>& exact, const Vector<N>& unit) {
  for (int i = 0; i < N; ++i) visit(result[i], exact[i], unit[i]);
}
template <class Visit, int N>
void each(Visit visit, const functions::mat<float, N>& result, const Matrix<N>& exact,
          const Matrix<N>& unit) {
  for (int i = 0; i < N; ++i) each(visit, result[i], exact[i], unit[i]);
}

inline std::string text(float x) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.9g", static_cast<double>(x));
  return buffer;
}
template <int N>
std::string text(const lanes::vec<float, N>& v) {
  std::string list = "(";
  for (int i = 0; i < N; ++i) list += (i ? ", " : "") + text(v[i]);
  return list + ")";
}
template <int N>
std::string text(const functions::mat<float, N>& m) {
  std::string list = "[";
  for (int i = 0; i < N; ++i) list += text(m[i]);
  return list + "]";
}

/// Compares what `Row::body` gave for one tuple of arguments with `Row::exact`.
template <class Row, class Result, class... T>
void compare(Error& worst, const Result& result, const T&... arguments) {
  const auto exact = Row::exact(precise(arguments)...);
  const auto unit = Row::unit(exact, precise(arguments)...);
  each(
      [&](float r, Real e, Real u) {
        if (worst.ulp >= 0.5 && r == static_cast<float>(e)) return;  // most cases, and dear to measure
        const double ulp = error(r, e, u, Row::bound);
        if (ulp <= worst.ulp) return;
        worst.ulp = ulp;
        worst.where = ((text(arguments) + " ") + ...) + "-> " + text(result);
      },
      result, exact, unit);
  ++worst.cases;
}

template <class... T, size_t... I>
std::tuple<T...> next_arguments(std::vector<Samples>& samples, std::index_sequence<I...>) {
  return std::tuple<T...>{Sampled<T>::next(samples[I])...};
}

/// The error over `count` samples of a variant.
template <class Row, class... T>
Error measure(functions::Types<T...>, int count) {
  const std::vector<Range> domain = Row::domain();
  const float smallest = Row::cancels ? 0x1p-40f : 0.0f;  // or terms would underflow that the sum needs
  std::vector<Samples> samples;
  for (size_t i = 0; i < sizeof...(T); ++i)
    samples.emplace_back(domain[i], smallest, 1 + static_cast<uint32_t>(i));
  std::vector<std::tuple<T...>> arguments;
  for (int i = 0; i < count; ++i)
    arguments.push_back(next_arguments<T...>(samples, std::index_sequence_for<T...>()));

  using Result = decltype(Row::body(std::declval<T>()...));
  std::vector<Result> results(arguments.size());
  {
    const lanes::FpGuard guard;
    for (size_t i = 0; i < arguments.size(); ++i)
      results[i] = std::apply([](const T&... a) { return Row::body(a...); }, arguments[i]);
  }
  Error worst;
  for (size_t i = 0; i < arguments.size(); ++i)
    std::apply([&](const T&... a) { compare<Row>(worst, results[i], a...); }, arguments[i]);
  return worst;
}

}  // namespace isoshade::accuracy
