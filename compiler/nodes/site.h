// SPDX-License-Identifier: Apache-2.0
// Values of the graph as IR, and one node on its way there.
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

/// How many IR values a type takes, and of what type each is. A file name is the number of a texture. Strings have none.
int column_count(Type type);
ir::Type ir_type(Type type);

/// A value of `type` with `bits` in its floats (columns one after another), or as its boolean or integer.
Value constant(ir::Builder& b, Type type, std::span<const uint32_t> bits);

/// `value`, which is of type `from`, as the wider type that it is converted to implicitly: an integer as
/// float, a float as vector or colour.
Value broadcast(ir::Builder& b, Value value, Type from, Type to);

/// Calls a row of functions.def, for each component where it takes none but floats.
Value call_function(ir::Builder& b, std::string_view row, std::span<const Value> arguments);

/// One node being lowered.
struct Site {
  ir::Builder& b;
  std::span<const Value> in;           ///< of each port, of the types that checking settled
  std::span<const Type> types;         ///< of each port
  std::span<const uint32_t> settings;  ///< of literal ports: a Type, the number of a choice, a component
  std::span<const Type> out_types;     ///< of each output
  std::span<Value> out;                ///< to be made

  ir::ValueId operator[](size_t port) const { return in[port].id(); }
  ir::ValueId op(ir::Opcode opcode, std::initializer_list<ir::ValueId> operands) const {
    return b.op(opcode, operands);
  }
  /// The op of all ports, which are alike; of matrices column by column.
  Value op_of_columns(ir::Opcode opcode) const;
  Value call(std::string_view row, std::initializer_list<Value> arguments) const {
    return call_function(b, row, arguments);
  }
};

/// Makes the outputs of a row that needs nothing but its ports.
void lower(const Row& row, Site& site);

}  // namespace isoshade::nodes
