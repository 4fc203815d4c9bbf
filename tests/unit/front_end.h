// SPDX-License-Identifier: Apache-2.0
// Documents given as text, through the whole front end, for tests.
#pragma once

#include <bit>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/check/check.h"
#include "compiler/functions/library.h"
#include "compiler/graph/extend.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/validator.h"
#include "compiler/lower/lower.h"

namespace isoshade {

/// A library of documents in memory: "square" is at library/square.json.
class FrontEnd {
 public:
  explicit FrontEnd(std::string library_root = "library") : library(std::move(library_root)) {}

  /// The document, checked; null after errors.
  std::shared_ptr<const check::TypedGraph> check(std::string text, std::string path = "test.json") {
    return check(std::make_shared<support::SourceFile>(std::move(path), std::move(text)));
  }
  std::shared_ptr<const check::TypedGraph> check_file(const std::string& path) {
    const support::Source source = graph::read_source(path, diagnostics);
    return source != nullptr ? check(source) : nullptr;
  }
  /// What the document is told, as text.
  std::string messages(std::string text, std::string path = "test.json") {
    check(std::move(text), std::move(path));
    return diagnostics.text();
  }

  /// The module of a document that must be right.
  ir::Module lower(std::string text) { return lowered(check(std::move(text))); }
  ir::Module lower_file(const std::string& path) { return lowered(check_file(path)); }

  check::Library library;
  support::Diagnostics diagnostics;

 private:
  std::shared_ptr<const check::TypedGraph> check(const support::Source& source) {
    const auto document = graph::load_document(source, library.files(), diagnostics);
    if (!document) return nullptr;
    auto graph = graph::build_graph(*document, diagnostics);
    return graph ? check::check(std::move(*graph), library, diagnostics) : nullptr;
  }
  ir::Module lowered(const std::shared_ptr<const check::TypedGraph>& graph) {
    EXPECT_NE(graph, nullptr) << diagnostics.text();
    return graph != nullptr ? isoshade::lower::lower(*graph).module : ir::Module{};
  }
};

/// A module's entry, run by the interpreter. Arguments and results are floats.
class Program {
 public:
  /// Its entry is the last function with a body: the document's own.
  explicit Program(ir::Module module) : module_(std::move(module)) {
    for (uint32_t i = 0; i < module_.functions.size(); ++i)
      if (!module_.functions[i].is_declaration()) entry_ = i;
    functions::expand(module_);
    EXPECT_EQ(ir::validate(module_), "");
    interpreter_.emplace(module_);
  }

  /// Vectors are flattened.
  std::vector<float> operator()(const std::vector<float>& arguments) {
    std::vector<uint32_t> in;
    for (const float argument : arguments) in.push_back(std::bit_cast<uint32_t>(argument));
    size_t words = 0;
    for (const ir::Result& result : module_.functions[entry_].results) words += result.type.width;
    std::vector<uint32_t> results(words);
    EXPECT_TRUE(interpreter_->run(entry_, in, results));
    std::vector<float> out;
    for (const uint32_t result : results) out.push_back(std::bit_cast<float>(result));
    return out;
  }

  const ir::Module& module() const { return module_; }

 private:
  ir::Module module_;
  uint32_t entry_ = 0;
  std::optional<ir::Interpreter> interpreter_;
};

}  // namespace isoshade
