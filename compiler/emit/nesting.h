// SPDX-License-Identifier: Apache-2.0
// Which values of a function are written where they are used, and which get a statement of their own.
#pragma once

#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::emit {

enum class Shape : uint8_t {
  plain,
  literal,    ///< a constant
  splat,      ///< one number in every component
  component,  ///< of a vector that has a name
  offset,     ///< an int plus a constant, only ever an index
  words,      ///< a vector of consecutive words of a buffer: read by one call, `objects3(object + 4)`
};

/// How one value is written. A literal, a splat, a component and an offset stand wherever they are used.
struct Nesting {
  Shape shape = Shape::plain;
  /// The value has a statement: it is an author's node, or is used more than once or in another block than its own.
  bool has_statement = true;
  bool is_used = true;  ///< otherwise it is not written at all
  /// The instruction that makes the value; none for parameters.
  ir::InstructionId made_by = ir::none;
};

/// An index as a number plus a constant.
struct Index {
  ir::ValueId base = ir::none;  ///< none: 0
  uint32_t constant = 0;
  friend bool operator==(const Index&, const Index&) = default;
};
Index split_index(const ir::Function& function, const std::vector<Nesting>& nesting, ir::ValueId index);

/// By value. Needs: a function with a body. Depends on the IR alone, so that all languages nest alike.
std::vector<Nesting> find_nesting(const ir::Function& function);

}  // namespace isoshade::emit
