// SPDX-License-Identifier: Apache-2.0
// One walk over the IR for all text languages, so that they read alike line by line: same names, same order, same
// comments, same nesting. A Language says only how things are spelled.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/emit/names.h"
#include "compiler/emit/op_text.h"
#include "compiler/ir/module.h"

namespace isoshade::emit {

/// How a parameter of a pure shader's function is written where its function's signature does not declare it.
struct ParameterText {
  std::string text;      ///< an expression: "surface.normal"
  bool is_call = false;  ///< a local of the parameter's name holds what the expression gives
};

/// How one function is seen from outside.
struct FunctionText {
  std::string name;         ///< in emitted text
  std::string result_type;  ///< the name of its result struct if it has several results, else empty
  std::vector<std::string> result_fields;
  std::vector<std::string> groups;  ///< the name of the struct of each parameter; empty: a plain parameter
  std::vector<std::string> fields;  ///< the name of each parameter in its struct
  bool loads = false;               ///< it, or one it calls, loads from a buffer or asks the host
  bool is_given_host = false;       ///< it takes the host, even if it does not ask it
  // Of a pure shader (pure.h):
  std::string noun;       ///< what its result is called; empty: as the function
  std::string host;       ///< the host's function that stands for it; empty: it is printed
  std::string leading;    ///< what a call's arguments begin with
  std::vector<std::string_view> asks;  ///< of an entry: the functions of the host that it needs ("light_count")
  bool has_signature = false;  ///< the parameter list is `signature`; each parameter is written as `parameters` say
  std::string signature;
  std::vector<ParameterText> parameters;
  std::vector<std::string> local_names;  ///< what the signature declares
};

/// A value as it is written: an expression and what decides how it fits into another.
struct Operand {
  std::string_view text;  ///< of the printer
  ir::Type type;
  Precedence precedence = Precedence::primary;
  bool uniform = false;  ///< one value for all lanes
  bool literal = false;
};

/// A field of a record, and the comment behind it.
struct RecordField {
  ir::Type type;
  std::string name;
  std::string comment = {};
};

/// What is known of a parameter: its own words, and its range.
std::string comment_of(const ir::Parameter& parameter);

/// Whether a record is short enough for one line, the same in all languages.
bool fits_on_line(std::string_view name, std::span<const RecordField> fields);

/// The spelling of one language. What is made of parts is appended to `out`. `exact`: arithmetic on floats stands in
/// what the declaration is given, and must be done as written.
class Language {
 public:
  virtual ~Language() = default;
  /// A type as it stands in a parameter list, a field or a construction: "float", "F", "vec3<F>".
  virtual std::string_view type(ir::Type type, bool uniform) const = 0;
  /// Begins the definition of a local: "precise float", "const F".
  virtual void local_type(std::string& out, ir::Type type, bool uniform, bool exact) const = 0;
  /// A float or a bool; ints are written alike everywhere (literal.h).
  virtual std::string literal(ir::Type type, uint32_t bits) const = 0;
  virtual const OpText& op_text(ir::Opcode op) const = 0;
  /// What tells texts apart that are made of equal functions: the language, and what it knows of this one besides.
  virtual void identify(std::string& out, const ir::Function& function) const = 0;
  /// An operand where its type must be exactly this: an arm of a select, a value that is assigned.
  virtual void exactly(std::string& out, const Operand& operand, bool uniform) const = 0;
  virtual void load(std::string& out, std::string_view buffer, std::string_view index) const = 0;
  /// A function of WordReaders up to the words that it reads, and behind them.
  virtual void word_reader(std::string& out, std::string_view name, int width) const = 0;
  virtual void end_word_reader(std::string& out) const = 0;
  /// What stands before the argument list: name, and in C++ the lanes of the instance; or the host's function.
  virtual void callee(std::string& out, const FunctionText& function, bool uniform) const = 0;
  /// The first argument of functions that load or ask the host; empty if there is none.
  virtual std::string_view outside() const = 0;
  /// A function of the host without what it is called on: "isoshade_time", "host.time"; and a struct that one returns.
  virtual std::string host_function(std::string_view name) const = 0;
  virtual std::string host_record(std::string_view name) const = 0;
  /// A number of which compilers must not know what it is.
  virtual std::string hidden_int(int value) const = 0;
  /// Begins the definition of a local that is a record: the result of a call.
  virtual void local_record(std::string& out, std::string_view record, bool uniform, bool exact) const = 0;
  virtual void parameter(std::string& out, ir::Type type, bool uniform, std::string_view name,
                         bool used) const = 0;
  /// A variable that is assigned later, and its initialiser until then.
  virtual void variable(std::string& out, ir::Type type, bool uniform, std::string_view name) const = 0;
  virtual std::string_view no_value() const = 0;
  /// The head of a block that runs where the condition holds (or where it does not), and what is assigned at
  /// its end. The condition is a name.
  virtual void branch_head(std::string& out, const Operand& condition, bool other) const = 0;
  virtual void branch_value(std::string& out, const Operand& condition, std::string_view variable,
                            const Operand& value, bool uniform, bool other) const = 0;
  /// "struct Surface {" with fields, whole.
  virtual void record(std::string& out, std::string_view name, std::span<const RecordField> fields,
                      bool uniform) const = 0;
  /// A value of a record whose fields are these.
  virtual void make_record(std::string& out, std::string_view name, bool uniform,
                           const std::vector<Operand>& fields) const = 0;
  /// All before the first parameter; in C++ with the buffers, if the function loads.
  virtual void function_head(std::string& out, const ir::Function& function, const FunctionText& text,
                             bool exact) const = 0;
  /// The same as a reader needs it: result, name, and what stands before the first parameter.
  virtual void declaration(std::string& out, const ir::Function& function, const FunctionText& text) const = 0;
  /// The type of a local, and of a parameter, that is a whole group. `uniform`: the group's parameters are; `one_lane`: the
  /// local is an argument of a function's instance for one value.
  virtual void group_value(std::string& out, std::string_view record, bool uniform, bool one_lane) const = 0;
  virtual void group_type(std::string& out, std::string_view record, bool uniform) const = 0;
  /// A parameter that is a whole record.
  virtual void record_parameter(std::string& out, std::string_view record, std::string_view name, bool uniform,
                                bool used) const = 0;
};

/// Named constants for the words of a buffer's records: `objects[object + roughness]`.
class RecordWords {
 public:
  RecordWords(const ir::Buffer& buffer, Names& globals);

  /// The name of the field that has this word, which the text then declares; null: none has. `rest` receives the word's
  /// place in the field.
  const std::string* take(uint32_t word, uint32_t& rest);
  /// "roughness = 54" for each name that was taken.
  std::vector<std::string> taken() const;
  bool empty() const { return names_.empty(); }
  const std::vector<std::string>& names() const { return names_; }

  /// As if none had been taken yet; returns which were. take_again() adds them.
  std::vector<bool> forget() { return std::exchange(taken_, std::vector<bool>(taken_.size())); }
  void take_again(const std::vector<bool>& fields);

 private:
  const ir::Buffer& buffer_;
  std::vector<std::string> names_;  ///< of the fields
  std::vector<bool> taken_;
  std::vector<uint32_t> field_of_word_;
};

/// Functions that read a vector from consecutive words of a buffer: `vec3 objects3(int word)`.
class WordReaders {
 public:
  WordReaders(const ir::Buffer& buffer, Names& globals);

  /// The name of the one for vectors of `width`, which the text then defines.
  const std::string& take(size_t width);
  const std::array<std::string, 3>& names() const { return names_; }

  /// As those of RecordWords.
  std::array<bool, 3> forget() { return std::exchange(taken_, {}); }
  void take_again(const std::array<bool, 3>& widths);

  void define(std::string& out, const Language& language) const;

 private:
  const ir::Buffer& buffer_;
  std::array<std::string, 3> names_;  ///< by width - 2
  std::array<bool, 3> taken_{};
};

/// What was taken of a buffer's RecordWords and WordReaders.
struct TakenWords {
  std::vector<bool> fields;
  std::array<bool, 3> widths;
};

/// What the functions of one text share.
struct TextContext {
  const ir::Module& module;
  const Language& language;
  const std::vector<FunctionText>& texts;  ///< by function
  const Names& globals;
  std::vector<RecordWords>& records;  ///< by buffer
  std::vector<WordReaders>& readers;  ///< by buffer
};

/// Prints the functions that `entry` needs, callees first, and the records they use. Needs: every function has a body, or
/// is one that the text's user provides (printed as a prototype). `texts` receives a FunctionText for every function of
/// the module.
std::string print_functions(const ir::Module& module, uint32_t entry, const Language& language,
                            std::vector<FunctionText>& texts);

/// Tells texts apart: FNV-1a, without the sign bit.
uint32_t hash_of(std::string_view text);

/// The functions of a pure shader.
struct LinkedText {
  std::string shared;  ///< functions of the library, each in a guard of its own
  std::string own;
};
/// What all names begin with that are not of the library ("cook_torrance_"), and what those of the library end with.
struct LinkedNames {
  std::string prefix;
  std::string tier;
  std::vector<std::string> records;  ///< that the text has besides
};
/// The same for a text that is linked into other programs. `texts` has a FunctionText for every function of the module, in
/// which those of the host and the signatures of entries are set.
LinkedText print_linked(const ir::Module& module, std::span<const uint32_t> entries, const Language& language,
                        const LinkedNames& names, std::vector<FunctionText>& texts);

/// The name of ir::Opcode::hidden_zero in emitted text.
inline constexpr std::string_view hidden_zero = "ISO_ZERO";

/// Whether the function or one it calls has a hidden zero.
bool uses_hidden_zero(const ir::Module& module, uint32_t entry);

}  // namespace isoshade::emit
