// SPDX-License-Identifier: Apache-2.0
#include "backends/reference/functions.h"

#include <array>
#include <tuple>
#include <vector>

#include "backends/reference/rows.h"
#include "compiler/functions/signatures.h"
#include "compiler/support/assert.h"

namespace isoshade::reference {

float stored(const Real& x) {
  if (x.is_nan()) return std::numeric_limits<float>::quiet_NaN();
  const auto nearest = static_cast<float>(x);
  if (nearest != 0 && nearest > -0x1p-126f && nearest < 0x1p-126f) return nearest < 0 ? -0.0f : 0.0f;
  return nearest;
}

namespace {

// Reads an argument from a list of numbers, and writes a result to one.
template <class T>
struct Flat;
template <>
struct Flat<float> {
  static Real take(const Real*& from) { return *from++; }
};
template <int N>
struct Flat<lanes::vec<float, N>> {
  static auto take(const Real*& from) {
    return vector<N>([&](int) { return *from++; });
  }
};
template <int N>
struct Flat<functions::mat<float, N>> {
  static auto take(const Real*& from) {
    return columns<N>([&](int) { return Flat<lanes::vec<float, N>>::take(from); });
  }
};
void give(const Real& x, Real*& to) { *to++ = x; }
template <int N>
void give(const Vector<Real, N>& v, Real*& to) {
  for (int i = 0; i < N; ++i) give(v[i], to);
}
template <int N>
void give(const Matrix<Real, N>& m, Real*& to) {
  for (int i = 0; i < N; ++i) give(m[i], to);
}

using Function = void (*)(const Real* arguments, Real* results);

template <class Row, class... T>
void run(const Real* arguments, Real* results) {
  const std::tuple taken{Flat<T>::take(arguments)...};  // braces evaluate in order
  give(std::apply([](const auto&... a) { return Row::exact(a...); }, taken), results);
}

struct Entry {
  Function function;
  bool componentwise;  ///< the function is of floats, and applied to each component
};

template <class T>
constexpr bool is_of_floats = false;
template <class... T>
constexpr bool is_of_floats<functions::Types<T...>> = (std::is_same_v<T, float> && ...);

template <class Row, class... T>
Function function_of(functions::Types<T...>) {
  return &run<Row, T...>;
}

template <class Row, class First, class... Rest>
void add_row(std::vector<Entry>& out, functions::Types<First, Rest...>) {
  const Function first = function_of<Row>(First{});
  out.push_back({first, is_of_floats<First>});
  if constexpr (is_of_floats<First>)
    out.insert(out.end(), sizeof...(Rest), {first, true});
  else
    (out.push_back({function_of<Row>(Rest{}), false}), ...);
}

/// In the order of functions::variants().
const std::vector<Entry>& entries() {
  static const std::vector<Entry> table = [] {
    std::vector<Entry> out;
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  add_row<rows::name##_row>(out, functions::Signatures<float>::signature{});
#include "compiler/functions/functions.def"
    support::assert_that(out.size() == functions::variants().size(), "functions of which there is no reference");
    return out;
  }();
  return table;
}

}  // namespace

void evaluate(const functions::Variant& variant, std::span<const Real> arguments, std::span<Real> results) {
  const Entry& entry = entries()[static_cast<size_t>(&variant - functions::variants().data())];
  if (!entry.componentwise) return entry.function(arguments.data(), results.data());
  for (size_t component = 0; component < results.size(); ++component) {
    std::array<Real, 5> own;
    size_t first = 0;
    for (size_t i = 0; i < variant.parameters.size(); ++i) {
      const size_t width = variant.parameters[i].width;
      own[i] = arguments[first + (width == 1 ? 0 : component)];
      first += width;
    }
    entry.function(own.data(), &results[component]);
  }
}

}  // namespace isoshade::reference
