// SPDX-License-Identifier: Apache-2.0
// Sine, cosine and tangent keep their error bounds in every tier over all finite floats: one of 4099 in the usual run,
// every one with ISOSHADE_FULL=1, in as many threads as ISOSHADE_THREADS says or the machine has.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "compiler/functions/all.h"
#include "tests/accuracy/samples.h"

namespace isoshade::accuracy {
namespace {

/// The sine, cosine and tangent of a float to 15 digits, in a fifth of the time that long double takes: the angle is
/// reduced by 2/pi in integers of 128 bits.
struct Exact {
  double sine, cosine, tangent;
};

Exact exact_of(float x) {
  constexpr uint64_t two_over_pi[] = {0,                   0xa2f9836e4e441529, 0xfc2757d1f534ddc0,
                                      0xdb6295993c439041, 0xfe5163abdebbc561, 0xb7246e3a424dd2e0};
  using Wide = unsigned __int128;
  const auto pattern = std::bit_cast<uint32_t>(std::abs(x));
  unsigned quadrant = 0;
  auto r = static_cast<double>(std::abs(x));
  if (r > 0.75) {
    const unsigned first = (pattern >> 23) - 150 + 62;  // the bit that makes 2 of the angle's last bit
    const uint64_t* words = two_over_pi + first / 64;
    const auto shifted = [&](int i) {
      return first % 64 == 0 ? words[i] : words[i] << first % 64 | words[i + 1] >> (64 - first % 64);
    };
    const Wide turns = (Wide{shifted(0)} << 64 | shifted(1)) * ((pattern & 0x7fffff) | 0x800000);
    quadrant = static_cast<unsigned>((turns + (Wide{1} << 125)) >> 126);
    const auto rest = static_cast<__int128>(turns - (Wide{quadrant} << 126));
    r = static_cast<double>(static_cast<long double>(rest) * 0x1p-126L * 1.57079632679489661923132169163975144L);
  }
  const double s = std::sin(r), c = std::cos(r);
  const double sine = (quadrant & 1) != 0 ? c : s, cosine = (quadrant & 1) != 0 ? -s : c;
  const double sign = (quadrant & 2) != 0 ? -1 : 1;
  return {std::copysign(1.0, static_cast<double>(x)) * sign * sine, sign * cosine,
          std::copysign(1.0, static_cast<double>(x)) * sine / cosine};
}

enum Which : size_t { sine, cosine, tangent };

/// A row of functions.def, or of one of its tiers.
struct Measured {
  const char* name;
  float (*function)(float);
  Which which;
  double bound;
  bool of_one;  ///< the bound counts units in the last place of 1
};

#define D(...) 0
constexpr double bound_of(std::string_view tier, std::string_view row) {
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  if (tier == "default" && row == #name) return ulp;
#include "compiler/functions/functions.def"
#define TIER(tier_, name, ulp, domain, unit) \
  if (tier == #tier_ && row == #name) return ulp;
#include "compiler/functions/functions.def"
  return 0;
}
#undef D

constexpr std::array measured{
    Measured{"sin", functions::sin<float>, sine, bound_of("default", "sin"), false},
    Measured{"cos", functions::cos<float>, cosine, bound_of("default", "cos"), false},
    Measured{"tan", functions::tan<float>, tangent, bound_of("default", "tan"), false},
    Measured{"sin fast", functions::fast::sin<float>, sine, bound_of("fast", "sin"), true},
    Measured{"cos fast", functions::fast::cos<float>, cosine, bound_of("fast", "cos"), true},
    Measured{"sin precise", functions::precise::sin<float>, sine, bound_of("precise", "sin"), false},
    Measured{"cos precise", functions::precise::cos<float>, cosine, bound_of("precise", "cos"), false},
};

struct Worst {
  std::array<double, measured.size()> ulp{};
  std::array<float, measured.size()> at{};
  float steepest = 0;       ///< the largest |tan|
  uint64_t asymmetric = 0;  ///< angles beyond near_angle of which the other sign gives other bits
  uint64_t count = 0;
};

void compare(Worst& worst, size_t i, float x, float result, double exact) {
  if (result == static_cast<float>(exact) && worst.ulp[i] >= 0.5) return;
  const int exponent = measured[i].of_one ? 0 : std::max(std::ilogb(exact), -126);
  const double ulp = std::abs(result - exact) / std::ldexp(1.0, exponent - 23);
  if (ulp <= worst.ulp[i]) return;
  worst.ulp[i] = ulp == ulp ? ulp : INFINITY;
  worst.at[i] = x;
}

using Results = std::array<float, measured.size()>;

/// At x and -x. The exact functions are odd or even: only where the results are not is the other one compared, too.
void compare(Worst& worst, float x, const Results& results, const Results& others) {
  const Exact all = exact_of(x);
  const std::array exact{all.sine, all.cosine, all.tangent};
  for (size_t i = 0; i < measured.size(); ++i) {
    const double e = exact[measured[i].which];
    const bool even = measured[i].which == cosine;
    compare(worst, i, x, results[i], e);
    if (std::bit_cast<uint32_t>(others[i]) == std::bit_cast<uint32_t>(even ? results[i] : -results[i])) continue;
    compare(worst, i, -x, others[i], even ? e : -e);
    worst.asymmetric += std::abs(x) > functions::near_angle;
  }
  worst.steepest = std::max({worst.steepest, std::abs(results[2]), std::abs(others[2])});
  ++worst.count;
}

void measure(Worst& worst, const std::vector<float>& angles) {
  std::vector<Results> results(angles.size()), others(angles.size());
  {
    const lanes::FpGuard guard;
    for (size_t k = 0; k < angles.size(); ++k)
      for (size_t i = 0; i < measured.size(); ++i) {
        results[k][i] = measured[i].function(angles[k]);
        others[k][i] = measured[i].function(-angles[k]);
      }
  }
  for (size_t k = 0; k < angles.size(); ++k) compare(worst, angles[k], results[k], others[k]);
}

void merge(Worst& into, const Worst& from) {
  for (size_t i = 0; i < measured.size(); ++i)
    if (from.ulp[i] > into.ulp[i]) into.ulp[i] = from.ulp[i], into.at[i] = from.at[i];
  into.steepest = std::max(into.steepest, from.steepest);
  into.asymmetric += from.asymmetric;
  into.count += from.count;
}

TEST(Angles, ReferenceMatchesLongDouble) {
  for (int64_t i = std::bit_cast<int32_t>(0x1p-126f); i < std::bit_cast<int32_t>(INFINITY); i += 40'009) {
    for (const float x : {from_order(i), -from_order(i)}) {
      const Exact exact = exact_of(x);
      const long double precise = x;
      const auto expect_near = [&](double value, long double wanted) {
        EXPECT_LE(std::abs(value - wanted), 1e-15L * std::abs(wanted)) << x;
      };
      expect_near(exact.sine, std::sin(precise));
      expect_near(exact.cosine, std::cos(precise));
      expect_near(exact.tangent, std::tan(precise));
    }
  }
}

TEST(Angles, ErrorStaysWithinBoundInEveryTier) {
  const int64_t first = std::bit_cast<int32_t>(0x1p-126f), last = std::bit_cast<int32_t>(0x1.fffffep127f);
  const int64_t stride = std::getenv("ISOSHADE_FULL") != nullptr ? 1 : 4099;
  const char* asked = std::getenv("ISOSHADE_THREADS");
  const int threads = std::max(1, asked != nullptr ? std::atoi(asked)
                                                   : static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<Worst> parts(static_cast<size_t>(threads));
  std::vector<std::thread> workers;
  for (int t = 0; t < threads; ++t)
    workers.emplace_back([&parts, t, threads, stride] {
      std::vector<float> angles;
      for (int64_t i = first + t * stride; i <= last; i += threads * stride) {
        angles.push_back(from_order(i));
        if (angles.size() < 1024 && i + threads * stride <= last) continue;
        measure(parts[static_cast<size_t>(t)], angles);
        angles.clear();
      }
    });
  for (std::thread& worker : workers) worker.join();
  Worst worst;
  for (const Worst& part : parts) merge(worst, part);
  measure(worst, {0.0f, 16367173 * 0x1p72f, 0x1.fffffep127f});  // the second is the nearest to a multiple of pi/2
  for (size_t i = 0; i < measured.size(); ++i) {
    std::printf("    %-12s %.4f of %g ULP, %llu angles of each sign, worst at %a\n", measured[i].name,
                worst.ulp[i], measured[i].bound, static_cast<unsigned long long>(worst.count),
                static_cast<double>(worst.at[i]));
    EXPECT_GT(measured[i].bound, 0) << measured[i].name;
    EXPECT_LE(worst.ulp[i], measured[i].bound) << measured[i].name << " at " << worst.at[i];
    EXPECT_GT(worst.ulp[i], 0.5) << measured[i].name << ": nothing was measured";
  }
  std::printf("    the largest tangent is %g\n", static_cast<double>(worst.steepest));
  EXPECT_LT(worst.steepest, 1e9f);  // as the prover counts on: rules.cpp
  EXPECT_EQ(worst.asymmetric, 0u);
}

}  // namespace
}  // namespace isoshade::accuracy
