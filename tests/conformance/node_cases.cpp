// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/node_cases.h"

#include <gtest/gtest.h>
#include <set>

#include "compiler/driver/driver.h"
#include "compiler/nodes/example.h"
#include "tests/conformance/cases.h"

namespace isoshade::conformance {
namespace {

using nodes::Example;

constexpr int max_words = 32;

std::string label(const Example& example) {
  std::string text(example.row->name);
  bool t = false, u = false;
  for (const nodes::Port& port : example.row->ports) {
    t = t || port.type.variable == nodes::Variable::t;
    u = u || port.type.variable == nodes::Variable::u;
  }
  if (t) text += " " + std::string(graph::type_name(example.t));
  if (u) text += " " + std::string(graph::type_name(example.u));
  return text;
}

/// Which examples are the same but for the names of types.
std::string shape(const Example& example) {
  std::string text = label(example);
  for (size_t at = 0; (at = text.find("color", at)) != std::string::npos;) text.replace(at, 5, "vector");
  return text;
}

int words_of(graph::Type type) { return std::max(1, graph::float_count(type)); }

int result_words(const Example& example) {
  int words = 0;
  for (const nodes::Output& output : example.row->outputs) words += words_of(example.type_of(output.type));
  return words;
}

NodeCase compiled(const std::vector<Example>& examples) {
  NodeCase made;
  for (const Example& example : examples) {
    made.nodes.push_back(label(example));
    for (int i = 0; i < result_words(example); ++i)
      made.words.push_back(label(example) + "." + std::to_string(i));
  }
  support::Diagnostics diagnostics;
  check::Library library;
  driver::CompileOptions options;
  options.library = &library;
  const auto source = std::make_shared<support::SourceFile>("nodes.json", nodes::function_document(examples));
  auto program = driver::compile_function(source, options, diagnostics);
  if (program) made.program = *std::move(program);
  EXPECT_TRUE(program.has_value()) << diagnostics.text();
  return made;
}

}  // namespace

std::vector<NodeCase> node_cases() {
  std::vector<NodeCase> cases;
  std::vector<Example> bundle;
  std::set<std::string> known;
  int words = 0;
  const auto flush = [&] {
    if (!bundle.empty()) cases.push_back(compiled(bundle));
    bundle.clear();
    words = 0;
  };
  for (const nodes::Row& row : nodes::table()) {
    if (row.availability() != nodes::Availability::anywhere) continue;
    for (const Example& example : nodes::examples_of(row)) {
      if (!known.insert(shape(example)).second) continue;
      if (words + result_words(example) > max_words) flush();
      bundle.push_back(example);
      words += result_words(example);
    }
  }
  flush();
  return cases;
}

std::vector<int32_t> node_inputs(const driver::Program& program, size_t rows) {
  const std::vector<int32_t> source = inputs(rows);
  std::vector<int32_t> words;
  for (size_t row = 0; row < rows; ++row) {
    size_t column = 0;
    for (const driver::Field& field : program.inputs) {
      const bool integer = field.type == "integer", boolean = field.type == "boolean";
      for (int i = 0; i < field.words; ++i, ++column) {
        // Three floats and two ints a record; what goes beyond comes from records farther on.
        const size_t record = (row + column / 3 * 7919) % rows;
        const size_t at = integer || boolean ? 3 + column % 2 : column % 3;
        const int32_t word = source[record * input_words + at];
        words.push_back(boolean ? word & 1 : word);
      }
    }
  }
  return words;
}

}  // namespace isoshade::conformance
