// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/glsl.h"

#include "compiler/emit/literal.h"
#include "compiler/emit/printer.h"

namespace isoshade::emit {

namespace {

std::string hexadecimal(uint32_t bits) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text = "0x00000000";
  for (int i = 0; i < 8; ++i) text[static_cast<size_t>(9 - i)] = digits[bits >> (4 * i) & 15];
  return text;
}

class Glsl final : public Language {
 public:
  // `precise` stands at every float, in every function: glslang drops it from locals that do not have their
  // own.
  std::string declared_type(ir::Type type, bool) const override {
    return (type.is_float() ? "precise " : "") + std::string(ir::name(type));
  }
  std::string type(ir::Type type, bool) const override { return std::string(ir::name(type)); }
  std::string literal(ir::Type type, uint32_t bits) const override {
    switch (type.scalar) {
      case ir::Scalar::boolean: return bits != 0 ? "true" : "false";
      case ir::Scalar::integer:
        // A minus sign would be an operation on a literal.
        return static_cast<int32_t>(bits) >= 0 ? std::to_string(bits) : "int(" + hexadecimal(bits) + "u)";
      case ir::Scalar::floating: break;
    }
    if (!is_finite(bits) || bits == 0x80000000u) return "intBitsToFloat(int(" + hexadecimal(bits) + "u))";
    return decimal(bits);
  }
  std::string_view op_text(const ir::OpInfo& row) const override { return row.glsl; }
  std::string exactly(const Operand& operand, bool) const override { return std::string(operand.text); }
  std::string argument(const Operand& operand, bool, std::string_view) const override {
    return std::string(operand.text);
  }
  std::string load(std::string_view buffer, std::string_view index) const override {
    return std::string(buffer) + "[" + std::string(index) + "]";
  }
  std::string callee(const FunctionText& function, bool) const override { return function.name; }
  bool passes_buffers() const override { return false; }
  std::string result_type(const ir::Function& function, const FunctionText& text, bool) const override {
    return text.result_type.empty() ? std::string(ir::name(function.results[0].type)) : text.result_type;
  }
  std::string parameter(ir::Type type, bool, std::string_view name, bool) const override {
    return std::string(ir::name(type)) + " " + std::string(name);
  }
  std::string_view no_value() const override { return ""; }
  std::string variable(ir::Type type, bool uniform, std::string_view name) const override {
    return declared_type(type, uniform) + " " + std::string(name);
  }
  std::string branch_head(std::string_view condition, bool other) const override {
    return other ? "else {" : "if (" + std::string(condition) + ") {";
  }
  std::string branch_value(const Operand&, std::string_view variable, const Operand& value, bool,
                           bool) const override {
    return std::string(variable) + " = " + std::string(value.text) + ";";
  }
  std::string record(std::string_view name, const std::vector<std::pair<ir::Type, std::string>>& fields,
                     bool) const override {
    std::string text = "struct " + std::string(name) + " {\n";
    for (const auto& [type, field] : fields) text += "  " + std::string(ir::name(type)) + " " + field + ";\n";
    return text + "};\n";
  }
  std::string make_record(std::string_view name, bool,
                          const std::vector<std::string>& fields) const override {
    std::string list;
    for (const std::string& field : fields) list += (list.empty() ? "" : ", ") + field;
    return std::string(name) + "(" + list + ")";
  }
  std::string function_head(const ir::Function& function, const FunctionText& text,
                            const std::vector<std::string>& parameters) const override {
    std::string list;
    for (const std::string& parameter : parameters) list += (list.empty() ? "" : ", ") + parameter;
    return result_type(function, text, false) + " " + text.name + "(" + list + ")";
  }
  std::string group_type(std::string_view record, bool) const override { return std::string(record); }
};

}  // namespace

std::string glsl_functions(const ir::Module& module, uint32_t entry) {
  std::vector<FunctionText> texts;
  return print_functions(module, entry, Glsl(), texts);
}

}  // namespace isoshade::emit
