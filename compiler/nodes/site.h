// SPDX-License-Identifier: Apache-2.0
// Lowering of one node: values of the graph as IR values.
#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <string_view>

#include "compiler/ir/builder.h"
#include "compiler/nodes/row.h"

namespace isoshade::nodes {

/// A value of the graph: one IR value, or one for each column of a matrix.
struct Value {
  std::array<ir::ValueId, 4> columns{ir::none, ir::none, ir::none, ir::none};
  uint8_t count = 0;

  Value() = default;
  Value(ir::ValueId id) : columns{id, ir::none, ir::none, ir::none}, count(1) {}
  explicit Value(std::span<const ir::ValueId> ids);

  ir::ValueId id() const { return columns[0]; }
  std::span<const ir::ValueId> ids() const { return {columns.data(), count}; }
};

/// The number of IR values for a type (0 for filenames and strings), and the type of each.
int column_count(Type type);
ir::Type ir_type(Type type);

/// A constant of `type` from the bits of its floats (column by column), of its boolean or of its integer.
Value constant(ir::Builder& b, Type type, std::span<const uint32_t> bits);

/// Converts `value` implicitly from `from` to `to`: an integer to float, a float to a vector or colour.
Value broadcast(ir::Builder& b, Value value, Type from, Type to);

/// Calls a row of functions.def; componentwise if the row has no variant for these types.
Value call_function(ir::Builder& b, std::string_view row, std::span<const Value> arguments);

/// One node being lowered.
struct Site {
  ir::Builder& b;
  std::span<const Value> in;           ///< by port, after implicit conversion
  std::span<const Type> types;         ///< by port
  std::span<const uint32_t> settings;  ///< by port, for literal ports: a Type, a choice, a component
  std::span<const Type> out_types;     ///< by output
  std::span<Value> out;                ///< by output; lowering sets them

  ir::ValueId operator[](size_t port) const { return in[port].id(); }
  ir::ValueId op(ir::Opcode opcode, std::initializer_list<ir::ValueId> operands) const {
    return b.op(opcode, operands);
  }
  /// Applies the op to all ports, which have the same type; to matrices column by column.
  Value op_of_columns(ir::Opcode opcode) const;
  Value call(std::string_view row, std::initializer_list<Value> arguments) const {
    return call_function(b, row, arguments);
  }
};

/// Computes the outputs of a row that depends only on its ports.
void lower(const Row& row, Site& site);

}  // namespace isoshade::nodes
