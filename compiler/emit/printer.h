// SPDX-License-Identifier: Apache-2.0
// One walk over the IR for both languages, so that GLSL and C++ read alike line by line: same names, same
// order, same comments. A Language says only how things are spelled.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compiler/emit/names.h"
#include "compiler/ir/module.h"

namespace isoshade::emit {

/// How one function is seen from outside.
struct FunctionText {
  std::string name;         ///< in emitted text
  std::string result_type;  ///< the name of its result struct if it has several results, else empty
  std::vector<std::string> result_fields;
  std::vector<std::string> groups;  ///< the name of the struct of each parameter; empty: a plain parameter
  std::vector<std::string> fields;  ///< the name of each parameter in its struct
  bool loads = false;               ///< it, or one it calls, loads from a buffer
};

/// How a value is written: a name and its spelling's properties.
struct Operand {
  std::string_view text;  ///< of the printer
  ir::Type type;
  bool uniform = false;  ///< one value for all lanes
  bool literal = false;
};

/// The spelling of one language. What is made of parts is appended to `out`.
class Language {
 public:
  virtual ~Language() = default;
  /// A type as it stands in a parameter list, a field or a construction: "float", "F", "vec3<F>".
  virtual std::string_view type(ir::Type type, bool uniform) const = 0;
  /// "precise float" or "const F".
  virtual std::string_view declared_type(ir::Type type, bool uniform) const = 0;
  virtual std::string literal(ir::Type type, uint32_t bits) const = 0;
  virtual std::string_view op_text(const ir::OpInfo& row) const = 0;
  /// An operand where its type must be exactly this: an arm of a select, a value that is assigned.
  virtual void exactly(std::string& out, const Operand& operand, bool uniform) const = 0;
  /// An operand of a primitive op, in its text `pattern`.
  virtual void argument(std::string& out, const Operand& operand, bool uniform,
                        std::string_view pattern) const = 0;
  virtual void load(std::string& out, std::string_view buffer, std::string_view index) const = 0;
  /// What stands before the argument list: name, and in C++ the lanes of the instance.
  virtual void callee(std::string& out, const FunctionText& function, bool uniform) const = 0;
  /// Whether functions that load are given the buffers, as their first argument.
  virtual bool passes_buffers() const = 0;
  /// The type of a call's result that is a record.
  virtual void result_record(std::string& out, std::string_view record, bool uniform) const = 0;
  virtual void parameter(std::string& out, ir::Type type, bool uniform, std::string_view name,
                         bool used) const = 0;
  /// A variable that is assigned later, and its initialiser until then.
  virtual void variable(std::string& out, ir::Type type, bool uniform, std::string_view name) const = 0;
  virtual std::string_view no_value() const = 0;
  /// The head of a block that runs where the condition holds (or where it does not), and what is assigned at
  /// its end.
  virtual void branch_head(std::string& out, std::string_view condition, bool other) const = 0;
  virtual void branch_value(std::string& out, const Operand& condition, std::string_view variable,
                            const Operand& value, bool uniform, bool other) const = 0;
  /// "struct Surface {" with fields, whole.
  virtual void record(std::string& out, std::string_view name,
                      const std::vector<std::pair<ir::Type, std::string>>& fields, bool uniform) const = 0;
  /// A value of a record whose fields are these.
  virtual void make_record(std::string& out, std::string_view name, bool uniform,
                           const std::vector<Operand>& fields) const = 0;
  /// All before the first parameter; in C++ with the buffers, if the function loads.
  virtual void function_head(std::string& out, const ir::Function& function,
                             const FunctionText& text) const = 0;
  /// The type of a local, and of a parameter, that is a whole group.
  virtual void group_value(std::string& out, std::string_view record, bool uniform) const = 0;
  virtual void group_type(std::string& out, std::string_view record, bool uniform) const = 0;
};

/// Prints the functions that `entry` needs, callees first, and the records they use. Needs: every function
/// has a body, or is one that the text's user provides (printed as a prototype). `texts` receives a
/// FunctionText for every function of the module.
std::string print_functions(const ir::Module& module, uint32_t entry, const Language& language,
                            std::vector<FunctionText>& texts);

/// The name of ir::Opcode::hidden_zero in emitted text.
inline constexpr std::string_view hidden_zero = "ISO_ZERO";

/// Whether the function or one it calls has a hidden zero.
bool uses_hidden_zero(const ir::Module& module, uint32_t entry);

}  // namespace isoshade::emit
