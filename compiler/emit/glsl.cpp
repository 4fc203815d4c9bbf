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
  std::string_view type(ir::Type type, bool) const override { return ir::name(type); }
  // `precise` stands at every float, in every function: glslang drops it from locals that do not have their
  // own.
  std::string_view declared_type(ir::Type type, bool) const override {
    constexpr std::string_view floats[] = {"precise float", "precise vec2", "precise vec3", "precise vec4"};
    return type.is_float() ? floats[type.width - 1] : ir::name(type);
  }
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
  void exactly(std::string& out, const Operand& operand, bool) const override { out += operand.text; }
  void argument(std::string& out, const Operand& operand, bool, std::string_view) const override {
    out += operand.text;
  }
  void load(std::string& out, std::string_view buffer, std::string_view index) const override {
    out.append(buffer).append("[").append(index).append("]");
  }
  void callee(std::string& out, const FunctionText& function, bool) const override { out += function.name; }
  bool passes_buffers() const override { return false; }
  void result_record(std::string& out, std::string_view record, bool) const override { out += record; }
  void parameter(std::string& out, ir::Type type, bool, std::string_view name, bool) const override {
    out.append(ir::name(type)).append(" ").append(name);
  }
  void variable(std::string& out, ir::Type type, bool uniform, std::string_view name) const override {
    out.append(declared_type(type, uniform)).append(" ").append(name);
  }
  std::string_view no_value() const override { return ""; }
  void branch_head(std::string& out, std::string_view condition, bool other) const override {
    if (other)
      out += "else {";
    else
      out.append("if (").append(condition).append(") {");
  }
  void branch_value(std::string& out, const Operand&, std::string_view variable, const Operand& value, bool,
                    bool) const override {
    out.append(variable).append(" = ").append(value.text).append(";");
  }
  void record(std::string& out, std::string_view name,
              const std::vector<std::pair<ir::Type, std::string>>& fields, bool) const override {
    out.append("struct ").append(name).append(" {\n");
    for (const auto& [type, field] : fields)
      out.append("  ").append(ir::name(type)).append(" ").append(field).append(";\n");
    out += "};\n";
  }
  void make_record(std::string& out, std::string_view name, bool,
                   const std::vector<Operand>& fields) const override {
    out.append(name).append("(");
    for (size_t i = 0; i < fields.size(); ++i) out.append(i == 0 ? "" : ", ").append(fields[i].text);
    out += ")";
  }
  void function_head(std::string& out, const ir::Function& function,
                     const FunctionText& text) const override {
    out.append(text.result_type.empty() ? ir::name(function.results[0].type) : text.result_type);
    out.append(" ").append(text.name).append("(");
  }
  void group_value(std::string& out, std::string_view record, bool) const override { out += record; }
  void group_type(std::string& out, std::string_view record, bool) const override { out += record; }
};

constexpr std::string_view zero_head =
    "// 0.0 where a driver would fold arithmetic with a literal, by rules of its own (x * 0.0 is not always "
    "0.0).\n"
    "// With the literal in its place bits may differ in rare cases. For the same bits on every device "
    "define it as\n"
    "// something that the compiler cannot see through, which is always 0.0: a word of a storage buffer.\n"
    "#ifndef ISO_ZERO\n#define ISO_ZERO 0.0\n#endif\n\n";

}  // namespace

std::string glsl_functions(const ir::Module& module, uint32_t entry) {
  std::vector<FunctionText> texts;
  return glsl_functions(module, entry, texts);
}

std::string glsl_functions(const ir::Module& module, uint32_t entry, std::vector<FunctionText>& texts) {
  return std::string(uses_hidden_zero(module, entry) ? zero_head : "") +
         print_functions(module, entry, Glsl(), texts);
}

}  // namespace isoshade::emit
