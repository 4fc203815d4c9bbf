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

/// For modules as lowering makes them: calls of functions.def are calls, and computed by the reference column of their
/// rows. Every float is a Real: nothing is rounded, overflows or underflows. Literals are the floats of the module;
/// what is loaded are the floats of the buffers. Comparisons decide on numbers, and so may decide otherwise than a
/// backend does on rounded ones. Ints are 32 bits; to become one a number is cut, and held within the range. The bits
/// of a number are those of the float that would be stored.
///
/// Not for several threads at once. The module must be valid, without ddx and ddy, and outlive the evaluator.
class Evaluator {
 public:
  explicit Evaluator(const ir::Module& module);

  /// The words of a buffer, as ir::Interpreter has them.
  void bind(uint32_t buffer, std::span<const uint32_t> words) { buffers_[buffer] = words; }

  /// Arguments and results are flattened.
  void run(uint32_t function, std::span<const Cell> arguments, std::span<Cell> results);

 private:
  /// The values of a function. Calls are acyclic, so that each has only one at a time.
  struct CallFrame {
    const ir::Function* function = nullptr;
    const functions::Variant* variant = nullptr;  ///< which declaration it is, if it is one
    std::vector<uint32_t> first;                  ///< by value: its first cell
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
