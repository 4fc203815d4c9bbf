// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/subject.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "backends/reference/backend.h"
#include "backends/reference/functions.h"
#include "compiler/graph/document.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/bench/measure.h"

namespace isoshade::bench {

namespace {

using support::Diagnostics;

struct Effect {
  const char* name;
  const char* library;  ///< below library/
  const char* source;   ///< below source_forms/
};

constexpr Effect effects[] = {
    {"cook_torrance", "brdf/cook_torrance", "cook_torrance"},
    {"ggx_d", "brdf/ggx_d", "ggx_d"},
    {"schlick_f", "brdf/schlick_f", "schlick_f"},
    {"toon_highlight", "toon/highlight", "toon_highlight"},
    {"fog", "fog/height_density", "fog_density"},
};

/// Whether some tier has its own implementation; of several widths, 1 and 3 are measured.
bool is_measured(const functions::Variant& variant) {
  if (!variant.has_own_body(functions::Tier::fast) && !variant.has_own_body(functions::Tier::precise))
    return false;
  const ir::Type type = variant.parameters[0];
  return type.width == 1 || type.width == 3;
}

ir::Module row_module(const functions::Variant& variant) {
  ir::Module module = lower::frame_module();
  ir::Function function;
  function.name = "row_" + variant.name;  // the bare name may be a built-in of GLSL
  for (size_t i = 0; i < variant.parameters.size(); ++i)
    function.parameters.push_back({std::string(1, "xyzuv"[i]), variant.parameters[i], "", false});
  for (size_t i = 0; i < variant.results.size(); ++i)
    function.results.push_back({"out" + std::to_string(i), variant.results[i]});
  module.functions.push_back(std::move(function));
  ir::Builder b(module, 0);
  std::vector<ir::ValueId> arguments;
  for (size_t i = 0; i < variant.parameters.size(); ++i) arguments.push_back(b.parameter(i));
  b.finish(functions::call_library(b, variant.row, arguments));
  return module;
}

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

std::vector<Subject> subjects(const std::string& graphs, const std::string& filter) {
  std::vector<Subject> found;
  const auto wanted = [&](std::string_view name) { return name.find(filter) != std::string_view::npos; };
  for (const Effect& effect : effects) {
    const std::string library = graphs + "/library/" + effect.library + ".json";
    const std::string source = graphs + "/source_forms/" + effect.source + ".json";
    if (!wanted(effect.name) || !std::filesystem::exists(library) || !std::filesystem::exists(source))
      continue;
    found.push_back({effect.name, "library", library, nullptr, ""});
    found.push_back({effect.name, "source", source, nullptr, built_in_definitions});
  }
  for (const functions::Variant& variant : functions::variants()) {
    if (!is_measured(variant) || !wanted(variant.row)) continue;
    found.push_back({std::string(variant.row), "function", "", &variant, built_in_definitions});
  }
  return found;
}

std::optional<driver::Program> compile(const Subject& subject, functions::Tier tier, check::Library& library,
                                       Diagnostics& diagnostics) {
  if (subject.variant != nullptr)
    return driver::finish_eval(row_module(*subject.variant), 0, subject.effect, tier);
  const support::Source source = graph::read_source(subject.document, diagnostics);
  if (source == nullptr) return std::nullopt;
  driver::CompileOptions options;
  options.library = &library;
  options.tier = tier;
  return driver::compile_function(source, options, diagnostics);
}

std::optional<Lowered> lowered(const Subject& subject, check::Library& library, Diagnostics& diagnostics) {
  if (subject.variant != nullptr) return Lowered{row_module(*subject.variant), 0};
  const support::Source source = graph::read_source(subject.document, diagnostics);
  if (source == nullptr) return std::nullopt;
  driver::CompileOptions options;
  options.library = &library;
  options.reference = true;
  auto program = driver::compile_function(source, options, diagnostics);
  if (!program) return std::nullopt;
  ir::Function& table = program->module.functions[program->entry];
  const auto call = std::ranges::find(table.instructions, ir::Opcode::call, &ir::Instruction::op);
  support::assert_that(call != table.instructions.end(), "an eval program calls no function");
  const uint32_t function = call->imm;
  table.name = "eval_of_table";  // programs of other kernels are made of the module
  return Lowered{std::move(program->module), function};
}

driver::Program idle_program(const driver::Program& program) {
  ir::Module module = lower::frame_module();
  ir::Function function;
  function.name = "idle";
  const auto type_of = [](const driver::Field& field) {
    support::assert_that(field.words <= 4, "an eval column is a matrix");
    return ir::vector_type(field.words);
  };
  for (const driver::Field& field : program.inputs)
    function.parameters.push_back({field.name, type_of(field), "", false});
  for (const driver::Field& field : program.results) function.results.push_back({field.name, type_of(field)});
  const auto parameters = function.parameters;
  const auto results = function.results;
  module.functions.push_back(std::move(function));
  ir::Builder b(module, 0);
  ir::ValueId sum = ir::none;
  for (size_t i = 0; i < parameters.size(); ++i) {
    for (uint32_t c = 0; c < parameters[i].type.width; ++c) {
      const ir::ValueId whole = b.parameter(i);
      const ir::ValueId word = parameters[i].type.width == 1 ? whole : b.extract(whole, c);
      sum = sum == ir::none ? word : b.op(ir::Opcode::fadd, {sum, word});
    }
  }
  std::vector<ir::ValueId> values;
  for (const ir::Result& result : results)
    values.push_back(result.type.width == 1 ? sum
                                            : b.construct(std::vector<ir::ValueId>(result.type.width, sum)));
  b.finish(values);
  return driver::finish_eval(std::move(module), 0, "idle");
}

std::optional<std::vector<reference::Real>> exact_results(const Subject& subject, check::Library& library,
                                                          const std::vector<int32_t>& inputs, size_t rows,
                                                          Diagnostics& diagnostics) {
  if (subject.variant == nullptr) {
    const support::Source source = graph::read_source(subject.document, diagnostics);
    if (source == nullptr) return std::nullopt;
    driver::CompileOptions options;
    options.library = &library;
    options.reference = true;
    const auto program = driver::compile_function(source, options, diagnostics);
    if (!program) return std::nullopt;
    return reference::evaluate(*program, inputs, rows);
  }
  size_t words = 0, results = 0;
  for (const ir::Type type : subject.variant->parameters) words += type.width;
  for (const ir::Type type : subject.variant->results) results += type.width;
  std::vector<reference::Real> exact(rows * results), arguments(words);
  for (size_t row = 0; row < rows; ++row) {
    for (size_t i = 0; i < words; ++i) arguments[i] = __builtin_bit_cast(float, inputs[row * words + i]);
    reference::evaluate(*subject.variant, arguments, std::span(exact).subspan(row * results, results));
  }
  return exact;
}

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
