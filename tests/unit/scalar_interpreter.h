// SPDX-License-Identifier: Apache-2.0
// The interpreter backend on ir::Interpreter, which runs one call at a time and enforces the preconditions of ops.
#pragma once

#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "backends/interpreter/backend.h"
#include "backends/interpreter/stages.h"
#include "compiler/ir/interpreter.h"
#include "compiler/support/assert.h"

namespace isoshade::interpreter {

class ScalarMachine final : public Machine {
 public:
  explicit ScalarMachine(const driver::Program& program)
      : interpreter_(program.module), entry_(program.entry), stored_(stored_words(program)), words_(program.module.buffers.size()) {
    size_t results = 0;
    for (const ir::Result& result : program.module.functions[entry_].results) results += result.type.width;
    results_.resize(results);
  }

  void run(const BufferView* buffers, std::span<const Argument> arguments, int count, void* results) override {
    if (!std::exchange(is_bound_, true))
      for (uint32_t i = 0; i < words_.size(); ++i) {
        words_[i].resize(static_cast<size_t>(buffers[i].size));
        std::memcpy(words_[i].data(), buffers[i].data, sizeof(uint32_t) * words_[i].size());
        interpreter_.bind(i, words_[i]);
      }
    std::vector<uint32_t> words;
    for (int call = 0; call < count; ++call) {
      words.clear();
      for (const Argument& argument : arguments) words.push_back(argument.of(call));
      support::assert_that(interpreter_.run(entry_, words, results_), "an interpreter without a limit stopped early");
      std::memcpy(static_cast<std::byte*>(results) + sizeof(uint32_t) * stored_ * static_cast<size_t>(call), results_.data(),
                  sizeof(uint32_t) * stored_);
    }
  }

 private:
  ir::Interpreter interpreter_;
  uint32_t entry_;
  size_t stored_;
  std::vector<std::vector<uint32_t>> words_;  ///< of the buffers
  bool is_bound_ = false;
  std::vector<uint32_t> results_;
};

inline std::unique_ptr<backends::Backend> create_scalar() {
  return create("scalar", "ir::Interpreter, 1 lane, 1 thread",
                [](const driver::Program& program) { return std::make_unique<ScalarMachine>(program); });
}

}  // namespace isoshade::interpreter
