// SPDX-License-Identifier: Apache-2.0
// The conformance suite's programs, made from ops.def and functions.def: every op, every variant of every library
// function, and idioms that compilers recognise. Each program is an eval kernel with the same inputs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/driver/program.h"

namespace isoshade::conformance {

/// A program and what each of its result words is: "fadd", "iso_normalize3.y".
struct Case {
  std::string name;
  driver::Program program;
  std::vector<std::string> words;
};

/// Programs of at most 32 result words. Inputs are five words: floats a, b, c and ints i, j.
inline constexpr int input_words = 5;
std::vector<Case> op_cases();
std::vector<Case> function_cases();
/// The rows that have bodies of their own in the fast and the precise tier, in these.
std::vector<Case> tier_cases();
std::vector<Case> idiom_cases();

/// `rows` records of inputs: specials crossed with each other (+-0, denormal bits, +-inf, NaN payloads, extremes,
/// pairs whose product is tiny), then random bits, unit range, near-equal pairs. Deterministic.
/// Floats are flushed and NaN made canonical, as they are where they enter a program.
std::vector<int32_t> inputs(size_t rows);

}  // namespace isoshade::conformance
