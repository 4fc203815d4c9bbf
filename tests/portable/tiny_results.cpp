// SPDX-License-Identifier: Apache-2.0
//
// Where this processor flushes a tiny result: before or after it is rounded to a float. Prints, an operation a line,
// how many results were computed, how many of them are normal on x86, which flushes afterwards, and how many are not
// those of x86. First come all pairs of significands whose product falls where the two orders differ; then random
// operands whose results lie near the least normal float.
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "isoshade/lanes/lanes.h"

namespace {

using namespace isoshade::lanes;

constexpr uint64_t least_significand = uint64_t{1} << 23, end_significand = uint64_t{1} << 24;
constexpr double least_normal = 0x1p-126;

/// splitmix64 (Steele, Lea, Flood 2014).
uint64_t random_bits() {
  static uint64_t state = 2026;
  uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// A float of random sign and significand, its exponent within [from, to].
float random_float(int from, int to) {
  const uint64_t random = random_bits();
  const auto exponent = from + static_cast<int>((random >> 32) % static_cast<uint64_t>(to - from + 1));
  const auto bits = (static_cast<uint32_t>(random) & 0x807fffffu) | static_cast<uint32_t>(exponent + 127)
                                                                        << 23;
  return from_bits_normal(static_cast<int>(bits));
}

/// The float that x86 gives for this exact result: rounded as if exponents had no end, then flushed.
int flushed_after_rounding(double exact) {
  int exponent = 0;
  const double fraction = std::frexp(exact, &exponent);
  const double rounded = std::ldexp(static_cast<double>(static_cast<float>(fraction)), exponent);
  const bool tiny = std::fabs(rounded) < least_normal;
  return bits(tiny ? static_cast<float>(std::copysign(0.0, exact)) : static_cast<float>(rounded));
}

struct Count {
  long results = 0, differing = 0, normal = 0;

  void add(int actual, int expected) {
    ++results;
    differing += actual != expected;
    normal += (expected & exponent_bits) != 0;
  }
  void print(const char* operation) const {
    std::printf("%s %ld %ld %ld\n", operation, results, normal, differing);
  }
};

/// The float of a significand of 24 bits and the exponent of its first.
float from_significand(uint64_t significand, int exponent) {
  return from_bits_normal(
      static_cast<int>((significand & 0x7fffff) | static_cast<uint64_t>(exponent + 127) << 23));
}

/// Products of significands a and b in [2^47 - 2^22, 2^47), times the power of two that takes 2^47 to 2^-126.
/// In the slit below 2^48 there are none: the largest product is (2^24 - 1)^2.
Count products_below_the_least_normal() {
  Count count;
  constexpr uint64_t end = uint64_t{1} << 47, begin = end - (uint64_t{1} << 22);
  for (uint64_t a = least_significand; a < end_significand; ++a) {
    for (uint64_t b = (begin + a - 1) / a; b * a < end; ++b) {
      if (b < least_significand || b >= end_significand) continue;
      const volatile float x = from_significand(a, -63), y = from_significand(b, -64);
      count.add(bits(x * y), flushed_after_rounding(static_cast<double>(x) * y));
    }
  }
  return count;
}

/// What is near the least normal float: a sum because both operands are, a product, or a quotient.
enum class Result { sum, product, quotient };

template <class Operation, class Exact>
void sample(const char* name, Result result, Operation operation, Exact exact) {
  Count count;
  for (int i = 0; i < 500'000; ++i) {
    const int exponent = static_cast<int>(random_bits() % 60) - 30;
    float a = random_float(exponent - 63, exponent - 63), b = a;
    if (result == Result::product) b = random_float(-64 - exponent, -62 - exponent);
    if (result == Result::quotient) b = random_float(62 + exponent, 64 + exponent);
    if (result == Result::sum) a = random_float(-126, -125), b = random_float(-126, -125);
    count.add(bits(operation(a, b)), flushed_after_rounding(exact(a, b)));
  }
  count.print(name);
}

}  // namespace

int main() {
  const FpGuard guard;
  products_below_the_least_normal().print("products_below_the_least_normal");
  sample(
      "+", Result::sum, [](float a, float b) { return a + b; }, [](double a, double b) { return a + b; });
  sample(
      "-", Result::sum, [](float a, float b) { return a - b; }, [](double a, double b) { return a - b; });
  sample(
      "*", Result::product, [](float a, float b) { return a * b; }, [](double a, double b) { return a * b; });
  sample(
      "/", Result::quotient, [](float a, float b) { return a / b; },
      [](double a, double b) { return a / b; });
  sample(
      "sqrt", Result::sum, [](float a, float) { return sqrt(abs(a)); },
      [](double a, double) { return std::sqrt(std::fabs(a)); });
}
