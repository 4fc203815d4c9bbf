// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/spirv.h"

#include <array>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>
#include <string_view>

#include "compiler/support/check.h"

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

/// Whether the module has OpExecutionMode ... SignedZeroInfNanPreserve 32.
bool preserves_nan(const std::vector<uint32_t>& spirv) {
  constexpr size_t header_words = 5;
  constexpr uint32_t op_execution_mode = 16, op_function = 54, signed_zero_inf_nan_preserve = 4461;
  for (size_t i = header_words; i < spirv.size();) {
    const uint32_t op = spirv[i] & 0xffff, words = spirv[i] >> 16;
    if (op == op_execution_mode && words == 4 && spirv[i + 2] == signed_zero_inf_nan_preserve)
      return spirv[i + 3] == 32;
    if (op == op_function || words == 0) break;
    i += words;
  }
  return false;
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
                                                   support::Diagnostics& diagnostics) {
  static const Process process;
  const auto refuse = [&](std::string message) {
    diagnostics.report(support::Id::bad_shader, std::move(message));
    return std::nullopt;
  };

  const EShLanguage stage = kind == ShaderKind::vertex ? EShLangVertex : EShLangFragment;
  glslang::TShader shader(stage);
  const std::array texts = {glsl.data()};
  const std::array lengths = {static_cast<int>(glsl.size())};
  shader.setStringsWithLengths(texts.data(), lengths.data(), 1);
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
  if (const std::string wrong = validate(spirv); !wrong.empty()) return refuse(wrong);
  support::check(preserves_nan(spirv), "a shader without SignedZeroInfNanPreserve 32");
  return spirv;
}

}  // namespace isoshade::emit
