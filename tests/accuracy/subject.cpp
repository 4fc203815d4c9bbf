// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/subject.h"

#include <bit>
#include <gtest/gtest.h>

#include "backends/cpu/backend.h"
#include "backends/cpu/lane_count.h"
#include "backends/interpreter/backend.h"
#include "backends/reference/backend.h"
#include "compiler/functions/library.h"
#include "compiler/ir/float_bits.h"
#include "compiler/lower/stages.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::accuracy {
namespace {

using Backends = std::vector<std::unique_ptr<backends::Backend>>;

/// Those that this machine can have; the first is the fastest. Never destroyed: drivers may be gone before.
const Backends& all_backends() {
  static const Backends& all = *[] {
    auto* made = new Backends;
    support::Diagnostics diagnostics;
    const bool wide = cpu::lane_count("16")->available();
    for (const char* lanes : {wide ? "16" : "8x2", "1"}) {
      if (!cpu::lane_count(lanes)->available()) continue;
      cpu::CpuOptions options;
      options.lanes = lanes;
      made->push_back(cpu::create(options, diagnostics));
    }
#ifdef ISOSHADE_VULKAN
    made->push_back(vulkan::create({}, diagnostics));
#endif
    made->push_back(interpreter::create());
    std::erase(*made, nullptr);
    EXPECT_EQ(diagnostics.text(), "");
    return made;
  }();
  return all;
}

std::vector<int32_t> to_words(const std::vector<float>& values) {
  std::vector<int32_t> words;
  words.reserve(values.size());
  for (const float value : values)
    words.push_back(static_cast<int32_t>(ir::canonical_float(std::bit_cast<uint32_t>(value))));
  return words;
}

std::vector<float> to_floats(const std::vector<int32_t>& words) {
  std::vector<float> values;
  values.reserve(words.size());
  for (const int32_t word : words) values.push_back(std::bit_cast<float>(word));
  return values;
}

std::vector<int32_t> run(backends::Backend& backend, const driver::Program& program,
                         const std::vector<int32_t>& inputs, size_t rows) {
  support::Diagnostics diagnostics;
  std::vector<int32_t> results;
  EXPECT_TRUE(backend.evaluate(program, inputs, rows, results, diagnostics)) << diagnostics.text();
  return results;
}

}  // namespace

std::string graph_path(const std::string& name) { return ISOSHADE_GRAPHS "/" + name + ".json"; }

size_t Subject::words_of(const std::vector<driver::Field>& fields) {
  size_t words = 0;
  for (const driver::Field& field : fields) words += static_cast<size_t>(field.words);
  return words;
}

Subject::Subject(std::string name, std::string source, size_t arguments)
    : name_(std::move(name)), source_(std::move(source)), arguments_(arguments) {
  program_ = compile(functions::Tier::standard);
}

Subject Subject::in_tier(functions::Tier tier) const {
  Subject other = *this;
  other.program_ = compile(tier);
  return other;
}

driver::Program Subject::compile(functions::Tier tier, bool reference) const {
  if (source_.empty()) return compile_row(tier);
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  options.reference = reference;
  options.tier = tier;
  // Under its own name, from which it finds other documents.
  const auto source = std::make_shared<support::SourceFile>(graph_path(name_), source_);
  auto program = driver::compile_function(source, options, diagnostics);
  EXPECT_TRUE(program) << diagnostics.text();
  return program ? *std::move(program) : driver::Program();
}

driver::Program Subject::compile_row(functions::Tier tier) const {
  ir::Module module = lower::frame_module();
  const auto index = static_cast<uint32_t>(module.functions.size());
  ir::Function& function = module.functions.emplace_back();
  function.name = "measured";
  for (size_t i = 0; i < arguments_; ++i)
    function.parameters.push_back({std::string(1, "xyz"[i]), ir::float_type, "", false});
  function.results = {{"out", ir::float_type}};
  ir::Builder b(module, index);
  std::vector<ir::ValueId> parameters;
  for (size_t i = 0; i < arguments_; ++i) parameters.push_back(b.parameter(i));
  b.finish(functions::call_library(b, name_, parameters));
  return driver::finish_eval(std::move(module), index, name_, tier);
}

Subject Subject::document(const std::string& name) {
  support::Diagnostics diagnostics;
  const support::Source source = graph::read_source(graph_path(name), diagnostics);
  EXPECT_NE(source, nullptr) << diagnostics.text();
  return Subject(name, source == nullptr ? "{}" : std::string(source->text()));
}

Subject Subject::expression(const std::vector<std::string>& inputs, const std::string& code) {
  std::string declared, ports;
  for (const std::string& input : inputs) {
    const size_t colon = input.find(':');
    const std::string name = input.substr(0, colon);
    const std::string type = colon == std::string::npos ? "float" : input.substr(colon + 1);
    declared += (declared.empty() ? "" : ", ") + ("\"" + name + R"(": {"type": ")" + type + "\"}");
    ports += ", \"" + name + "\": \"" + name + "\"";
  }
  return Subject(code, R"({"isoshade": 1, "function": "measured", "inputs": {)" + declared +
                           R"(}, "nodes": {"result": {"type": "expression", "code": ")" + code + "\"" +
                           ports + R"(}}, "outputs": {"out": "result"}})");
}

Subject Subject::row(const std::string& name, size_t arguments) { return Subject(name, "", arguments); }

std::vector<float> Subject::operator()(const std::vector<float>& inputs) const {
  const size_t rows = inputs.size() / this->inputs();
  const std::vector<int32_t> words = to_words(inputs);
  std::vector<int32_t> first;
  for (const auto& backend : all_backends()) {
    std::vector<int32_t> results = run(*backend, program_, words, rows);
    if (backend == all_backends().front())
      first = std::move(results);
    else
      EXPECT_TRUE(first == results) << name_ << " differs on " << backend->description();
  }
  return to_floats(first);
}

std::vector<float> Subject::on_one_backend(const std::vector<float>& inputs) const {
  return to_floats(run(*all_backends().front(), program_, to_words(inputs), inputs.size() / this->inputs()));
}

std::vector<reference::Real> Subject::exact(const std::vector<float>& inputs) const {
  return reference::evaluate(compile(functions::Tier::standard, true), to_words(inputs),
                             inputs.size() / this->inputs());
}

}  // namespace isoshade::accuracy
