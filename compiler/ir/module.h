// SPDX-License-Identifier: Apache-2.0
// The IR: functions in structured SSA form. Pure: nothing is stored, only returned.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/ir/op.h"
#include "compiler/ir/type.h"

namespace isoshade::ir {

using ValueId = uint32_t;
using InstructionId = uint32_t;
using BlockId = uint32_t;
inline constexpr uint32_t none = ~0u;

/// How deep blocks may nest; a module that nests deeper is invalid. Passes may recurse over blocks.
inline constexpr int max_block_depth = 128;

/// Where an instruction comes from: the node of a document. Index 0 of a function's origins is "nowhere".
struct Origin {
  std::string node;   ///< the node's id; names the value in emitted text
  uint32_t line = 0;  ///< in the function's document
  std::string doc = {};  ///< the author's words on the node, for readers of emitted text
  friend bool operator==(const Origin&, const Origin&) = default;
};

struct Value {
  Type type;
  /// The index of the origin this value is *the* result of (it gets the node's own name), or 0.
  uint32_t names = 0;
  friend bool operator==(const Value&, const Value&) = default;
};

struct Instruction {
  Opcode op{};
  uint32_t imm = 0;            ///< see Opcode
  uint32_t first_operand = 0;  ///< in Function::operands
  uint32_t operand_count = 0;
  ValueId first_result = 0;  ///< results are consecutive values
  uint32_t result_count = 1;
  std::array<BlockId, 2> blocks{none, none};  ///< branch: then, else; loop: body
  uint32_t origin = 0;
  friend bool operator==(const Instruction&, const Instruction&) = default;
};

/// A list of instructions with parameters (of the function, or a loop's index and carried values) that yields
/// values. Values of enclosing blocks are visible inside.
struct Block {
  std::vector<ValueId> parameters;
  std::vector<InstructionId> instructions;
  std::vector<ValueId> yields;
  friend bool operator==(const Block&, const Block&) = default;
};

/// How a parameter is written and how it varies. Parameters with a group become a struct's fields in emitted
/// text: `surface.normal`. Parameters of one group are consecutive.
struct Parameter {
  std::string name;
  Type type;
  std::string group;     ///< empty: a plain parameter
  bool uniform = false;  ///< the same for all lanes of a batch (material parameters, light data, counts)
  std::optional<float> least = {}, most = {};  ///< of each component; if both are there, it is never NaN
  std::string doc = {};  ///< the author's words on it, for readers of emitted text
  friend bool operator==(const Parameter&, const Parameter&) = default;
};

struct Result {
  std::string name;
  Type type;
  friend bool operator==(const Result&, const Result&) = default;
};

/// The body is block 0: its parameters are the function's, its yields the results.
struct Function {
  std::string name;      ///< unique in the module; [A-Za-z_][A-Za-z0-9_]*
  std::string document;  ///< the path of the document it was authored in; empty for library functions
  std::string
      library;  ///< the name in functions.def whose body this stands for; empty if authored or a stage
  std::vector<Parameter> parameters;
  std::vector<Result> results;
  std::vector<Origin> origins{{}};
  std::vector<Value> values;
  std::vector<Instruction> instructions;
  std::vector<ValueId> operands;
  std::vector<Block> blocks;

  /// A library function that `expand` has not given its body yet, or one that the program defines which links the module.
  bool is_declaration() const { return blocks.empty(); }

  std::span<const ValueId> operands_of(const Instruction& i) const {
    return {operands.data() + i.first_operand, i.operand_count};
  }
  std::span<ValueId> operands_of(const Instruction& i) {
    return {operands.data() + i.first_operand, i.operand_count};
  }
  Type type(ValueId value) const { return values[value].type; }
  friend bool operator==(const Function&, const Function&) = default;
};

/// A part of a record, by its place in the record.
struct RecordField {
  std::string name;
  uint32_t first = 0;  ///< word
  uint32_t words = 1;
  friend bool operator==(const RecordField&, const RecordField&) = default;
};

/// A read-only array of 32-bit elements that stages load from.
struct Buffer {
  std::string name;
  Scalar element = Scalar::floating;  ///< floating or integer
  /// The words of its records, if emitted text is to name them. Then a load's index is the first word of a record, or
  /// that plus a constant.
  std::vector<RecordField> fields = {};
  /// There is one record, which begins at word 0: only loads with a constant index are of its fields.
  bool one_record = false;
  friend bool operator==(const Buffer&, const Buffer&) = default;
};

/// Calls are acyclic; a callee may stand after its caller.
struct Module {
  std::vector<Buffer> buffers;
  std::vector<Function> functions;

  uint32_t find(std::string_view function) const;     ///< its index, or none
  uint32_t find_buffer(std::string_view name) const;  ///< its index, or none
  friend bool operator==(const Module&, const Module&) = default;
};

/// Whether there is any ddx or ddy.
bool asks_for_derivatives(const Module& module);

}  // namespace isoshade::ir
