// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/errors.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

namespace {

struct Error {
  double ulp, absolute;
};

Error error_of(float result, const reference::Real& exact) {
  constexpr Error none{0, 0}, all{no_digit, 0};
  if (exact.is_nan()) return std::isnan(result) ? none : all;
  const auto near = static_cast<double>(exact);
  if (std::abs(near) > 0x1.fffffefp127)  // rounds to an infinity
    return std::isinf(result) && std::signbit(result) == (near < 0) ? none : all;
  if (!std::isfinite(result)) return all;
  if (std::abs(near) < 0x1p-126)
    return result == 0 ? none : Error{no_digit, std::abs(static_cast<double>(result) - near)};
  const double difference = std::abs(static_cast<double>(reference::Real(result) - exact));
  return {std::min(no_digit, difference / std::ldexp(1.0, std::ilogb(near) - 23)), difference};
}

}  // namespace

Errors errors_of(std::span<const int32_t> results, std::span<const reference::Real> exact) {
  Errors errors;
  for (size_t i = 0; i < results.size(); ++i) {
    const Error error = error_of(std::bit_cast<float>(results[i]), exact[i]);
    errors.max_ulp = std::max(errors.max_ulp, error.ulp);
    errors.mean_ulp += error.ulp / static_cast<double>(results.size());
    errors.max_absolute = std::max(errors.max_absolute, error.absolute);
  }
  return errors;
}

}  // namespace isoshade::bench
