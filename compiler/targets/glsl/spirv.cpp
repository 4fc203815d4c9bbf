// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl/spirv.h"

#include <algorithm>
#include <array>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>
#include <string_view>
#include <unordered_set>

#include "compiler/support/assert.h"
#include "compiler/support/visible.h"

namespace isoshade::glsl {

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
constexpr uint32_t op_decorate = 71, no_contraction = 42;

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
  constexpr uint32_t first_type = 19, last_type = 39;
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

EShLanguage language(ShaderKind kind) {
  switch (kind) {
    case ShaderKind::vertex: return EShLangVertex;
    case ShaderKind::fragment: return EShLangFragment;
    case ShaderKind::compute: return EShLangCompute;
  }
  support::bug("no such kind of shader");
}

/// What glslang makes of a text; else `error` tells why there is nothing.
std::optional<std::vector<uint32_t>> translate(const std::string& glsl, ShaderKind kind, const char* preamble,
                                               std::string& error) {
  static const Process process;
  const EShLanguage stage = language(kind);
  glslang::TShader shader(stage);
  const std::array texts = {glsl.data()};
  const std::array lengths = {static_cast<int>(glsl.size())};
  shader.setStringsWithLengths(texts.data(), lengths.data(), 1);
  shader.setPreamble(preamble);
  shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_1);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_3);
  if (!shader.parse(GetDefaultResources(), 450, false, messages)) {
    error = first_error(shader.getInfoLog());
    return std::nullopt;
  }
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) {
    error = first_error(program.getInfoLog());
    return std::nullopt;
  }
  std::vector<uint32_t> spirv;
  glslang::SpvOptions options;
  options.disableOptimizer = true;
  glslang::GlslangToSpv(*program.getIntermediate(stage), spirv, &options);
  return spirv;
}

void refuse(support::Diagnostics& diagnostics, const std::string& what, const std::string& reason) {
  diagnostics
      .report(support::Id::bad_shader,
              "the GLSL of " + what + " does not compile: " + support::visible(reason))
      .note(
          "isoshade made this text: unless the graph is larger than glslang takes, please report the "
          "document");
}

}  // namespace

std::string_view name(ShaderKind kind) {
  constexpr std::string_view names[] = {"vertex", "fragment", "compute"};
  return names[static_cast<size_t>(kind)];
}

std::optional<std::vector<uint32_t>> compile_spirv(const std::string& glsl, ShaderKind kind,
                                                   support::Diagnostics& diagnostics, const std::string& what,
                                                   Contract contract) {
  std::string error;
  // `precise` tells other compilers of the text what must be exact. glslang 12 follows it from each precise value back
  // along every path to where it comes from: exponential time where structs and vectors are taken apart and made anew,
  // one after another. Here no operation may be contracted at all, so it need not look.
  std::optional<std::vector<uint32_t>> spirv = translate(glsl, kind, "#define precise\n", error);
  if (spirv) {
    if (contract != Contract::free) forbid_contraction(*spirv);
    error = validate(*spirv);
  }
  if (!error.empty()) {
    refuse(diagnostics, what, error);
    return std::nullopt;
  }
  support::assert_that(contract != Contract::within || preserves_nan(*spirv),
                       "a shader without SignedZeroInfNanPreserve 32");
  return spirv;
}

std::string spirv_compiler() {
  const glslang::Version version = glslang::GetVersion();
  std::string text = "glslang";
  for (const int part : {version.major, version.minor, version.patch}) text += " " + std::to_string(part);
  return text + " " + version.flavor + "\n" + spvSoftwareVersionDetailsString() + "\n" +
         std::string(hash_of_spirv_source());
}

std::optional<size_t> count_contractible(const std::string& glsl, ShaderKind kind,
                                         support::Diagnostics& diagnostics) {
  std::string error;
  const std::optional<std::vector<uint32_t>> spirv = translate(glsl, kind, "", error);
  if (!spirv) {
    refuse(diagnostics, "a shader", error);
    return std::nullopt;
  }
  std::vector<uint32_t> computed;
  std::unordered_set<uint32_t> exact;
  for (size_t i = header_words; i < spirv->size();) {
    const Instruction instruction((*spirv)[i]);
    support::assert_that(instruction.words != 0, "glslang made SPIR-V without end");
    if (instruction.opcode == op_decorate && (*spirv)[i + 2] == no_contraction) exact.insert((*spirv)[i + 1]);
    if (is_float_arithmetic(instruction.opcode)) computed.push_back((*spirv)[i + 2]);
    i += instruction.words;
  }
  return static_cast<size_t>(
      std::ranges::count_if(computed, [&](uint32_t id) { return !exact.contains(id); }));
}

}  // namespace isoshade::glsl
