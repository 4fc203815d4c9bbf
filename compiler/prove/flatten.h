// SPDX-License-Identifier: Apache-2.0
// A function as scalar operations, each made once, in the order of the module; put_in_order sorts them for the tape.
#pragma once

#include <array>
#include <map>
#include <set>

#include "compiler/prove/tape.h"

namespace isoshade::prove {

using Words = std::vector<uint32_t>;  ///< of a value: one operation a component

/// Operations, found by what they compute, and facts about vectors.
class Pool {
 public:
  explicit Pool(Tape& tape) : tape_(tape) {}

  /// An equal operation if there is one, or else a new one.
  uint32_t make(Operation operation, std::span<const uint32_t> operands);
  uint32_t make_op(ir::Opcode op, std::initializer_list<uint32_t> operands, ir::Scalar scalar,
                   uint32_t place);
  uint32_t constant(ir::Scalar scalar, uint32_t bits);
  /// An equal operation, or none.
  uint32_t find(const Operation& operation, std::span<const uint32_t> operands) const;
  bool too_long() const { return tape_.operations.size() > most_operations; }

  Tape& tape() { return tape_; }
  const Tape& tape() const { return tape_; }
  const Operation& operator[](uint32_t operation) const { return tape_.operations[operation]; }
  std::span<const uint32_t> operands(uint32_t operation) const {
    return tape_.operands_of(tape_.operations[operation]);
  }

  struct Product {
    Words left, right;
  };
  std::set<Words> units;             ///< of length 1
  std::set<Words> at_most_units;     ///< of length 1, or zeros
  std::map<Words, Product> crosses;  ///< cross products and their factors

  void add_unit(const Words& vector) {
    units.insert(vector);
    at_most_units.insert(vector);
  }

 private:
  static std::vector<uint32_t> key(const Operation& operation, std::span<const uint32_t> operands);

  Tape& tape_;
  std::map<std::vector<uint32_t>, uint32_t> made_;
};

/// Inlines a function of the tape's module, whose library functions have bodies, and sets the outputs. False if the tape
/// became too long.
bool flatten(Pool& pool, uint32_t function, const std::vector<Given>& given,
             const std::function<std::vector<Given>(uint32_t)>& outside);

/// Reorders the operations so that a select's condition comes before what only one of its sides needs; adds guards, the
/// narrower ranges that they imply, and facts.
void put_in_order(Pool& pool);

}  // namespace isoshade::prove
