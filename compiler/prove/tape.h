// SPDX-License-Identifier: Apache-2.0
// A function of a module as one list of scalar operations, calls inlined, in an order in which it can be walked
// over and over with other inputs: by floats, or by bounds.
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
/// Functions that would become more operations than this have no tape.
inline constexpr size_t most_operations = 200'000;

enum class Kind : uint8_t {
  constant,
  input,     ///< index: in Tape::inputs
  op,        ///< a primitive op
  least,     ///< the functions min
  greatest,  ///< and max
  dot,       ///< of the first half of its operands with the second
  row,       ///< one component of another function of functions.def
  sum,       ///< of its operand over at most `index` turns; bits: 1 where their number is not free
  asked,  ///< its first operand, an input: what is there where a host was asked with the others; index: an Answer
  unknown,  ///< anything
  narrow,   ///< its first operand, of which `op` with the second holds here
  enter,    ///< index: in Tape::guards; from here on it is known whether it holds
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
  uint32_t guard = 0;             ///< in Tape::guards: it is only looked at where this holds
};

/// How far what a host answers may lie from what it would have answered to the exact question.
enum class Answer : uint8_t {
  same,      ///< asked exactly, it is exact; else it may be any other
  other,     ///< it may be any other, however it is asked: the nearest texel, that rounding moves to the next
  filtered,  ///< in proportion between texels; asked with a texture and its two coordinates
  quotient,  ///< asked exactly, it errs by a few roundings; else it may be any other
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

/// A number from outside.
struct Input {
  std::string name;  ///< "f0.x", "surface.normal.x", "m.0"
  ir::Scalar scalar = ir::Scalar::floating;
  double lo = 0, hi = 0;
  uint32_t vector = none;  ///< the number of the unit vector that it is a component of
  double quotient = 0;     ///< as of Given
};

/// What is known of a value from outside, in each component.
struct Given {
  std::string name;
  double lo = 0, hi = 0;
  bool unit = false;  ///< a vector of length 1
  int element = -1;   ///< of a matrix's column: the number of its first element in the matrix
  double quotient =
      0;  ///< not 0: what is divided by a sum that begins with it is from outside too, and from 0 to this
  Answer answer = Answer::same;  ///< of what a host is asked for
};

/// A truth under which operations are looked at. 0 always holds.
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

/// What is known of an operation beside what its operands say. Other operations stand before it.
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

/// A vector that a scalar product is of, and how it was made: its length says more of its error than its components.
struct VectorShape {
  enum class Kind : uint8_t {
    given,  ///< in some other way
    sum,    ///< left + right or left - right
    cross,  ///< left x right
  };
  Kind kind{};
  uint32_t left = none, right = none;  ///< in Tape::vectors
  std::vector<uint32_t> components;    ///< operations
  uint32_t square = none;              ///< its scalar product with itself, if that stands before
  double length = HUGE_VAL;            ///< what its length is at most
};

struct Tape {
  ir::Module module;                                 ///< with bodies for all calls to functions.def
  functions::Tier tier = functions::Tier::standard;  ///< whose bodies they are
  std::vector<Operation> operations;
  std::vector<uint32_t> operands;  ///< operations
  std::vector<Input> inputs;
  std::vector<Guard> guards{{}};
  std::vector<Row> rows;
  std::vector<IrPlace> places{{}};
  std::unordered_map<uint32_t, std::vector<Fact>> facts;  ///< of operations
  std::vector<VectorShape> vectors;                       ///< of facts; what one is made of stands before it
  struct Output {
    std::string name;  ///< "out.x"
    uint32_t operation = none;
  };
  std::vector<Output> outputs;

  std::span<const uint32_t> operands_of(const Operation& operation) const {
    return {operands.data() + operation.first, operation.count};
  }
};

/// How far the length of a unit vector is from 1 at most.
inline constexpr double unit_tolerance = 0x1p-21;

/// The tape of a function. `given`: of its parameters, one each. `outside`: what a function of the module returns that the host
/// answers, one a result; nothing of one whose body tells. Of results and words that nothing is given of nothing is assumed. Nothing if it
/// would be too long.
std::optional<Tape> make_tape(const ir::Module& module, uint32_t function, const std::vector<Given>& given,
                              const std::function<std::vector<Given>(uint32_t)>& outside,
                              functions::Tier tier = functions::Tier::standard);

}  // namespace isoshade::prove
