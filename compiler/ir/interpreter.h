// SPDX-License-Identifier: Apache-2.0
// Runs functions of a module on one lane. Slow and simple: the reference semantics of the IR, which every other
// executor must match.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

enum class Preconditions : uint8_t {
  enforce,  ///< a breach is a bug: prints the function and aborts
  report,   ///< a breach is counted; the result is that of evaluate.h
};

/// Not thread-safe. The module must be valid and outlive the interpreter; a function must not change after its first
/// run.
class Interpreter {
 public:
  explicit Interpreter(const Module& module, Preconditions preconditions = Preconditions::enforce);

  /// The words of a buffer; they must outlive the runs. An index outside [0, size) reads the last element;
  /// loading from an empty or unbound buffer is a breach and gives 0. Denormal floats are flushed as they are
  /// loaded.
  void bind(uint32_t buffer, std::span<const uint32_t> words);

  /// Limits the steps of all following runs together. There is no limit by default.
  void limit_steps(uint64_t steps) { steps_left_ = steps; }

  uint64_t steps_left() const { return steps_left_; }

  /// Runs a function all of whose callees have bodies. Arguments and results are words, vectors flattened,
  /// bools 0 or 1; denormal float arguments are flushed, NaN results are 0x7fc00000. False if the step limit
  /// was reached. Only a function's first run allocates memory.
  bool run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results);

  /// Preconditions that did not hold, in all runs so far.
  uint64_t breaches() const { return breaches_; }

 private:
  // Functions become straight code with jumps. Every value of every function has registers of its own, which
  // suffices because calls are acyclic.
  enum class Code : uint8_t { primitive, copy, load, jump, jump_if_not, jump_unless_less, call, leave };

  struct Step {
    Code code;
    Opcode op;                     ///< of a primitive
    Precondition precondition;     ///< of a primitive
    uint8_t width;                 ///< how many words
    bool scalar_first;             ///< operand a is one word for all components (select's condition)
    uint32_t to;                   ///< a register; jumps and calls: the step to go to; load: the buffer
    uint32_t a = 0, b = 0, c = 0;  ///< registers
    InstructionId source = none;
  };

  struct Slot {
    uint32_t first;  ///< register
    Type type;
  };

  struct Compiled {
    uint32_t entry = none;  ///< its first step, none: not compiled yet
    uint32_t end = 0;
    std::vector<Slot> parameters;
    std::vector<Slot> results;
  };

  class Compiler;

  bool execute(uint32_t entry);
  void breach(const Step& step, uint32_t operand);

  const Module& module_;
  Preconditions preconditions_;
  std::vector<std::span<const uint32_t>> buffers_;
  std::vector<Compiled> compiled_;
  std::vector<Step> steps_;
  std::vector<uint32_t> registers_;
  std::vector<uint32_t> returns_;
  uint64_t steps_left_ = ~uint64_t{0};
  uint64_t breaches_ = 0;
};

}  // namespace isoshade::ir
