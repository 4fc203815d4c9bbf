// SPDX-License-Identifier: Apache-2.0
// How values become expressions or statements. Blocks, calls, branches and loops are in function_printer.cpp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/emit/nesting.h"
#include "compiler/emit/printer.h"

namespace isoshade::emit {

/// Longer expressions are divided: with a type and a name in front a line has about 100 columns.
inline constexpr int most_columns = 82;

/// How a value is written so far.
struct Written {
  std::string text;
  int columns = 0;  ///< about its length, the same in all languages
  Precedence precedence = Precedence::primary;
  bool pending = false;  ///< an expression that no statement holds yet
  bool exact = false;    ///< with arithmetic on floats that no statement holds yet
};

class ExpressionPrinter {
 protected:
  using ValueId = ir::ValueId;

  ExpressionPrinter(const ir::Function& function, const TextContext& context)
      : function_(function),
        context_(context),
        language_(context.language),
        names_(Scope::local, &context.globals, function.values.size()),
        written_(function.values.size()) {}

  std::string& indent() { return body_.append(indent_, ' '); }
  /// What stands before the next part of a list in parentheses.
  static void separate(std::string& out) {
    if (out.back() != '(') out += ", ";
  }

  // Each instruction that computes something. What is used once and is no author's node waits in written_ for its use;
  // the rest become statements.
  void print_constant(const ir::Instruction& instruction);
  void print_extract(const ir::Instruction& instruction);
  void print_construct(const ir::Instruction& instruction);
  void print_load(const ir::Instruction& instruction);
  void print_primitive(const ir::Instruction& instruction);

  /// The value as a part of an expression.
  Operand operand(ValueId value);
  /// The same where its type must be exact, for all lanes alike or for each: an argument, what a variable is given.
  void put_exactly(std::string& out, ValueId value, bool uniform);
  /// Gives what is still an expression a name and a statement.
  void need_name(ValueId value);
  /// About how long the value's text is, the same in all languages.
  int columns_of(ValueId value) const;
  /// Gives names to the longest operands until all of them and `columns` more fit on a line. Returns how long they are.
  int make_room(std::span<const ValueId> operands, int columns);
  /// Whether some value of the list has arithmetic in it that no statement holds yet.
  bool is_exact(std::span<const ValueId> values) const;
  /// An expression without text, to be finished.
  Written begin();
  /// `made` is the value's expression: a statement now, or a part of another later.
  void finish(ValueId value, Written&& made);

  /// A name that is free: the node's, or one for what the instruction computes.
  std::string name_value(ValueId value, const ir::Instruction& made);
  std::string_view noun_of(const ir::Instruction& made) const;
  void set_name(ValueId value, std::string name);
  /// The node's own words, above its statement.
  void print_doc(uint32_t origin);
  /// Behind the statement of a node that could not be called by its id stands `// length :12`.
  void end_line(ValueId value);

  const ir::Function& function_;
  const TextContext& context_;
  const Language& language_;
  Names names_;
  std::vector<Written> written_;  ///< by value
  std::vector<Nesting> nesting_;  ///< by value
  std::vector<bool> uniform_;     ///< by value
  std::string body_;              ///< the statements
  size_t indent_ = 0;

 private:
  /// The instruction that makes a value; null for parameters.
  const ir::Instruction* definition(ValueId value) const;
  bool is_splat(ValueId value) const;
  ValueId splat_of(ValueId value) const;
  /// The value whose text stands for `value`: a splat is written by its number.
  ValueId behind(ValueId value) const;
  void write_splat(ValueId value, bool uniform);
  void put(std::string& out, const Operand& operand, const Room& room);
  /// The memory of the text of an operand, which is a part of another text now. Nothing else reads it.
  void give_back(ValueId value);
  void state(ValueId value, Written&& made);
  /// The vector all of whose components come first, in order: `vec4(color, 1.0)`.
  std::optional<ValueId> leading_vector(std::span<const ValueId> operands) const;
  /// `objects3(object + 4)`.
  void print_words(const ir::Instruction& instruction);
  /// An index of a buffer, with the name of the record's word if it has one. `columns` are around it.
  std::string print_index(uint32_t buffer, const Index& index, int columns, int& all_columns);
  /// An op whose text is a statement in some language.
  void print_statement(const ir::Instruction& instruction);
  void fill(std::string& out, const ir::Instruction& instruction, const OpText& text);
  std::string_view temporary(std::string_view suffix) const;

  /// The last statement that may take another of its type, where it ends in body_, and about how long its line is.
  struct Declared {
    ir::Type type;
    bool uniform = false, exact = false;
    friend bool operator==(const Declared&, const Declared&) = default;
  };
  Declared declared_;
  std::string spare_;  ///< the memory of a text that is in a statement, for the next one
  size_t declared_end_ = 0;
  int declared_columns_ = 0;
  std::vector<std::pair<std::string_view, std::string>>
      temporaries_;  ///< of the op that is printed, by suffix
};

}  // namespace isoshade::emit
