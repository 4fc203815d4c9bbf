// SPDX-License-Identifier: Apache-2.0
// Runs functions of a module as ir::Interpreter does, but on numbers instead of floats.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backends/reference/real.h"
#include "compiler/functions/library.h"
#include "compiler/ir/module.h"

namespace isoshade::reference {

/// One component of a value.
struct Cell {
  Real number;        ///< of a float
  uint32_t word = 0;  ///< of an int or a bool (0, 1)
};

/// One component of the result of a primitive op, into `to`.
void compute(ir::Opcode op, const Cell& a, const Cell& b, const Cell& c, Cell& to);

/// For modules as lowering makes them: calls of functions.def are still calls, and the reference column of their rows
/// computes them. Every float is a Real: nothing is rounded, overflows or underflows. Literals and loads give the
/// floats of the module and of the buffers. Comparisons compare unrounded numbers, so their results may differ from
/// those of other backends. Ints have 32 bits; conversion to int truncates and saturates. The bits of a number are
/// those of the float that would be stored.
///
/// Not thread-safe. The module must be valid, have no ddx or ddy, and outlive the evaluator.
class Evaluator {
 public:
  explicit Evaluator(const ir::Module& module);

  /// Sets the words of a buffer, see ir::Interpreter.
  void bind(uint32_t buffer, std::span<const uint32_t> words) { buffers_[buffer] = words; }

  /// Arguments and results are flattened.
  void run(uint32_t function, std::span<const Cell> arguments, std::span<Cell> results);

 private:
  /// The values of a function. Calls are acyclic, so no function is active twice.
  struct CallFrame {
    const ir::Function* function = nullptr;
    const functions::Variant* variant = nullptr;  ///< the library function that it declares, if any
    std::vector<uint32_t> first;                  ///< the first cell of each value
    std::vector<Cell> cells;
  };

  CallFrame& frame_of(uint32_t function);
  void block(CallFrame& frame, ir::BlockId id);
  void instruction(CallFrame& frame, const ir::Instruction& made);
  void primitive(CallFrame& frame, const ir::Instruction& made);
  void load(CallFrame& frame, const ir::Instruction& made);
  void call(CallFrame& frame, const ir::Instruction& made);
  void call_library(CallFrame& frame, const functions::Variant& variant, const ir::Instruction& made);
  void loop(CallFrame& frame, const ir::Instruction& made);

  const ir::Module& module_;
  std::vector<std::span<const uint32_t>> buffers_;
  std::vector<CallFrame> frames_;
};

}  // namespace isoshade::reference
