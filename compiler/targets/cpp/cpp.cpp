// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/cpp/cpp.h"

#include <algorithm>
#include <array>

#include "compiler/emit/literal.h"
#include "compiler/emit/printer.h"
#include "compiler/ir/call_graph.h"
#include "compiler/ir/expansion.h"
#include "compiler/targets/cpp/stages.h"

namespace isoshade::cpp {

using namespace emit;

namespace {

/// What a compiler makes of a program's functions.
struct Code {
  std::vector<bool>
      called;  ///< by function: in the machine's code, too. In large programs those that are not small
  uint64_t operations = 0;  ///< with those of inlined functions once for each call
};

Code code_of(const ir::Module& module, std::span<const uint32_t> entries) {
  std::vector<bool> called(module.functions.size());
  uint64_t expanded = 0;
  for (const uint32_t entry : entries) expanded += ir::expanded_operations(module, entry)[entry];
  if (expanded <= large_program) return {called, expanded};
  uint64_t sum = 0;
  std::vector<uint64_t> inlined(module.functions.size());
  const auto order = ir::callees_first(module, entries);
  for (const uint32_t f : *order) {
    const ir::Function& function = module.functions[f];
    for (const ir::Block& block : function.blocks)
      for (const ir::InstructionId id : block.instructions) {
        const ir::Instruction& made = function.instructions[id];
        const bool counts =
            ir::is_primitive(made.op) || made.op == ir::Opcode::load || made.op == ir::Opcode::call;
        inlined[f] += made.op == ir::Opcode::call && !called[made.imm] ? inlined[made.imm] : counts ? 1 : 0;
      }
    const bool is_entry = std::ranges::find(entries, f) != entries.end();
    called[f] = !is_entry && inlined[f] > most_inlined_in_large;
    if (called[f] || is_entry) sum += inlined[f];
  }
  return {called, sum};
}

class Cpp final : public Language {
 public:
  /// `is_linked`: of a pure shader, whose functions get a host instead of buffers.
  Cpp(const ir::Module& module, std::span<const uint32_t> entries, bool is_linked = false)
      : functions_(module.functions.data()), called_(code_of(module, entries).called), is_linked_(is_linked) {}

  std::string_view type(ir::Type type, bool uniform) const override {
    constexpr std::string_view one[] = {"float", "vec2<float>", "vec3<float>", "vec4<float>"};
    constexpr std::string_view lanes[] = {"F", "vec2<F>", "vec3<F>", "vec4<F>"};
    switch (type.scalar) {
      case ir::Scalar::boolean: return uniform ? "bool" : "bool_of<F>";
      case ir::Scalar::integer: return uniform ? "int" : "int_of<F>";
      case ir::Scalar::floating: break;
    }
    return uniform ? one[type.width - 1] : lanes[type.width - 1];
  }
  void local_type(std::string& out, ir::Type type, bool uniform, bool) const override {
    out.append("const ").append(this->type(type, uniform));
  }
  std::string literal(ir::Type type, uint32_t bits) const override {
    if (!type.is_float()) return bits != 0 ? "true" : "false";
    return is_finite(bits) ? decimal(bits) + "f" : "from_bits_normal(int(" + hexadecimal(bits) + "u))";
  }
  const OpText& op_text(ir::Opcode op) const override { return emit::op_text(TargetId::cpp, op); }
  void identify(std::string& out, const ir::Function& function) const override {
    out += is_linked_ ? "linked C++" : "C++";
    out += called_[static_cast<size_t>(&function - functions_)] ? " called;" : ";";
  }
  void exactly(std::string& out, const Operand& operand, bool uniform) const override {
    if (uniform || (!operand.uniform && !operand.literal))
      out += operand.text;
    else
      out.append(type(operand.type, false)).append("(").append(operand.text).append(")");
  }
  void load(std::string& out, std::string_view buffer, std::string_view index) const override {
    out.append("load(buffers.").append(buffer).append(", ").append(index).append(")");
  }
  void word_reader(std::string& out, std::string_view name, int width) const override {
    out.append("template <class Word>\nISOSHADE_INLINE auto ")
        .append(name)
        .append("(const Buffers& buffers, Word word) {\n");
    out.append("  return vec").append(std::to_string(width)).append("<float_of<Word>>(");
  }
  void end_word_reader(std::string& out) const override { out += ");\n}\n"; }
  void callee(std::string& out, const FunctionText& function, bool uniform) const override {
    out.append(function.host.empty() ? function.name : function.host).append(lanes_of(uniform));
  }
  std::string_view outside() const override { return is_linked_ ? "host" : "buffers"; }
  std::string host_function(std::string_view name) const override { return "isoshade_" + std::string(name); }
  // What holds ints is a template over them in host.h, with an alias over the float type.
  std::string host_record(std::string_view name) const override {
    return "isoshade::" + std::string(name) + (name == "ImageSize" ? "Of" : "");
  }
  std::string hidden_int(int value) const override { return std::to_string(value); }
  void local_record(std::string& out, std::string_view record, bool uniform, bool) const override {
    out.append("const ").append(record).append(lanes_of(uniform));
  }
  void parameter(std::string& out, ir::Type type, bool uniform, std::string_view name,
                 bool used) const override {
    out.append(used ? "" : "[[maybe_unused]] ").append(this->type(type, uniform)).append(" ").append(name);
  }
  void variable(std::string& out, ir::Type type, bool uniform, std::string_view name) const override {
    out.append(this->type(type, uniform)).append(" ").append(name);
  }
  std::string_view no_value() const override { return "{}"; }
  void branch_head(std::string& out, const Operand& condition, bool other) const override {
    if (!condition.uniform)
      out.append(other ? "if (!all(" : "if (any(").append(condition.text).append(")) {");
    else if (other)
      out += "else {";
    else
      out.append("if (").append(condition.text).append(") {");
  }
  void branch_value(std::string& out, const Operand& condition, std::string_view variable,
                    const Operand& value, bool uniform, bool other) const override {
    out.append(variable).append(" = ");
    other &= !condition.uniform;
    if (other) out.append("select(").append(condition.text).append(", ").append(variable).append(", ");
    exactly(out, value, uniform);
    out += other ? ");" : ";";
  }
  void record(std::string& out, std::string_view name, std::span<const RecordField> fields,
              bool uniform) const override {
    const bool is_line = fits_on_line(name, fields);
    out.append(uniform ? "struct " : "template <class F>\nstruct ")
        .append(name)
        .append(is_line ? " {" : " {\n");
    for (const RecordField& field : fields) {
      out.append(is_line ? " " : "  ")
          .append(type(field.type, uniform))
          .append(" ")
          .append(field.name)
          .append(";");
      out.append(field.comment.empty() ? "" : "  // ").append(field.comment).append(is_line ? "" : "\n");
    }
    out += is_line ? " };\n" : "};\n";
  }
  void make_record(std::string& out, std::string_view name, bool uniform,
                   const std::vector<Operand>& fields) const override {
    out.append(name).append(uniform ? "{" : "<F>{");
    for (size_t i = 0; i < fields.size(); ++i) {
      if (i != 0) out += ", ";
      // `a & b` of bool is an int, and braces do not narrow.
      const bool is_int = fields[i].type == ir::bool_type && fields[i].precedence <= Precedence::bit_and;
      if (is_int) out.append(type(fields[i].type, uniform)).append("(");
      exactly(out, fields[i], uniform);
      if (is_int) out += ")";
    }
    out += "}";
  }
  void function_head(std::string& out, const ir::Function& function, const FunctionText& text,
                     bool) const override {
    const auto index = static_cast<size_t>(&function - functions_);
    out += asks_host(text) ? "template <class F, class Host>\n" : "template <class F>\n";
    for (size_t i = 0; i < text.asks.size(); ++i)
      out.append(i == 0 ? "  requires " : " &&\n           ")
          .append("isoshade::gives::")
          .append(text.asks[i])
          .append("<Host, F>")
          .append(i + 1 == text.asks.size() ? "\n" : "");
    out += called_[index] ? "ISOSHADE_NOINLINE static " : "ISOSHADE_INLINE ";
    declaration(out, function, text);
  }
  void declaration(std::string& out, const ir::Function& function, const FunctionText& text) const override {
    if (text.result_type.empty())
      out += type(function.results[0].type, false);
    else
      out.append(text.result_type).append("<F>");
    out.append(" ").append(text.name).append("(");
    if (text.is_given_host && !text.loads) out += "[[maybe_unused]] ";
    if (text.loads || text.is_given_host) out += is_linked_ ? "const Host& host" : "const Buffers& buffers";
  }
  void group_value(std::string& out, std::string_view record, bool uniform, bool one_lane) const override {
    out.append(record).append(uniform ? "" : lanes_of(one_lane));
  }
  void group_type(std::string& out, std::string_view record, bool uniform) const override {
    out += "const ";
    group_value(out, record, uniform, false);
    out += "&";
  }
  void record_parameter(std::string& out, std::string_view record, std::string_view name, bool uniform,
                        bool used) const override {
    if (!used) out += "[[maybe_unused]] ";
    group_type(out, record, uniform);
    out.append(" ").append(name);
  }

 private:
  static std::string_view lanes_of(bool uniform) { return uniform ? "<float>" : "<F>"; }

  bool asks_host(const FunctionText& text) const { return is_linked_ && (text.loads || text.is_given_host); }

  const ir::Function* functions_;
  std::vector<bool> called_;  ///< by function
  bool is_linked_;
};

constexpr Target cpp_target{
    .id = TargetId::cpp,
    .name = "cpp",
    .doc = "C++20",
    .extension = ".h",
    .head = "",
    .has_precise = true,  // every operation is, by the flags of the compiler
    .has_storage_buffers = true,
    .keeps_calls = true,
    .rounds_division = true,
    .language = [](const ir::Module& module, uint32_t entry) -> std::unique_ptr<Language> {
      return std::make_unique<Cpp>(module, std::array{entry});
    },
    .kernel = stage,
    .kernel_extension = [](lower::Stage) -> std::string_view { return ".cpp"; },
    .binary = nullptr,
    .pure = pure,
    .forward = nullptr,
    .forward_infix = "",
};

constexpr std::string_view zero_head =
    "// The GLSL of this hides zeros from drivers, which would fold arithmetic with them.\n"
    "constexpr float ISO_ZERO = 0.0f;\n\n";

}  // namespace

const Target& target() { return cpp_target; }

std::unique_ptr<Language> linked_language(const ir::Module& module, std::span<const uint32_t> entries) {
  return std::make_unique<Cpp>(module, entries, true);
}

uint64_t operations(const ir::Module& module, uint32_t entry) {
  return code_of(module, std::array{entry}).operations;
}

std::string functions(const ir::Module& module, uint32_t entry) {
  std::vector<FunctionText> texts;
  return functions(module, entry, texts);
}

std::string functions(const ir::Module& module, uint32_t entry, std::vector<FunctionText>& texts) {
  return std::string(uses_hidden_zero(module, entry) ? zero_head : "") +
         print_functions(module, entry, Cpp(module, std::array{entry}), texts);
}

std::string buffers(const ir::Module& module) {
  std::string text = "/// The arrays that stages load from.\nstruct Buffers {\n";
  for (const ir::Buffer& buffer : module.buffers)
    text +=
        (buffer.element == ir::Scalar::floating ? "  FloatBuffer " : "  IntBuffer ") + buffer.name + ";\n";
  return text + "};\n";
}

}  // namespace isoshade::cpp
