// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/spirv.h"

#include <array>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>
#include <string_view>

#include "compiler/support/assert.h"
#include "compiler/support/visible.h"

namespace isoshade::emit {

namespace {

constexpr auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);

/// glslang's tables, made once and shared by all threads.
struct Process {
  Process() { glslang::InitializeProcess(); }
  ~Process() { glslang::FinalizeProcess(); }
};

/// Log texts name every error on a line; the first is the one that counts.
std::string first_error(std::string_view log) {
  size_t begin = log.find("ERROR: ");
  if (begin == std::string_view::npos) begin = 0;
  return std::string(log.substr(begin, log.find('\n', begin) - begin));
}

constexpr size_t header_words = 5;

/// The opcode of an instruction and how many words it has, by its first word.
struct Instruction {
  uint32_t opcode, words;
  explicit Instruction(uint32_t word) : opcode(word & 0xffff), words(word >> 16) {}
};

/// Whether the module has OpExecutionMode ... SignedZeroInfNanPreserve 32.
bool preserves_nan(const std::vector<uint32_t>& spirv) {
  constexpr uint32_t op_execution_mode = 16, op_function = 54, signed_zero_inf_nan_preserve = 4461;
  for (size_t i = header_words; i < spirv.size();) {
    const Instruction instruction(spirv[i]);
    if (instruction.opcode == op_execution_mode && instruction.words == 4 &&
        spirv[i + 2] == signed_zero_inf_nan_preserve)
      return spirv[i + 3] == 32;
    if (instruction.opcode == op_function || instruction.words == 0) break;
    i += instruction.words;
  }
  return false;
}

/// Whether NoContraction means something for an instruction: it computes with floats.
bool is_float_arithmetic(uint32_t opcode) {
  constexpr uint32_t negate = 127, add = 129, subtract = 131, multiply = 133, divide = 136, remainder = 140,
                     outer_product_and_dot = 148;  // from `remainder` on all
  return opcode == negate || opcode == add || opcode == subtract || opcode == multiply || opcode == divide ||
         (opcode >= remainder && opcode <= outer_product_and_dot);
}

/// Decorates every operation on floats with NoContraction. Decorations stand before the first type.
void forbid_contraction(std::vector<uint32_t>& spirv) {
  constexpr uint32_t op_decorate = 71, no_contraction = 42, first_type = 19, last_type = 39;
  size_t types = 0;
  std::vector<uint32_t> decorations;
  for (size_t i = header_words; i < spirv.size();) {
    const Instruction instruction(spirv[i]);
    support::assert_that(instruction.words != 0, "glslang made SPIR-V without end");
    if (types == 0 && instruction.opcode >= first_type && instruction.opcode <= last_type) types = i;
    if (is_float_arithmetic(instruction.opcode))
      decorations.insert(decorations.end(), {3u << 16 | op_decorate, spirv[i + 2], no_contraction});
    i += instruction.words;
  }
  spirv.insert(spirv.begin() + static_cast<ptrdiff_t>(types), decorations.begin(), decorations.end());
}

/// Empty where the module is valid, else what is wrong with it.
std::string validate(const std::vector<uint32_t>& spirv) {
  std::string message;
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_1);
  tools.SetMessageConsumer(
      [&message](spv_message_level_t, const char*, const spv_position_t&, const char* text) {
        if (message.empty()) message = text;
      });
  return tools.Validate(spirv) ? "" : "invalid SPIR-V: " + message;
}

}  // namespace

std::optional<std::vector<uint32_t>> compile_spirv(const std::string& glsl, ShaderKind kind,
                                                   support::Diagnostics& diagnostics,
                                                   const std::string& what) {
  static const Process process;
  const auto refuse = [&](const std::string& reason) {
    diagnostics
        .report(support::Id::bad_shader,
                "the GLSL of " + what + " does not compile: " + support::visible(reason))
        .note(
            "isoshade made this text: unless the graph is larger than glslang takes, please report the "
            "document");
    return std::nullopt;
  };

  const EShLanguage stage = kind == ShaderKind::vertex ? EShLangVertex : EShLangFragment;
  glslang::TShader shader(stage);
  const std::array texts = {glsl.data()};
  const std::array lengths = {static_cast<int>(glsl.size())};
  shader.setStringsWithLengths(texts.data(), lengths.data(), 1);
  // `precise` tells other compilers of the text what must be exact. glslang 12 follows it from each precise value back
  // along every path to where it comes from: exponential time where structs and vectors are taken apart and made anew,
  // one after another. Here no operation may be contracted at all, so it need not look.
  shader.setPreamble("#define precise\n");
  shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_1);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_3);
  if (!shader.parse(GetDefaultResources(), 450, false, messages))
    return refuse(first_error(shader.getInfoLog()));

  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) return refuse(first_error(program.getInfoLog()));

  std::vector<uint32_t> spirv;
  glslang::SpvOptions options;
  options.disableOptimizer = true;
  glslang::GlslangToSpv(*program.getIntermediate(stage), spirv, &options);
  forbid_contraction(spirv);
  if (const std::string wrong = validate(spirv); !wrong.empty()) return refuse(wrong);
  support::assert_that(preserves_nan(spirv), "a shader without SignedZeroInfNanPreserve 32");
  return spirv;
}

}  // namespace isoshade::emit
