// SPDX-License-Identifier: Apache-2.0
// What the bench measures: effects in the library's and the source's formula, and rows of functions.def; their inputs,
// exact results and errors.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/reference/real.h"
#include "compiler/check/library.h"
#include "compiler/driver/driver.h"
#include "compiler/functions/library.h"

namespace isoshade::bench {

/// One computation in one form: a function document or a row of functions.def.
struct Subject {
  std::string effect;  ///< "cook_torrance", "pow"
  std::string form;    ///< "library", "source" or "function"
  std::string document;
  const functions::Variant* variant = nullptr;
  std::string builtins;  ///< GLSL definitions that replace the generated ones of the same names; may be empty
};

/// GLSL's built-in functions under the names of generated functions: of rows of functions.def, of a power with a constant
/// exponent, and of a whole effect.
extern const char* const built_in_definitions;

/// The effects that have both forms below `graphs` (library/*/NAME.json, source_forms/NAME.json), and each row with its own
/// implementation in some tier; only those whose names contain `filter`.
std::vector<Subject> subjects(const std::string& graphs, const std::string& filter);

/// Compiles the eval program of a tier.
std::optional<driver::Program> compile(const Subject& subject, functions::Tier tier, check::Library& library,
                                       support::Diagnostics& diagnostics);

/// The subject's function as lowered, with calls of functions.def and without optimisation.
struct Lowered {
  ir::Module module;
  uint32_t function;  ///< its index in the module
};
std::optional<Lowered> lowered(const Subject& subject, check::Library& library, support::Diagnostics& diagnostics);

/// A program with the same inputs and results that only sums its inputs; its time is that of reading and writing.
driver::Program idle_program(const driver::Program& program);

/// The range of the inputs of a column.
struct Bounds {
  float low, high;
};
Bounds bounds_of(const Subject& subject, const driver::Field& field);

/// `rows` rows of inputs for a program, the same in every run: floats in the range of the input, half of them uniform and
/// half logarithmic; unit vectors in the hemisphere around the first one.
std::vector<int32_t> inputs_of(const Subject& subject, const driver::Program& program, size_t rows);

/// The results of the subject's own formula in exact arithmetic, row by row.
std::optional<std::vector<reference::Real>> exact_results(const Subject& subject, check::Library& library,
                                                          const std::vector<int32_t>& inputs, size_t rows,
                                                          support::Diagnostics& diagnostics);

struct Errors {
  double max_ulp = 0, mean_ulp = 0;
  double max_absolute = 0;
};

/// Errors in ULP of the exact result, at most no_digit. If the exact result is NaN or rounds to an infinity, the computed
/// one must be the same; if it is below the normal floats, 0 is correct. Any other result there counts as no_digit.
Errors errors_of(std::span<const int32_t> results, std::span<const reference::Real> exact);

}  // namespace isoshade::bench
