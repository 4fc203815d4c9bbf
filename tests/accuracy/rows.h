// SPDX-License-Identifier: Apache-2.0
// The rows of functions.def and those of its tiers as types, and how they are held to their bounds.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string_view>
#include <thread>

#include "compiler/functions/all.h"
#include "tests/accuracy/measure.h"

namespace isoshade::accuracy {

// Rows as types: what reference::rows tells of each, and what is measured.
namespace rows {

using namespace reference;
using reference::rows::Absent;

#define D(...) \
  { __VA_ARGS__ }
// What both kinds of rows tell.
#define MEASURED(ulp, unit_, ...)                                                                     \
  static constexpr double bound = ulp;                                                                \
  static constexpr bool cancels = std::string_view(#unit_) != "result";                               \
  static std::vector<Range> domain() { return __VA_ARGS__; }                                          \
  template <class R, class X, class Y = Absent, class Z = Absent, class U = Absent, class V = Absent> \
  static auto unit([[maybe_unused]] R result, [[maybe_unused]] X x, [[maybe_unused]] Y y = {},        \
                   [[maybe_unused]] Z z = {}, [[maybe_unused]] U u = {}, [[maybe_unused]] V v = {}) { \
    return unit_;                                                                                     \
  }
#define FUNCTION(row, signature, ulp, ranges, reference_, unit_) \
  struct row##_row : reference::rows::row##_row {                \
    using Default = row##_row;                                   \
    using Variants = functions::Signatures<float>::signature;    \
    MEASURED(ulp, unit_, ranges)                                 \
    template <class... T>                                        \
    static auto body(T... arguments) {                           \
      return functions::row(arguments...);                       \
    }                                                            \
  };
#include "compiler/functions/functions.def"

#define TIER(tier, row, ulp, ranges, unit_)      \
  struct tier##_##row##_row : row##_row {        \
    MEASURED(ulp, unit_, ranges)                 \
    template <class... T>                        \
    static auto body(T... arguments) {           \
      return functions::tier::row(arguments...); \
    }                                            \
  };
#define FOLLOWS(tier, row, ulp, ranges, unit_) \
  struct tier##_##row##_row : row##_row {      \
    MEASURED(ulp, unit_, ranges)               \
  };
#include "compiler/functions/functions.def"

}  // namespace rows

inline void expect_within(std::string_view row, double bound, const Error& worst) {
  std::printf("    %-16.*s %6.3f of %g ULP, %llu cases, worst at %s\n", static_cast<int>(row.size()),
              row.data(), worst.ulp, bound, static_cast<unsigned long long>(worst.cases),
              worst.where.c_str());
  EXPECT_LE(worst.ulp, bound) << row << " at " << worst.where;
}

template <class T>
constexpr bool is_of_floats = false;
template <class... T>
constexpr bool is_of_floats<functions::Types<T...>> = (std::is_same_v<T, float> && ...);

/// Rows on floats are measured on floats: wider variants apply them to each component.
template <class Row, class First, class... Rest>
void expect_variants_within(std::string_view row, functions::Types<First, Rest...>) {
  expect_within(row, Row::bound, measure<Row>(First{}, 100000));
  if constexpr (!is_of_floats<First>) (expect_within(row, Row::bound, measure<Row>(Rest{}, 20000)), ...);
}

/// The error over all floats from order(first) to order(last).
template <class Row>
Error measure_floats(int64_t first, int64_t last) {
  constexpr int64_t batch = 4096;
  std::vector<float> results(batch);
  Error worst;
  for (int64_t begin = first; begin <= last; begin += batch) {
    const int64_t count = std::min(batch, last - begin + 1);
    {
      const lanes::FpGuard guard;
      for (int64_t i = 0; i < count; ++i) results[i] = Row::body(from_order(begin + i));
    }
    for (int64_t i = 0; i < count; ++i)
      if (const float x = from_order(begin + i); !is_denormal(x)) compare<Row>(worst, results[i], x);
  }
  return worst;
}

template <class Row, class First, class... Rest>
void expect_all_floats_within(std::string_view row, functions::Types<First, Rest...>) {
  if constexpr (std::is_same_v<First, functions::Types<float>>) {
    if (const char* only = std::getenv("ISOSHADE_FUNCTION"); only && row != only) return;
    if (row == "sin" || row == "cos" || row == "tan") return;  // angles_test, of all tiers at once
    const Range range = Row::domain()[0];
    int64_t first = order(static_cast<float>(range.low));
    int64_t last = order(static_cast<float>(range.high));
    if (from_order(first) < range.low) ++first;
    if (from_order(last) > range.high) --last;
    const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<Error> errors(threads);
    std::vector<std::thread> workers;
    for (int t = 0; t < threads; ++t)
      workers.emplace_back([=, &errors] {
        const int64_t share = (last - first) / threads + 1;
        errors[t] = measure_floats<Row>(first + t * share, std::min(last, first + (t + 1) * share - 1));
      });
    for (std::thread& worker : workers) worker.join();
    Error worst;
    for (const Error& error : errors) {
      worst.cases += error.cases;
      if (error.ulp > worst.ulp) worst.ulp = error.ulp, worst.where = error.where;
    }
    expect_within(row, Row::bound, worst);
  }
}

}  // namespace isoshade::accuracy
