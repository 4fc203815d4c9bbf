// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl/glsl.h"

#include "compiler/emit/literal.h"
#include "compiler/emit/printer.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::glsl {

using namespace emit;

namespace {

class Glsl final : public Language {
 public:
  explicit Glsl(const Dialect& dialect)
      : target_(dialect.target), precise_(dialect.has_precise ? "precise " : "") {}

  std::string_view type(ir::Type type, bool) const override { return ir::name(type); }
  // `precise` reaches all that is nested in what the declaration is given, but not other functions, and of what is not
  // float only what is declared so: an index or a condition whose arithmetic has no name would be lost.
  void local_type(std::string& out, ir::Type type, bool, bool exact) const override {
    out.append(exact || type.is_float() ? precise_ : "").append(ir::name(type));
  }
  std::string literal(ir::Type type, uint32_t bits) const override {
    if (!type.is_float()) return bits != 0 ? "true" : "false";
    if (!is_finite(bits) || bits == 0x80000000u) return "intBitsToFloat(int(" + hexadecimal(bits) + "u))";
    return decimal(bits);
  }
  const OpText& op_text(ir::Opcode op) const override { return emit::op_text(target_, op); }
  void identify(std::string& out, const ir::Function&) const override {
    out.append({static_cast<char>(target_), precise_.empty() ? '-' : 'p', ';'});
  }
  void exactly(std::string& out, const Operand& operand, bool) const override { out += operand.text; }
  void load(std::string& out, std::string_view buffer, std::string_view index) const override {
    out.append(buffer).append("[").append(index).append("]");
  }
  void word_reader(std::string& out, std::string_view name, int width) const override {
    const std::string_view type = ir::name(ir::vector_type(width));
    out.append(type).append(" ").append(name).append("(int word) { return ").append(type).append("(");
  }
  void end_word_reader(std::string& out) const override { out += "); }\n"; }
  void callee(std::string& out, const FunctionText& function, bool) const override {
    out += function.host.empty() ? function.name : function.host;
  }
  std::string_view outside() const override { return ""; }
  std::string host_function(std::string_view name) const override { return "isoshade_" + std::string(name); }
  std::string host_record(std::string_view name) const override { return "isoshade_" + std::string(name); }
  std::string hidden_int(int value) const override {
    return std::to_string(value) + " | floatBitsToInt(" + std::string(hidden_zero) + ")";
  }
  void local_record(std::string& out, std::string_view record, bool, bool exact) const override {
    out.append(exact ? precise_ : "").append(record);
  }
  void parameter(std::string& out, ir::Type type, bool, std::string_view name, bool) const override {
    out.append(ir::name(type)).append(" ").append(name);
  }
  void variable(std::string& out, ir::Type type, bool uniform, std::string_view name) const override {
    local_type(out, type, uniform, false);
    out.append(" ").append(name);
  }
  std::string_view no_value() const override { return ""; }
  void branch_head(std::string& out, const Operand& condition, bool other) const override {
    if (other)
      out += "else {";
    else
      out.append("if (").append(condition.text).append(") {");
  }
  void branch_value(std::string& out, const Operand&, std::string_view variable, const Operand& value, bool,
                    bool) const override {
    out.append(variable).append(" = ").append(value.text).append(";");
  }
  void record(std::string& out, std::string_view name, std::span<const RecordField> fields,
              bool) const override {
    const bool is_line = fits_on_line(name, fields);
    out.append("struct ").append(name).append(is_line ? " {" : " {\n");
    for (const RecordField& field : fields) {
      out.append(is_line ? " " : "  ")
          .append(ir::name(field.type))
          .append(" ")
          .append(field.name)
          .append(";");
      out.append(field.comment.empty() ? "" : "  // ").append(field.comment).append(is_line ? "" : "\n");
    }
    out += is_line ? " };\n" : "};\n";
  }
  void make_record(std::string& out, std::string_view name, bool,
                   const std::vector<Operand>& fields) const override {
    out.append(name).append("(");
    for (size_t i = 0; i < fields.size(); ++i) out.append(i == 0 ? "" : ", ").append(fields[i].text);
    out += ")";
  }
  void function_head(std::string& out, const ir::Function& function, const FunctionText& text,
                     bool exact) const override {
    out.append(exact ? precise_ : "");
    declaration(out, function, text);
  }
  void declaration(std::string& out, const ir::Function& function, const FunctionText& text) const override {
    out.append(text.result_type.empty() ? ir::name(function.results[0].type) : text.result_type);
    out.append(" ").append(text.name).append("(");
  }
  void group_value(std::string& out, std::string_view record, bool, bool) const override { out += record; }
  void group_type(std::string& out, std::string_view record, bool) const override { out += record; }
  void record_parameter(std::string& out, std::string_view record, std::string_view name, bool,
                        bool) const override {
    out.append(record).append(" ").append(name);
  }

 private:
  TargetId target_;
  std::string_view precise_;  ///< with a space behind it, or nothing
};

constexpr Dialect vulkan{TargetId::glsl, true};

std::optional<std::string> bytes_of(const std::optional<std::vector<uint32_t>>& words) {
  if (!words) return std::nullopt;
  return std::string(reinterpret_cast<const char*>(words->data()), 4 * words->size());
}

std::optional<std::string> compile_kernel(const std::string& text, lower::Stage stage,
                                          support::Diagnostics& diagnostics, const std::string& what) {
  const auto kind = stage == lower::Stage::vertex ? ShaderKind::vertex : ShaderKind::fragment;
  return bytes_of(compile_spirv(text, kind, diagnostics, what));
}

std::optional<ForwardText> compile_pair(const ForwardText& pair, support::Diagnostics& diagnostics,
                                        const std::string& what) {
  auto vertex = bytes_of(
      compile_spirv(pair.vertex, ShaderKind::vertex, diagnostics, "the vertex shader of " + what, Contract::outside));
  auto fragment = bytes_of(compile_spirv(pair.fragment, ShaderKind::fragment, diagnostics,
                                         "the fragment shader of " + what, Contract::outside));
  if (!vertex || !fragment) return std::nullopt;
  return ForwardText{*std::move(vertex), *std::move(fragment)};
}

constexpr Binary spirv{"spirv", "SPIR-V of the GLSL, with a wrapper", ".spv", compile_kernel, compile_pair};

constexpr Target glsl_target{
    .id = TargetId::glsl,
    .name = "glsl",
    .doc = "GLSL 4.50 for Vulkan",
    .extension = ".glsl",
    .head =
        "// The same bits on every device that isoshade's probe passes, given these two lines behind #version, without which\n"
        "// some devices let a select swallow a NaN:\n"
        "//   #extension GL_EXT_spirv_intrinsics : require\n"
        "//   spirv_execution_mode(extensions = [\"SPV_KHR_float_controls\"], capabilities = [4466], 4461, 32);\n",
    .has_precise = vulkan.has_precise,
    .has_storage_buffers = true,
    .keeps_calls = false,
    .rounds_division = false,
    .language = [](const ir::Module&, uint32_t) { return language(vulkan); },
    .kernel = [](const ir::Module& module, uint32_t entry, lower::Stage stage,
                 const Heading& heading) { return glsl::stage(module, entry, stage, heading); },
    .kernel_extension = [](lower::Stage stage) -> std::string_view {
      return stage == lower::Stage::vertex ? ".vert" : ".frag";
    },
    .binary = &spirv,
    .pure = [](const PureShader& shader) { return pure(shader, vulkan, target().head); },
    .forward = [](const ForwardProgram& program) { return forward(program, vulkan); },
    .forward_infix = "",
};

}  // namespace

std::unique_ptr<Language> language(const Dialect& dialect) { return std::make_unique<Glsl>(dialect); }

const Target& target() { return glsl_target; }

std::string functions(const ir::Module& module, uint32_t entry) {
  std::vector<FunctionText> texts;
  return std::string(uses_hidden_zero(module, entry) ? hidden_zero_head : "") + functions(module, entry, texts);
}

std::string functions(const ir::Module& module, uint32_t entry, std::vector<FunctionText>& texts) {
  return print_functions(module, entry, Glsl(vulkan), texts);
}

}  // namespace isoshade::glsl
