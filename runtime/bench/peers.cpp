// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/peers.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "backends/cache.h"
#include "backends/shared.h"
#include "compiler/support/temporary.h"
#include "compiler/targets/glsl/spirv.h"
#include "runtime/bench/ports.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::bench {

namespace {

/// What somebody writes with GLM who has the textbook before him. Functions have the names and results of ours.
struct GlmText {
  std::string_view effect, text;
};
constexpr GlmText glm_texts[] = {
    {"cook_torrance", R"(struct Result { vec3 specular, fresnel; };
inline Result cook_torrance(vec3 normal, vec3 light, vec3 view, float alpha, vec3 f0) {
  const vec3 half_vector = normalize(light + view);
  const float n_dot_l = dot(normal, light), n_dot_v = dot(normal, view);
  const float n_dot_h = dot(normal, half_vector), v_dot_h = dot(view, half_vector);
  const float alpha2 = alpha * alpha, t = n_dot_h * n_dot_h * (alpha2 - 1.0f) + 1.0f;
  const float d = alpha2 / (3.14159265f * t * t);
  const float x = 1.0f - v_dot_h, x2 = x * x;
  const vec3 fresnel = f0 + (1.0f - f0) * (x2 * x2 * x);
  const float g = min(1.0f, min(2.0f * n_dot_h * n_dot_v / v_dot_h, 2.0f * n_dot_h * n_dot_l / v_dot_h));
  if (n_dot_l <= 0.0f || n_dot_v <= 0.0f) return {vec3(0.0f), fresnel};
  return {fresnel * (d * g / (4.0f * n_dot_l * n_dot_v)), fresnel};
}
)"},
    {"toon_highlight", R"(inline float highlight(float spec, float scale, float width, float least_scale) {
  return smoothstep(-width, width, spec + scale - 1.0f) * step(least_scale, scale);
}
)"},
    {"fog", R"(inline float height_density(float camera_height, float distance, float ray_height, float begin, float end,
                            float density) {
  const float height = camera_height + distance * ray_height;
  return clamp((end - height) / (end - begin) * density, 0.0f, 1.0f);
}
)"},
};

const GlmText* glm_text_of(std::string_view effect) {
  const auto found = std::ranges::find(glm_texts, effect, &GlmText::effect);
  return found != std::end(glm_texts) ? found : nullptr;
}

/// What stands in the C++ of SPIRV-Cross before `eval`: structs and functions.
std::optional<std::string> functions_of(const std::string& cpp) {
  const size_t shader = cpp.find("struct Shader\n"), structs = cpp.find('{', shader) + 1;
  const size_t resources = cpp.find("struct Resources", structs), pointer = cpp.find("Resources* __res;", structs);
  const size_t kernel = cpp.find(" eval(const int", pointer);
  if (shader == cpp.npos || resources == cpp.npos || pointer == cpp.npos || kernel == cpp.npos) return std::nullopt;
  const size_t functions = pointer + std::string_view("Resources* __res;").size();
  std::string text = "struct Shader {\n" + cpp.substr(structs, resources - structs) +
                     cpp.substr(functions, cpp.rfind('\n', kernel) - functions) + "\n};\n";
  // "_267.iso_zero": a word of a buffer, which is always 0.
  constexpr std::string_view zero = ".iso_zero";
  for (size_t at = 0; (at = text.find(zero, at)) != text.npos;) {
    size_t begin = at;
    while (begin > 0 && (std::isalnum(static_cast<unsigned char>(text[begin - 1])) || text[begin - 1] == '_')) --begin;
    text.replace(begin, at + zero.size() - begin, "0.0f");
    at = begin;
  }
  return text;
}

/// The functions of the program as SPIRV-Cross writes them.
std::optional<std::string> spirv_cross_text(const driver::Program& table, const std::string& folder,
                                            support::Seconds limit, std::string& why) {
  const std::string tool = support::find_program("spirv-cross");
  if (tool.empty()) {
    why = "there is no spirv-cross (Debian: package spirv-cross)";
    return std::nullopt;
  }
  support::Diagnostics ignored;
  const auto words = glsl::compile_spirv(driver::glsl(table, driver::Division::native), glsl::ShaderKind::fragment, ignored);
  const std::string module = folder + "/table.spv";
  if (!words || !backends::write_file(module, {reinterpret_cast<const char*>(words->data()), words->size() * 4}, ignored))
    return std::nullopt;
  const auto end = support::run_process({tool, "--cpp", module}, {}, limit);
  auto functions = end && !end->late && end->status == 0 ? functions_of(end->output) : std::nullopt;
  if (!functions) why = "spirv-cross --cpp does not translate " + table.name;
  return functions;
}

/// Pieces of a text between ", ", outside of brackets of types.
std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts(1);
  for (size_t i = 0; i < list.size(); ++i) {
    if (list[i] == ',') {
      parts.emplace_back();
      ++i;  // the blank
    } else {
      parts.back() += list[i];
    }
  }
  return parts;
}

/// Our C++ with a body of `function` that calls the peer's function.
std::optional<std::string> with_peer(std::string cpp, const driver::Program& program, const std::string& function,
                                     const std::string& peer, const std::string& peer_function) {
  const size_t name_at = cpp.find(" " + function + "(vec") != cpp.npos ? cpp.find(" " + function + "(vec") : cpp.find(" " + function + "(F ");
  if (name_at == cpp.npos) return std::nullopt;
  const size_t line = cpp.rfind('\n', name_at) + 1, open = cpp.find('(', name_at), close = cpp.find(") {", open);
  const std::string_view inline_word = "ISOSHADE_INLINE ";
  if (cpp.compare(line, inline_word.size(), inline_word) != 0 || close == cpp.npos) return std::nullopt;
  const std::string result = cpp.substr(line + inline_word.size(), name_at - line - inline_word.size());
  std::string call = peer_function + "(";
  for (const std::string& parameter : split(cpp.substr(open + 1, close - open - 1))) {
    const std::string name = parameter.substr(parameter.rfind(' ') + 1);
    if (call.back() != '(') call += ", ";
    call += parameter.starts_with("vec3<") ? "glm::vec3(" + name + ".x, " + name + ".y, " + name + ".z)" : name;
  }
  call += ")";
  std::string body = " {\n  const auto peer = " + call + ";\n  return " + result + "{";
  const ir::Module& module = program.module;
  const uint32_t index = module.find(function);
  if (index == ir::none) return std::nullopt;
  const std::vector<ir::Result>& results = module.functions[index].results;
  for (const ir::Result& r : results) {
    const std::string value = results.size() == 1 ? "peer" : "peer." + r.name;
    body += (&r == results.data() ? "" : ", ") +
            (r.type.width == 3 ? "vec3<F>(" + value + ".x, " + value + ".y, " + value + ".z)" : value);
  }
  body += "};\n}\n";
  const size_t line_end = cpp.find('\n', close);
  const bool is_line = cpp[line_end - 1] == '}';
  const size_t end = is_line ? line_end + 1 : cpp.find("\n}\n", close) + 3;
  cpp.replace(close + 1, end - close - 1, body);
  return "#include <glm/glm.hpp>\n#include <cstdint>\n\nnamespace peer {\nusing namespace glm;\n" + peer + "}\n\n" + cpp;
}

}  // namespace

bool has_peer(PeerKind kind, const Subject& subject) {
  if (subject.form != "library" || glm_text_of(subject.effect) == nullptr) return false;
  switch (kind) {
    case PeerKind::glm:
    case PeerKind::spirv_cross: return true;
  }
  return false;
}

std::unique_ptr<PeerProgram> PeerProgram::make(PeerKind kind, const Subject& subject, const driver::Program& program,
                                               const driver::Program& table, const std::string& function,
                                               const std::string& compiler, support::Seconds limit, std::string& why) {
  support::Diagnostics ignored;
  why = "it does not compile";
  const auto folder = support::TemporaryFolder::make(support::temporary_parent());
  const auto found = cpu::Compiler::find(compiler, ignored, limit);
  if (!folder || !found || !write_lanes_headers(folder->path(), true)) return nullptr;
  const bool is_glm = kind == PeerKind::glm;
  const auto peer = is_glm ? std::optional<std::string>(glm_text_of(subject.effect)->text)
                           : spirv_cross_text(table, folder->path(), limit, why);
  if (!peer) return nullptr;
  const auto text = with_peer(driver::cpp(program), program, function, *peer,
                              (is_glm ? "::peer::" : "::peer::Shader().") + function);
  const std::string source = folder->path() + "/program.cpp", object = folder->path() + "/program.so";
  if (!text || !backends::write_file(source, *text, ignored)) return nullptr;
  const auto compiled = support::run_process({found->path(), "-std=c++20", "-O3", "-march=native", "-shared", "-fPIC",
                                              "-fvisibility=hidden", "-DISOSHADE_LANES=1", "-I" + folder->path(), "-o",
                                              object, source},
                                             {{"LC_ALL", "C"}}, limit);
  if (!compiled || compiled->late || compiled->status != 0) {
    const bool no_glm = compiled && compiled->output.find("glm/glm.hpp") != std::string::npos;
    why = no_glm ? "there is no GLM (Debian: package libglm-dev)" : "the compiler rejects it";
    return nullptr;
  }
  auto kernel = std::make_unique<cpu::Kernel>(driver::Stage::eval);
  if (!kernel->load(object, ignored)) return nullptr;
  size_t words = 0;
  for (const driver::Field& field : program.results) words += static_cast<size_t>(field.words);
  return std::unique_ptr<PeerProgram>(new PeerProgram(std::move(kernel), words));
}

void PeerProgram::run(std::span<const int32_t> inputs, size_t rows, std::vector<int32_t>& results) const {
  const lanes::FpGuard guard;
  cpu::BufferView views[std::size(lower::frame_buffers)];
  std::ranges::fill(views, cpu::BufferView{inputs.data(), static_cast<int>(inputs.size())});
  results.resize(rows * words_);
  kernel_->eval(views, 0, static_cast<int>(rows), results.data());
}

}  // namespace isoshade::bench
