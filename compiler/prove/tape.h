// SPDX-License-Identifier: Apache-2.0
// A function of a module as one list of scalar operations with all calls inlined, in an order in which it can be
// evaluated again and again for other inputs: on floats, or on bounds.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "compiler/prove/rules.h"
#include "compiler/ir/module.h"

namespace isoshade::prove {

inline constexpr uint32_t none = ir::none;
/// A function that needs more operations than this has no tape.
inline constexpr size_t most_operations = 200'000;

enum class Kind : uint8_t {
  constant,
  input,     ///< index: in Tape::inputs
  op,        ///< a primitive op
  least,     ///< the functions min
  greatest,  ///< and max
  dot,       ///< of the first half of its operands with the second
  row,       ///< one component of another function of functions.def
  sum,       ///< of its operand over at most `index` turns; bits: 1 where the number of turns is fixed
  asked,     ///< its first operand, an input: a host's answer to a question, the other operands; index: an Answer
  unknown,   ///< anything
  narrow,    ///< its first operand, for which the comparison `op` with the second holds here
  enter,     ///< index: in Tape::guards; from here on it is known whether that guard holds
};

struct Operation {
  Kind kind{};
  ir::Opcode op{};
  ir::Scalar scalar = ir::Scalar::floating;
  uint8_t component = 0;          ///< of a row
  uint32_t index = 0;             ///< see Kind; of a row: in Tape::rows
  uint32_t bits = 0;              ///< of a constant
  uint32_t first = 0, count = 0;  ///< in Tape::operands
  uint32_t place = 0;             ///< in Tape::places
  uint32_t guard = 0;             ///< in Tape::guards: the operation is only evaluated where this holds
};

/// How far a host's answer may lie from its answer to the exact question.
enum class Answer : uint8_t {
  same,      ///< exact if the question is exact; otherwise any other answer is possible
  other,     ///< any other answer is possible: rounding may move the nearest texel to the next one
  filtered,  ///< interpolated between texels; the question is a texture and its two coordinates
  quotient,  ///< off by a few roundings if the question is exact; otherwise any other answer is possible
  unknown,   ///< nothing is known of its error
};

/// The node that an operation comes from.
struct IrPlace {
  std::string document;  ///< as ir::Function::document
  std::string node;
  uint32_t caller = none;                ///< the node that called the document's function, in Tape::places
  uint32_t function = none, origin = 0;  ///< of the module that the tape was made of
};

struct Side {
  double lo = 0, hi = 0;
};

/// A scalar input.
struct Input {
  std::string name;  ///< "f0.x", "surface.normal.x", "m.0"
  ir::Scalar scalar = ir::Scalar::floating;
  double lo = 0, hi = 0;
  uint32_t vector = none;  ///< the unit vector that it is a component of: the index of its first input
  double quotient = 0;     ///< see Given
};

/// What is assumed of an input, in each component.
struct Given {
  std::string name;
  double lo = 0, hi = 0;
  bool unit = false;  ///< a vector of length 1
  int element = -1;   ///< of a column of a matrix: the index of its first element in the matrix
  /// Not 0: a quotient by a sum that begins with this input is an input, too, between 0 and this.
  double quotient = 0;
  Answer answer = Answer::same;  ///< of a result that a host is asked for
};

/// A condition under which operations are evaluated. Guard 0 always holds.
struct Guard {
  uint32_t parent = 0;
  uint32_t condition = none;  ///< an operation
  bool truth = true;
};

/// A row of functions.def at one set of types, and its body in the tape's module.
struct Row {
  const Rule* rule = nullptr;
  uint32_t function = none;
  uint32_t words = 1;  ///< of its result
};

/// What is known of an operation beyond its operands. The operations that it names come before it.
struct Fact {
  enum class Kind : uint8_t {
    dot,         ///< |a . b| <= |a| |b|: first, second are a . a and b . b, or none
    projection,  ///< n . l + n . v is near first, which is n . (l + v); second is how near
    rotation,  ///< |u x w|^2 + (r (u . w))^2 >= min(1, r^2) |w|^2: first is w . w, second r, |u| = 1; if there
               ///< is a third, |u| may be 0, but not where that one, a product of u, is not 0
    half,      ///< max(a, b) >= first / 2, which is a + b
  };
  Kind kind{};
  uint32_t first = none, second = none, third = none;
  uint32_t left = none, right = none;  ///< of a dot: a and b in Tape::vectors
};

/// A factor of a scalar product and how it was made: its length tells more of the product's error than its components.
struct VectorShape {
  enum class Kind : uint8_t {
    given,  ///< by anything else
    sum,    ///< left + right or left - right
    cross,  ///< left x right
  };
  Kind kind{};
  uint32_t left = none, right = none;  ///< in Tape::vectors
  std::vector<uint32_t> components;    ///< operations
  uint32_t square = none;              ///< its scalar product with itself, if that comes before
  double length = HUGE_VAL;            ///< an upper bound of its length
};

struct Tape {
  ir::Module module;                                 ///< with bodies for all calls of library functions
  functions::Tier tier = functions::Tier::standard;  ///< of these bodies
  std::vector<Operation> operations;
  std::vector<uint32_t> operands;  ///< operations
  std::vector<Input> inputs;
  std::vector<Guard> guards{{}};
  std::vector<Row> rows;
  std::vector<IrPlace> places{{}};
  std::unordered_map<uint32_t, std::vector<Fact>> facts;  ///< of operations
  std::vector<VectorShape> vectors;                       ///< of facts; the vectors that one is made of come before it
  struct Output {
    std::string name;  ///< "out.x"
    uint32_t operation = none;
  };
  std::vector<Output> outputs;

  std::span<const uint32_t> operands_of(const Operation& operation) const {
    return {operands.data() + operation.first, operation.count};
  }
};

/// The length of a unit vector differs from 1 by at most this.
inline constexpr double unit_tolerance = 0x1p-21;

/// The tape of a function; nothing if it would be too long. `given`: what is assumed of each of its parameters.
/// `outside`: what is assumed of each result of a function of the module that the host answers; nothing for one whose
/// body is to be followed. Nothing is assumed of other results.
std::optional<Tape> make_tape(const ir::Module& module, uint32_t function, const std::vector<Given>& given,
                              const std::function<std::vector<Given>(uint32_t)>& outside,
                              functions::Tier tier = functions::Tier::standard);

}  // namespace isoshade::prove
