// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/cpp.h"

#include "compiler/emit/literal.h"
#include "compiler/emit/printer.h"

namespace isoshade::emit {

namespace {

class Cpp final : public Language {
 public:
  std::string declared_type(ir::Type type, bool uniform) const override {
    return "const " + this->type(type, uniform);
  }
  std::string type(ir::Type type, bool uniform) const override {
    const std::string lane = uniform ? "float" : "F";
    switch (type.scalar) {
      case ir::Scalar::boolean: return uniform ? "bool" : "bool_of<F>";
      case ir::Scalar::integer: return uniform ? "int" : "int_of<F>";
      case ir::Scalar::floating: break;
    }
    return type.width == 1 ? lane : std::string(ir::name(type)) + "<" + lane + ">";
  }
  std::string literal(ir::Type type, uint32_t bits) const override {
    switch (type.scalar) {
      case ir::Scalar::boolean: return bits != 0 ? "true" : "false";
      case ir::Scalar::integer:
        return bits == 0x80000000u ? "(-2147483647 - 1)" : std::to_string(static_cast<int32_t>(bits));
      case ir::Scalar::floating: break;
    }
    if (is_finite(bits)) return decimal(bits) + "f";
    if (bits == 0x7f800000u) return "__builtin_inff()";
    return bits == 0xff800000u ? "(-__builtin_inff())" : "__builtin_nanf(\"\")";
  }
  std::string_view op_text(const ir::OpInfo& row) const override { return row.cpp; }
  std::string exactly(const Operand& operand, bool uniform) const override {
    if (uniform || (!operand.uniform && !operand.literal)) return std::string(operand.text);
    return type(operand.type, false) + "(" + std::string(operand.text) + ")";
  }
  // Operators broadcast what is uniform by themselves; a function's arguments are all of one type.
  std::string argument(const Operand& operand, bool uniform, std::string_view pattern) const override {
    return pattern.ends_with(')') ? exactly(operand, uniform) : std::string(operand.text);
  }
  std::string load(std::string_view buffer, std::string_view index) const override {
    return "load(buffers." + std::string(buffer) + ", " + std::string(index) + ")";
  }
  std::string callee(const FunctionText& function, bool uniform) const override {
    return function.name + (uniform ? "<float>" : "<F>");
  }
  bool passes_buffers() const override { return true; }
  std::string result_type(const ir::Function& function, const FunctionText& text,
                          bool uniform) const override {
    if (text.result_type.empty()) return type(function.results[0].type, uniform);
    return "const " + text.result_type + (uniform ? "<float>" : "<F>");
  }
  std::string parameter(ir::Type type, bool uniform, std::string_view name, bool used) const override {
    return (used ? "" : "[[maybe_unused]] ") + this->type(type, uniform) + " " + std::string(name);
  }
  std::string_view no_value() const override { return "{}"; }
  std::string variable(ir::Type type, bool uniform, std::string_view name) const override {
    return this->type(type, uniform) + " " + std::string(name);
  }
  std::string branch_head(std::string_view condition, bool other) const override {
    return (other ? "if (!all(" : "if (any(") + std::string(condition) + ")) {";
  }
  std::string branch_value(const Operand& condition, std::string_view variable, const Operand& value,
                           bool uniform, bool other) const override {
    const std::string name(variable);
    const std::string exact = exactly(value, uniform);
    return name + " = " +
           (other ? "select(" + std::string(condition.text) + ", " + name + ", " + exact + ")" : exact) + ";";
  }
  std::string record(std::string_view name, const std::vector<std::pair<ir::Type, std::string>>& fields,
                     bool uniform) const override {
    std::string text = (uniform ? "" : "template <class F>\n") + ("struct " + std::string(name)) + " {\n";
    for (const auto& [type, field] : fields) text += "  " + this->type(type, uniform) + " " + field + ";\n";
    return text + "};\n";
  }
  std::string make_record(std::string_view name, bool uniform,
                          const std::vector<std::string>& fields) const override {
    std::string list;
    for (const std::string& field : fields) list += (list.empty() ? "" : ", ") + field;
    return std::string(name) + (uniform ? "" : "<F>") + "{" + list + "}";
  }
  std::string function_head(const ir::Function& function, const FunctionText& text,
                            const std::vector<std::string>& parameters) const override {
    std::string list = text.loads ? "const Buffers& buffers" : "";
    for (const std::string& parameter : parameters) list += (list.empty() ? "" : ", ") + parameter;
    const std::string result =
        text.result_type.empty() ? type(function.results[0].type, false) : text.result_type + "<F>";
    return "template <class F>\nISOSHADE_INLINE " + result + " " + text.name + "(" + list + ")";
  }
  std::string group_type(std::string_view record, bool uniform) const override {
    return "const " + std::string(record) + (uniform ? "&" : "<F>&");
  }
};

}  // namespace

std::string cpp_functions(const ir::Module& module, uint32_t entry) {
  std::vector<FunctionText> texts;
  return print_functions(module, entry, Cpp(), texts);
}

std::string cpp_buffers(const ir::Module& module) {
  std::string text = "/// The arrays that stages load from.\nstruct Buffers {\n";
  for (const ir::Buffer& buffer : module.buffers)
    text +=
        (buffer.element == ir::Scalar::floating ? "  FloatBuffer " : "  IntBuffer ") + buffer.name + ";\n";
  return text + "};\n";
}

}  // namespace isoshade::emit
