// SPDX-License-Identifier: Apache-2.0
// Modules from text, for tests.
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/ir/interpreter.h"
#include "compiler/ir/parser.h"
#include "compiler/ir/validator.h"

namespace isoshade::ir {

/// The module of a text, which must parse; an empty one if it does not.
inline Module parsed(std::string_view text) {
  std::string error;
  auto module = parse(text, error);
  EXPECT_TRUE(module.has_value()) << error << "\n" << text;
  return module ? std::move(*module) : Module{};
}

/// The same, and it must be valid.
inline Module valid(std::string_view text) {
  Module module = parsed(text);
  EXPECT_EQ(validate(module), "") << text;
  return module;
}

/// How many words a list of parameters or results takes.
template <class Typed>
size_t words_of(const std::vector<Typed>& typed) {
  size_t words = 0;
  for (const Typed& one : typed) words += one.type.width;
  return words;
}

/// What function 0 gives for these argument words.
inline std::vector<uint32_t> run(const Module& module, const std::vector<uint32_t>& arguments,
                                 Preconditions preconditions = Preconditions::enforce) {
  Interpreter interpreter(module, preconditions);
  std::vector<uint32_t> results(words_of(module.functions[0].results));
  EXPECT_TRUE(interpreter.run(0, arguments, results));
  return results;
}

}  // namespace isoshade::ir
