// SPDX-License-Identifier: Apache-2.0
// isoshade eval: evaluates a function document for each row of a table.
#include "backends/reference/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/cli/session.h"
#include "runtime/cli/table.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

bool evaluate(const EvalArguments& arguments, const Common& common, support::Diagnostics& diagnostics) {
  const std::vector<std::string> read = {arguments.function, arguments.inputs};
  if (!read_standard_input_once(read, diagnostics)) return false;
  check::Library library = make_library(common);
  driver::CompileOptions options;
  options.library = &library;
  options.reference = arguments.backend == "reference";
  options.tier = arguments.precision;
  const support::Source function = graph::read_source(arguments.function, diagnostics);
  if (function == nullptr) return false;
  const auto program = driver::compile_function(function, options, diagnostics);
  if (!program) return false;
  const support::Source table = graph::read_source(arguments.inputs, diagnostics);
  if (table == nullptr) return false;
  const auto inputs = read_table(table, program->inputs, diagnostics);
  if (!inputs || !may_write(arguments.output, diagnostics)) return false;
  const auto backend = make_backend(arguments.backend, arguments.choice, common, diagnostics);
  if (backend == nullptr) return false;
  progress(common, "evaluating " + std::to_string(inputs->rows) + " rows on " + backend->description());
  if (options.reference) {
    const auto numbers = reference::evaluate(*program, inputs->words, inputs->rows);
    return scene::write_file(arguments.output, write_table(numbers, inputs->rows, program->results),
                             diagnostics);
  }
  Table results;
  results.rows = inputs->rows;
  if (!backend->evaluate(*program, inputs->words, inputs->rows, results.words, diagnostics)) return false;
  return scene::write_file(arguments.output, write_table(results, program->results), diagnostics);
}

}  // namespace

int eval(const EvalArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const bool done = evaluate(arguments, common, diagnostics);
  return flush(diagnostics, common) || !done ? failure : success;
}

}  // namespace isoshade::cli
