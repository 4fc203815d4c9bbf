// SPDX-License-Identifier: Apache-2.0
//
// The lanes of every width compute, function by function, the bits of one lane; and one lane computes what
// the C++ library and 64-bit arithmetic say.
#include "runtime/lanes/lanes.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tests/unit/lanes_operands.h"

namespace isoshade::lanes {

// Tests are printed by their parameter.
namespace test {
struct Configuration {
  const char* name;
  const char* instruction_set;
  const KernelTable& (*table)();
};

void PrintTo(const Configuration& configuration, std::ostream* out) { *out << configuration.name; }
}  // namespace test

namespace {

using namespace test;

bool processor_has(const std::string& instruction_set) {
  __builtin_cpu_init();
  if (instruction_set == "SSE4.1") return __builtin_cpu_supports("sse4.1");
  if (instruction_set == "AVX2") return __builtin_cpu_supports("avx2");
  if (instruction_set == "AVX-512") {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
  return true;
}

/// Runs the kernel over rows [begin, begin + block).
std::vector<int> run_block(const Kernel& kernel, int begin) {
  std::vector<int> results(block + 1);
  // One element off: lanes may start anywhere.
  const FpGuard guard;
  kernel.run(inputs_of_block(begin), results.data() + 1);
  results.erase(results.begin());
  return results;
}

// ---- every width against one lane

class Lanes : public testing::TestWithParam<Configuration> {
 protected:
  void SetUp() override {
    const std::string needed = GetParam().instruction_set;
    if (!processor_has(needed)) GTEST_SKIP() << "this processor has no " << needed;
  }
  const KernelTable& table() const { return GetParam().table(); }
};

TEST_P(Lanes, MatchOneLaneBitForBit) {
  const KernelTable& reference = kernels_scalar_sse2();
  ASSERT_EQ(table().count, reference.count);
  for (int k = 0; k < reference.count; ++k) {
    const char* text = reference.kernels[k].text;
    ASSERT_STREQ(table().kernels[k].text, text);
    for (int begin = 0; begin + block <= rows; begin += block) {
      const std::vector<int> expected = run_block(reference.kernels[k], begin);
      const std::vector<int> actual = run_block(table().kernels[k], begin);
      if (expected == actual) continue;
      const auto [e, a] = std::mismatch(expected.begin(), expected.end(), actual.begin());
      const size_t row = static_cast<size_t>(begin + (e - expected.begin()));
      ADD_FAILURE() << text << std::hex << " at (" << operand_rows().columns[0][row] << ", "
                    << operand_rows().columns[1][row] << ", " << operand_rows().columns[2][row]
                    << "): one lane gives " << *e << ", these lanes give " << *a;
      break;
    }
  }
}

TEST_P(Lanes, StoreFloatsUnchangedExceptNan) {
  std::vector<float> from(block + 1), to(block + 1);
  for (int i = 0; i < block; ++i) {
    const int pattern = operand_rows().columns[0][static_cast<size_t>(i)];
    std::memcpy(&from[static_cast<size_t>(i) + 1], &pattern, sizeof pattern);
  }
  {
    const FpGuard guard;
    table().copy(from.data() + 1, to.data() + 1, block);
  }
  for (size_t i = 1; i <= block; ++i) {
    const uint32_t before = std::bit_cast<uint32_t>(from[i]);
    const bool nan = (before & 0x7fffffffu) > 0x7f800000u;
    ASSERT_EQ(std::bit_cast<uint32_t>(to[i]), nan ? 0x7fc00000u : before) << std::hex << before;
  }
}

TEST_P(Lanes, StorePixelsOfTheLanesThatAreCounted) {
  constexpr int most = 32;
  std::vector<float> from(4 * most);
  for (size_t i = 0; i < from.size(); ++i) from[i] = static_cast<float>(i) + 0.5f;
  from[most + 1] = std::bit_cast<float>(0xffc12345u);
  const int lanes = table().lanes;
  for (int count = 1; count <= lanes; ++count) {
    std::vector<float> to(4 * most, -1.0f);
    {
      const FpGuard guard;
      table().copy_pixels(from.data(), most, to.data(), count);
    }
    for (int lane = 0; lane < most; ++lane) {
      for (int c = 0; c < 4; ++c) {
        const float stored = to[static_cast<size_t>(4 * lane + c)];
        const uint32_t bits = std::bit_cast<uint32_t>(stored);
        if (lane >= count)
          ASSERT_EQ(stored, -1.0f) << "beyond " << count << " lanes";
        else if (lane == 1 && c == 1)
          ASSERT_EQ(bits, 0x7fc00000u);
        else
          ASSERT_EQ(stored, from[static_cast<size_t>(c * most + lane)]) << lane << " of " << count;
      }
    }
  }
}

TEST_P(Lanes, BranchRunsOnlySidesTakenBySomeLane) {
  const int lanes = table().lanes;
  const auto sides = [&](const std::vector<int>& conditions) {
    int then_count = 0, other_count = 0;
    table().count_branch_sides(conditions.data(), &then_count, &other_count);
    return std::pair(then_count, other_count);
  };
  EXPECT_EQ(sides(std::vector<int>(lanes, 1)), std::pair(1, 0));
  EXPECT_EQ(sides(std::vector<int>(lanes, 0)), std::pair(0, 1));
  if (lanes == 1) return;
  for (int lane = 0; lane < lanes; ++lane) {
    std::vector<int> conditions(lanes, 0);
    conditions[lane] = 1;
    EXPECT_EQ(sides(conditions), std::pair(1, 1)) << "only lane " << lane;
  }
}

INSTANTIATE_TEST_SUITE_P(Width, Lanes,
                         testing::Values(Configuration{"scalar_sse2", "SSE2", kernels_scalar_sse2},
                                         Configuration{"scalar_sse4", "SSE4.1", kernels_scalar_sse4},
                                         Configuration{"4x1_sse2", "SSE2", kernels_4x1_sse2},
                                         Configuration{"4x1_sse4", "SSE4.1", kernels_4x1_sse4},
                                         Configuration{"4x1_avx2", "AVX2", kernels_4x1_avx2},
                                         Configuration{"8x1_avx2", "AVX2", kernels_8x1_avx2},
                                         Configuration{"8x2_avx2", "AVX2", kernels_8x2_avx2},
                                         Configuration{"8x2_avx512", "AVX-512", kernels_8x2_avx512},
                                         Configuration{"16x1_avx512", "AVX-512", kernels_16x1_avx512},
                                         Configuration{"16x2_avx512", "AVX-512", kernels_16x2_avx512}),
                         [](const testing::TestParamInfo<Configuration>& info) {
                           return std::string(info.param.name);
                         });

// ---- one lane against what is known

uint32_t flushed(uint32_t bits) { return (bits & 0x7f800000u) == 0 ? bits & 0x80000000u : bits; }
bool is_nan(uint32_t bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }
uint32_t canonical(uint32_t bits) { return is_nan(bits) ? 0x7fc00000u : bits; }

class OneLane : public testing::Test {
 protected:
  /// Compares the results of a kernel, an op or other text, with expected(a, b) on all rows.
  template <class Expected>
  void expect(const std::string& text, Expected expected) {
    const KernelTable& table = kernels_scalar_sse2();
    for (const Kernel& kernel : std::span(table.kernels, static_cast<size_t>(table.count))) {
      if (kernel.text != text) continue;
      for (int begin = 0; begin + block <= rows; begin += block) {
        const std::vector<int> actual = run_block(kernel, begin);
        for (int i = 0; i < block; ++i) {
          const size_t row = static_cast<size_t>(begin + i);
          const uint32_t a = static_cast<uint32_t>(operand_rows().columns[0][row]);
          const uint32_t b = static_cast<uint32_t>(operand_rows().columns[1][row]);
          ASSERT_EQ(static_cast<uint32_t>(actual[static_cast<size_t>(i)]),
                    static_cast<uint32_t>(expected(a, b)))
              << text << std::hex << " of " << a << ", " << b;
        }
      }
      return;
    }
    FAIL() << "no kernel " << text;
  }

  static float number(uint32_t bits) { return std::bit_cast<float>(flushed(bits)); }
  static uint32_t pattern(float value) { return canonical(std::bit_cast<uint32_t>(value)); }
};

TEST_F(OneLane, FloorRoundsDown) {
  expect("floor", [](uint32_t a, uint32_t) { return pattern(std::floor(number(a))); });
}

TEST_F(OneLane, SquareRootIsCorrectlyRounded) {
  // The root of a float in double, rounded again, is the correctly rounded root in float.
  expect("fsqrt", [](uint32_t a, uint32_t) {
    return pattern(static_cast<float>(std::sqrt(static_cast<double>(number(a)))));
  });
}

TEST_F(OneLane, MultiplicationFlushesDenormals) {
  // The product is exact in double. Tiny is what is below the least normal float after rounding as if the
  // exponent had no end.
  expect("fmul", [](uint32_t a, uint32_t b) {
    const double exact = static_cast<double>(number(a)) * number(b);
    int exponent = 0;
    const double fraction = std::frexp(exact, &exponent);
    if (!std::isfinite(exact) || exact == 0) return pattern(static_cast<float>(exact));
    const double rounded = std::ldexp(static_cast<double>(static_cast<float>(fraction)), exponent);
    return pattern(std::fabs(rounded) < 0x1p-126 ? std::copysign(0.0f, static_cast<float>(exact))
                                                 : static_cast<float>(rounded));
  });
}

TEST_F(OneLane, ComparisonsFollowIeee754) {
  expect("flt", [](uint32_t a, uint32_t b) { return number(a) < number(b); });
  expect("fle", [](uint32_t a, uint32_t b) { return number(a) <= number(b); });
  expect("fgt", [](uint32_t a, uint32_t b) { return number(a) > number(b); });
  expect("fge", [](uint32_t a, uint32_t b) { return number(a) >= number(b); });
  expect("feq", [](uint32_t a, uint32_t b) { return number(a) == number(b); });
  expect("fne", [](uint32_t a, uint32_t b) { return number(a) != number(b); });
}

TEST_F(OneLane, ConvertsBetweenFloatsBitsAndInts) {
  expect("fbits", [](uint32_t a, uint32_t) { return canonical(a); });
  expect("fbits_nonnan", [](uint32_t a, uint32_t) { return a; });
  expect("bits_nonnan(from_bits(i))", [](uint32_t a, uint32_t) { return flushed(a); });
  expect("bits_nonnan(negate(a))", [](uint32_t a, uint32_t) { return a ^ 0x80000000u; });
  expect("bits_nonnan(abs(a))", [](uint32_t a, uint32_t) { return a & 0x7fffffffu; });
  expect("itof", [](uint32_t a, uint32_t) {
    return pattern(static_cast<float>(static_cast<double>(static_cast<int32_t>(a))));
  });
  expect("ftoi", [](uint32_t a, uint32_t) {
    const double value = number(a);
    const bool in_range = value > -2147483649.0 && value < 2147483648.0;
    return in_range ? static_cast<uint32_t>(static_cast<int32_t>(value)) : 0x80000000u;
  });
}

TEST_F(OneLane, IntegerArithmeticWraps) {
  const auto wide = [](uint32_t a) { return static_cast<int64_t>(static_cast<int32_t>(a)); };
  expect("iadd", [](uint32_t a, uint32_t b) { return a + b; });
  expect("isub", [](uint32_t a, uint32_t b) { return a - b; });
  expect("imul", [](uint32_t a, uint32_t b) { return a * b; });
  expect("imulhi", [&](uint32_t a, uint32_t b) { return static_cast<uint32_t>((wide(a) * wide(b)) >> 32); });
  expect("umulhi", [](uint32_t a, uint32_t b) {
    return static_cast<uint32_t>((static_cast<uint64_t>(a) * static_cast<uint64_t>(b)) >> 32);
  });
  expect("ishl", [](uint32_t a, uint32_t b) { return a << (b & 31); });
  expect("ishr", [](uint32_t a, uint32_t b) { return a >> (b & 31); });
  expect("isar", [&](uint32_t a, uint32_t b) { return static_cast<uint32_t>(wide(a) >> (b & 31)); });
  expect("ilt", [&](uint32_t a, uint32_t b) { return wide(a) < wide(b); });
  expect("ult", [](uint32_t a, uint32_t b) { return a < b; });
}

TEST_F(OneLane, LoadsClampTheIndex) {
  const auto at = [](uint32_t index) { return std::min<size_t>(index, int_table.size() - 1); };
  expect("load(ints, i)", [&](uint32_t a, uint32_t) { return static_cast<uint32_t>(int_table[at(a)]); });
  expect("load(floats, i)", [&](uint32_t a, uint32_t) { return pattern(float_table()[at(a)]); });
}

// ---- the processor's mode

TEST(FpGuard, GuardsACallFromBeginningToEnd) {
  float a = 1e-30f, b = 1e-9f, c = 1e10f;
  const auto product = [&] { return a * b * c; };  // a * b is a denormal
  EXPECT_EQ(guarded(product), 0.0f);
  EXPECT_NE(product(), 0.0f) << "the mode is restored";
  const auto two = [&](float x, float y) { return guarded([&] { return x * y * 1e10f; }); };
  EXPECT_EQ(two(1e-30f, 1e-9f), 0.0f) << "arguments that are literals";
}

TEST(FpGuard, FlushesDenormalsWhileAliveAndRestoresTheMode) {
  volatile float least = std::numeric_limits<float>::min();
  volatile float half = 0.5f;
  volatile float third = 3.0f;
  volatile float one = 1.0f;
  volatile float product = 0, quotient = 0;

  constexpr unsigned upward = 0x4000;
  const unsigned before = __builtin_ia32_stmxcsr();
  const unsigned odd = (before & ~0x6000u & ~0x3fu) | upward;
  __builtin_ia32_ldmxcsr(odd);
  {
    const FpGuard guard;
    product = least * half;
    quotient = one / third;
    EXPECT_EQ(__builtin_ia32_stmxcsr() & 0xffc0u, 0x9fc0u);
  }
  const unsigned after = __builtin_ia32_stmxcsr();
  EXPECT_EQ(after & 0xffc0u, odd & 0xffc0u);
  EXPECT_EQ(product, 0.0f);
  EXPECT_EQ(std::bit_cast<uint32_t>(float{quotient}), 0x3eaaaaabu);
  quotient = one / third;
  EXPECT_EQ(std::bit_cast<uint32_t>(float{quotient}), 0x3eaaaaabu);
  quotient = -one / third;
  EXPECT_EQ(std::bit_cast<uint32_t>(float{quotient}), 0xbeaaaaaau);
  __builtin_ia32_ldmxcsr(before);
  product = least * half;
  EXPECT_GT(product, 0.0f);
}

}  // namespace
}  // namespace isoshade::lanes
