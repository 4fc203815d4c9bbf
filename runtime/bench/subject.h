// SPDX-License-Identifier: Apache-2.0
// What the bench measures: effects of the library and the forms of their sources, and rows of functions.def.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/reference/real.h"
#include "compiler/check/library.h"
#include "compiler/driver/driver.h"
#include "compiler/functions/library.h"

namespace isoshade::bench {

/// One computation in one form: a function document, or a row of functions.def.
struct Subject {
  std::string effect;  ///< "cook_torrance", "pow"
  std::string form;    ///< "library", "source" or "function"
  std::string document;
  const functions::Variant* variant = nullptr;
  std::string
      builtins;  ///< GLSL definitions that stand for the generated ones of the same names; may be empty
};

/// Effects that have both forms below `graphs` (library/*/NAME.json, source_forms/NAME.json), and every row that has a body of its own in some tier. Only those whose name contains
/// `filter`.
std::vector<Subject> subjects(const std::string& graphs, const std::string& filter);

/// The eval program of a tier.
std::optional<driver::Program> compile(const Subject& subject, functions::Tier tier, check::Library& library,
                                       support::Diagnostics& diagnostics);

/// A program with the same inputs and results that computes nothing but the sum of its inputs: what reading and writing
/// take.
driver::Program idle_program(const driver::Program& program);

/// `rows` records for a program's inputs, the same in every run: floats in the declared ranges, or those of the row,
/// spread over numbers and over magnitudes; vectors of unit length, in the half space of the first.
std::vector<int32_t> inputs_of(const Subject& subject, const driver::Program& program, size_t rows);

/// What the results are in exact arithmetic of the subject's own formula, row by row.
std::optional<std::vector<reference::Real>> exact_results(const Subject& subject, check::Library& library,
                                                          const std::vector<int32_t>& inputs, size_t rows,
                                                          support::Diagnostics& diagnostics);

}  // namespace isoshade::bench
