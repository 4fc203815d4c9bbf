// SPDX-License-Identifier: Apache-2.0
// Pure shaders give the bits of the runtime: the GLSL on Vulkan, and the C++ on one lane and on 16, called for a table of
// points by programs that answer what the shaders ask their hosts for.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "backends/cpu/compiler.h"
#include "backends/interpreter/backend.h"
#include "compiler/driver/shader.h"
#include "compiler/lower/kernel.h"
#include "compiler/passes/passes.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/targets.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::equivalence {
namespace {

namespace fs = std::filesystem;
namespace place = interface::place;
using emit::PureFunction;
using emit::PureKind;
using functions::traced::Float;
using functions::traced::Int;
using lower::Vec3;

/// Rows of which all have the same parameters: a batch of lanes.
constexpr size_t group = 16;

// What the hosts answer, three times: in IR, in GLSL and in C++. What varies is linear, so that derivatives are exact.

constexpr const char* glsl_host = R"(
int isoshade_light_count() { return 2; }
float isoshade_time() { return 1.25; }
vec3 isoshade_world_from_object(int column) { return vec3(column == 0, column == 1, 2.0 * float(column == 2) + 0.5 * float(column == 3)); }
vec3 isoshade_object_from_world(int column) { return vec3(column == 0, column == 1, 0.5 * float(column == 2) + 0.5 * float(column == 3)); }
vec3 isoshade_view_from_world(int column) { return vec3(column == 1, column == 0, column >= 2); }
vec3 isoshade_world_from_view(int column) { return vec3(column == 1, column == 0, column >= 2); }
int isoshade_picture_width(int image) { return 8 + image; }
int isoshade_picture_height(int image) { return 4 + image; }
int isoshade_depth_width() { return 8; }
int isoshade_depth_height() { return 4; }
vec2 isoshade_screen_size() { return vec2(8.0, 4.0); }
vec3 isoshade_camera_position() { return vec3(0.5, 1.5, 2.5); }
vec3 isoshade_camera_direction() { return vec3(0.0, 0.0, -1.0); }
vec2 isoshade_depth_numerator() { return vec2(0.25, 0.0); }
vec2 isoshade_depth_denominator() { return vec2(0.0, 1.0); }
)";
constexpr const char* glsl_light = R"(
isoshade_Light isoshade_light(int index, vec3 position) {
  precise vec3 direction = vec3(position.y * 0.5, float(index) + 0.5, position.x);
  precise vec3 color = vec3(float(index) + 1.0, position.z * 0.5, 0.75);
  return isoshade_Light(direction, color);
}
)";
constexpr const char* glsl_light_change = R"(
isoshade_Light isoshade_light_change(int index, vec3 position, vec3 change) {
  precise vec3 direction = vec3(change.y * 0.5, 0.0, change.x);
  precise vec3 color = vec3(0.0, change.z * 0.5, 0.0);
  return isoshade_Light(direction, color);
}
)";
constexpr const char* glsl_texel = R"(
vec4 isoshade_texel(int image, int x, int y) { return vec4(float(x) * 0.125, float(y) * 0.25, float(image) * 0.5, 1.0); }
)";
constexpr const char* glsl_image_size = R"(
isoshade_ImageSize isoshade_image_size(int image) { return isoshade_ImageSize(8, 4, 2); }
)";
constexpr const char* glsl_pictures = R"(
vec4 isoshade_picture(int image, int x, int y) { return vec4(float(x) * 0.125, float(y) * 0.25, float(image) * 0.5, 1.0); }
float isoshade_depth(int x, int y) { return float(x) * 0.125; }
)";

constexpr const char* cpp_host = R"(
struct Host {
  int light_count() const { return 2; }
  float time() const { return 1.25f; }
  vec3<float> world_from_object(int c) const { return {float(c == 0), float(c == 1), 2.0f * float(c == 2) + 0.5f * float(c == 3)}; }
  vec3<float> object_from_world(int c) const { return {float(c == 0), float(c == 1), 0.5f * float(c == 2) + 0.5f * float(c == 3)}; }
  vec3<float> view_from_world(int c) const { return {float(c == 1), float(c == 0), float(c >= 2)}; }
  vec3<float> world_from_view(int c) const { return {float(c == 1), float(c == 0), float(c >= 2)}; }
  int picture_width(int image) const { return 8 + image; }
  int picture_height(int image) const { return 4 + image; }
  int depth_width() const { return 8; }
  int depth_height() const { return 4; }
  vec2<float> screen_size() const { return {8.0f, 4.0f}; }
  vec3<float> camera_position() const { return {0.5f, 1.5f, 2.5f}; }
  vec3<float> camera_direction() const { return {0.0f, 0.0f, -1.0f}; }
  vec2<float> depth_numerator() const { return {0.25f, 0.0f}; }
  vec2<float> depth_denominator() const { return {0.0f, 1.0f}; }
  template <class F>
  isoshade::Light<F> light(int index, vec3<F> position) const {
    return {{position.y * 0.5f, F(float(index) + 0.5f), position.x}, {F(float(index) + 1.0f), position.z * 0.5f, F(0.75f)}};
  }
  template <class F>
  isoshade::Light<F> light_change(int, vec3<F>, vec3<F> change) const {
    return {{change.y * 0.5f, F(0.0f), change.x}, {F(0.0f), change.z * 0.5f, F(0.0f)}};
  }
  template <class I>
  vec4<float_of<I>> texel(I image, I x, I y) const {
    return {to_float(x) * 0.125f, to_float(y) * 0.25f, to_float(image) * 0.5f, float_of<I>(1.0f)};
  }
  template <class I>
  isoshade::ImageSize<I> image_size(I) const { return {I(8), I(4), I(2)}; }
  template <class I>
  vec4<float_of<I>> picture(int image, I x, I y) const { return texel(I(image), x, y); }
  template <class I>
  float_of<I> depth(I x, I) const { return to_float(x) * 0.125f; }
};

template <class F>
F lane_floats(const int* in, int stride, int word) {
  int words[lane_count<F>];
  for (int i = 0; i < lane_count<F>; ++i) words[i] = in[i * stride + word];
  return from_bits_normal(load_lanes<int_of<F>>(words));
}
template <class F>
int_of<F> lane_ints(const int* in, int stride, int word) {
  int words[lane_count<F>];
  for (int i = 0; i < lane_count<F>; ++i) words[i] = in[i * stride + word];
  return load_lanes<int_of<F>>(words);
}
template <class F>
void store_words(int* out, int stride, int word, F value) {
  int words[lane_count<F>];
  store_lanes(words, bits(value));
  for (int i = 0; i < lane_count<F>; ++i) out[i * stride + word] = words[i];
}
)";

/// Gives what the module asks its host for a body that computes the same as the texts above.
void define_host(ir::Module& module, const std::map<std::string, interface::HostFunction>& host) {
  for (uint32_t i = 0; i < module.functions.size(); ++i) {
    if (!module.functions[i].is_declaration()) continue;
    const auto found = host.find(module.functions[i].name);
    if (found == host.end()) continue;
    const auto answer = answer_of(found->second);
    if (!answer) continue;
    lower::Kernel k(module, i);
    const auto number = [&](size_t parameter) { return to_float(k.integer(parameter)); };
    switch (answer->call) {
      case interface::HostCall::light: {
        const Vec3 at = k.vector3(1);
        k.b.finish(std::array{Vec3(at[1] * Float(0.5f), number(0) + Float(0.5f), at[0]).value,
                              Vec3(number(0) + Float(1.0f), at[2] * Float(0.5f), Float(k.b, k.b.constant(0.75f))).value});
        break;
      }
      case interface::HostCall::texel:
        k.b.finish(std::array{lower::Vec4(number(1) * Float(0.125f), number(2) * Float(0.25f), number(0) * Float(0.5f),
                                          Float(k.b, k.b.constant(1.0f)))
                                  .value});
        break;
      case interface::HostCall::image_size:
        k.b.finish(std::array{k.b.constant(8), k.b.constant(4), k.b.constant(2)});
        break;
      case interface::HostCall::picture:
        k.b.finish(std::array{lower::Vec4(number(0) * Float(0.125f), number(1) * Float(0.25f),
                                          Float(k.b, k.b.constant(static_cast<float>(answer->image) * 0.5f)),
                                          Float(k.b, k.b.constant(1.0f)))
                                  .value});
        break;
      case interface::HostCall::depth: k.b.finish(std::array{(number(0) * Float(0.125f)).value}); break;
      default: FAIL() << module.functions[i].name;
    }
  }
}

/// What the host answers for a parameter of a document's function.
ir::ValueId answer(lower::Kernel& k, const place::Host& asked) {
  using enum interface::HostCall;
  const auto vector = [&](std::initializer_list<float> components) {
    std::vector<ir::ValueId> values;
    for (const float component : components) values.push_back(k.b.constant(component));
    return k.b.construct(values);
  };
  const int c = asked.argument;
  const auto is = [](bool holds) { return holds ? 1.0f : 0.0f; };
  switch (asked.call) {
    case light_count: return k.b.constant(2);
    case time: return k.b.constant(1.25f);
    case world_from_object: return vector({is(c == 0), is(c == 1), 2.0f * is(c == 2) + 0.5f * is(c == 3)});
    case object_from_world: return vector({is(c == 0), is(c == 1), 0.5f * is(c == 2) + 0.5f * is(c == 3)});
    case view_from_world:
    case world_from_view: return vector({is(c == 1), is(c == 0), is(c >= 2)});
    case picture_width: return k.b.constant(8 + c);
    case picture_height: return k.b.constant(4 + c);
    case depth_width: return k.b.constant(8);
    case depth_height: return k.b.constant(4);
    case screen_size: return vector({8.0f, 4.0f});
    case camera_position: return vector({0.5f, 1.5f, 2.5f});
    case camera_direction: return vector({0.0f, 0.0f, -1.0f});
    case depth_numerator: return vector({0.25f, 0.0f});
    case depth_denominator: return vector({0.0f, 1.0f});
    case light:
    case light_change:
    case texel:
    case image_size:
    case picture:
    case depth: break;
  }
  support::bug("no parameter is this");
}

/// A function of a shader, with a column of the table for each field of its point and of Parameters.
struct Subject {
  std::string name;      ///< unique: also of the runtime's program
  std::string function;  ///< as called in C++
  std::string point;     ///< the struct in C++
  std::vector<emit::PureField> points, parameters;
  const driver::Shader* shader = nullptr;
  driver::Program runtime;
  int stride = 0, words = 0;
};

int words_of(const std::vector<emit::PureField>& fields) {
  int words = 0;
  for (const emit::PureField& field : fields) words += field.parameter.type.width;
  return words;
}

/// The runtime's way: the document's function with the host's answers, behind the kernel for tables.
driver::Program runtime_program(const driver::Shader& shader, size_t entry, const Subject& subject) {
  lower::LoweredShader lowered = lower::lower_shader(*shader.typed);
  lowered.module.buffers = lower::frame_module().buffers;
  std::map<std::string, interface::HostFunction> host;
  for (const interface::HostFunction& function : lowered.entries[entry].interface.host)
    host[lowered.module.functions[function.function].name] = function;
  define_host(lowered.module, host);
  passes::derivatives(lowered.module);
  const interface::Interface& interface = lowered.entries[entry].interface;
  const std::vector<ir::Parameter> wanted = lowered.module.functions[interface.entry].parameters;
  std::vector<ir::Parameter> columns;
  std::vector<std::string> names;
  for (const auto* fields : {&subject.points, &subject.parameters})
    for (const emit::PureField& field : *fields) {
      names.push_back((fields == &subject.points ? "point." : "parameter.") + field.parameter.name);
      columns.push_back({"c" + std::to_string(columns.size()), field.parameter.type, "", false, field.parameter.least,
                         field.parameter.most});
    }
  lower::Kernel k(lowered.module, "probe", columns, lowered.module.functions[interface.entry].results);
  std::vector<ir::ValueId> arguments;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto column = [&](const std::string& space) {
      for (size_t c = 0; c < names.size(); ++c)
        if (names[c] == space + wanted[i].name && columns[c].type == wanted[i].type) return k.b.parameter(c);
      support::bug("no column for " + wanted[i].name);
    };
    if (i >= interface.bindings.size()) {
      arguments.push_back(column("point."));
      continue;
    }
    arguments.push_back(std::visit(
        interface::Cases{
            [&](const place::Point&) { return column("point."); },
            [&](const place::Parameter&) { return column("parameter."); },
            [&](const place::Argument&) { return column("parameter."); },
            [&](const place::Host& asked) { return answer(k, asked); },
            [&](const place::Known& known) { return k.b.constant(known.value); },
        },
        place_of(interface.bindings[i], false)));
  }
  // A count of turns is uniform, as it is where a kernel passes it.
  k.b.finish(k.b.call(interface.entry, arguments));
  return driver::finish_eval(std::move(lowered.module), k.index, subject.name);
}

std::vector<int32_t> table_of(const Subject& subject, size_t rows) {
  std::mt19937 random(7);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const auto word = [&](const ir::Parameter& parameter) {
    const float low = std::max(parameter.least.value_or(-1.5f), -4.0f);
    const float high = std::min(parameter.most.value_or(std::max(low, 1.5f)), std::max(low, 4.0f));
    if (parameter.type == ir::bool_type) return static_cast<int32_t>(random() & 1);
    if (parameter.type == ir::int_type && parameter.group == "images") return static_cast<int32_t>(random() % 4) - 1;
    if (parameter.type == ir::int_type && parameter.group == "screen") return static_cast<int32_t>(random() % 4);
    if (parameter.type == ir::int_type) return static_cast<int32_t>(std::floor(uniform(low, high + 0.99f)));
    return std::bit_cast<int32_t>(random() % 8 == 0 ? (random() % 2 == 0 ? low : high) : uniform(low, high));
  };
  std::vector<int32_t> table(rows * static_cast<size_t>(subject.stride));
  for (size_t row = 0; row < rows; ++row) {
    int32_t* out = table.data() + row * static_cast<size_t>(subject.stride);
    for (const emit::PureField& field : subject.points)
      for (int i = 0; i < field.parameter.type.width; ++i) *out++ = word(field.parameter);
    const int parameter_words = words_of(subject.parameters);
    if (row % group != 0) std::copy_n(out - subject.stride, parameter_words, out);
    for (const emit::PureField& field : subject.parameters)
      for (int i = 0; i < field.parameter.type.width && row % group == 0; ++i) *out++ = word(field.parameter);
  }
  return table;
}

// Programs that call the functions for each row.

std::string glsl_field(const std::string& target, const ir::Type type, int word) {
  const auto at = [&](int i) { return "inputs[row + " + std::to_string(word + i) + "]"; };
  if (type == ir::int_type) return "  " + target + " = " + at(0) + ";\n";
  if (type == ir::bool_type) return "  " + target + " = " + at(0) + " != 0;\n";
  std::string list;
  for (int i = 0; i < type.width; ++i) list += (i == 0 ? "" : ", ") + ("intBitsToFloat(" + at(i) + ")");
  return "  " + target + " = " + (type.width == 1 ? list : std::string(ir::name(type)) + "(" + list + ")") + ";\n";
}

std::string glsl_program(const Subject& subject, const std::string& pure) {
  const std::string prefix = subject.shader->pure.prefix + "_";
  const std::string after = std::to_string(std::size(lower::frame_buffers) + 2);
  std::string text = glsl::head() +
                     "layout(std430, set = 0, binding = 6) readonly buffer inputs_block { int inputs[]; };\n"
                     "layout(std430, set = 0, binding = " + after +
                     ") readonly buffer iso_zero_block { float iso_zero; };\n#define ISO_ZERO iso_zero\n"
                     "layout(push_constant) uniform Push { int object, light_count, program, first, count, width, "
                     "origin_x, origin_y, projected; } push;\n" +
                     pure + glsl_host;
  const auto asks = [&](const char* what) { return pure.find(std::string("ISOSHADE_ASKS_") + what + "\n") != std::string::npos; };
  if (asks("LIGHT")) text += glsl_light;
  if (asks("LIGHT_CHANGE")) text += glsl_light_change;
  if (asks("TEXEL")) text += glsl_texel;
  if (asks("IMAGE_SIZE")) text += glsl_image_size;
  if (asks("PICTURE") || asks("DEPTH")) text += glsl_pictures;
  text += "layout(location = 0) out ivec4 result_0;\n"
          "int canonical(float x) { int bits = floatBitsToInt(x); return (bits & 0x7fffffff) > 0x7f800000 ? 0x7fc00000 : bits; }\n"
          "void main() {\n"
          "  int row = push.first + int(gl_FragCoord.x) + int(gl_FragCoord.y) * push.width;\n"
          "  if (row >= push.count) discard;\n"
          "  row = row * " + std::to_string(subject.stride) + ";\n";
  int word = 0;
  std::string arguments;
  const auto fill = [&](const std::string& record, const std::string& name, const std::vector<emit::PureField>& fields) {
    if (fields.empty()) return;
    text += "  " + prefix + record + " " + name + ";\n";
    for (const emit::PureField& field : fields) {
      text += glsl_field(name + "." + field.name, field.parameter.type, word);
      word += field.parameter.type.width;
    }
    arguments += (arguments.empty() ? "" : ", ") + name;
  };
  fill(subject.point, "point", subject.points);
  fill("Parameters", "parameters", subject.parameters);
  const std::string type = "vec" + std::to_string(subject.words);
  text += "  precise " + type + " value = " + prefix + subject.function + "(" + arguments + ");\n  result_0 = ivec4(";
  for (int i = 0; i < 4; ++i)
    text += (i == 0 ? "" : ", ") + (i < subject.words ? "canonical(value[" + std::to_string(i) + "])" : std::string("0"));
  return text + ");\n}\n";
}

std::string cpp_caller(const Subject& subject, size_t number) {
  const std::string space = subject.shader->pure.prefix + "::", stride = std::to_string(subject.stride);
  std::string text = "template <class F>\nvoid call_" + std::to_string(number) + "(const int* in, int* out) {\n";
  int word = 0;
  std::string arguments;
  const auto lanes = [&](const ir::Type type) {
    const auto at = [&](int i) { return "(in, " + stride + ", " + std::to_string(word + i) + ")"; };
    if (type == ir::int_type) return "lane_ints<F>" + at(0);
    std::string list;
    for (int i = 0; i < type.width; ++i) list += (i == 0 ? "" : ", ") + ("lane_floats<F>" + at(i));
    return type.width == 1 ? list : "{" + list + "}";
  };
  const auto one = [&](const ir::Type type) {
    const auto at = [&](int i) { return "in[" + std::to_string(word + i) + "]"; };
    if (type == ir::int_type) return at(0);
    if (type == ir::bool_type) return at(0) + " != 0";
    std::string list;
    for (int i = 0; i < type.width; ++i) list += (i == 0 ? "" : ", ") + ("from_bits_normal(" + at(i) + ")");
    return type.width == 1 ? list : "{" + list + "}";
  };
  const auto fill = [&](const std::string& record, const std::string& name, const std::vector<emit::PureField>& fields,
                        const auto& value) {
    if (fields.empty()) return;
    text += "  " + space + record + " " + name + ";\n";
    for (const emit::PureField& field : fields) {
      text += "  " + name + "." + field.name + " = " + value(field.parameter.type) + ";\n";
      word += field.parameter.type.width;
    }
    arguments += ", " + name;
  };
  fill(subject.point + "<F>", "point", subject.points, lanes);
  fill("Parameters", "parameters", subject.parameters, one);
  text += "  const auto value = " + space + subject.function + "<F>(Host{}" + arguments + ");\n";
  for (int i = 0; i < subject.words; ++i)
    text += "  store_words(out, " + std::to_string(subject.words) + ", " + std::to_string(i) + ", value." + "xyzw"[i] + ");\n";
  return text + "}\n";
}

/// The shaders of some documents, and all their functions.
struct Subjects {
  std::vector<std::unique_ptr<driver::Shader>> shaders;
  std::vector<Subject> all;
};

Subjects subjects_of(const std::vector<fs::path>& paths) {
  Subjects made;
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  for (const fs::path& path : paths) {
    const support::Source source = graph::read_source(path.string(), diagnostics);
    const auto kind = driver::kind_of(source, diagnostics);
    if (kind != graph::DocumentKind::effect && kind != graph::DocumentKind::post) continue;
    // Documents of several folders may have the same name.
    const std::string prefix = path.parent_path().filename().string() + "_" + path.stem().string();
    auto shader = driver::compile_shader(source, options, {.prefix = prefix}, diagnostics);
    EXPECT_TRUE(shader) << diagnostics.text();
    if (!shader) continue;
    made.shaders.push_back(std::make_unique<driver::Shader>(*std::move(shader)));
    const driver::Shader& kept = *made.shaders.back();
    for (size_t i = 0; i < kept.pure.functions.size(); ++i) {
      const PureFunction& function = kept.pure.functions[i];
      Subject subject;
      subject.function = function_name(kept.pure, function, false);
      subject.name = kept.pure.prefix + "_" + subject.function;
      subject.point = emit::point_record(function.kind);
      subject.points = point_fields(kept.pure, function.kind);
      subject.parameters = kept.pure.parameters;
      subject.shader = &kept;
      subject.stride = words_of(subject.points) + words_of(subject.parameters);
      subject.words = function.kind == PureKind::move_vertex ? 3 : 4;
      if (subject.stride == 0) continue;
      subject.runtime = runtime_program(kept, i, subject);
      made.all.push_back(std::move(subject));
    }
  }
  return made;
}

std::vector<fs::path> shipped() {
  std::vector<fs::path> paths;
  for (const char* folder : {"effects", "materials", "textures", "source_forms"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(ISOSHADE_GRAPHS) / folder))
      if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

/// Says where results differ first, by row and the subject's words.
void expect_same(const Subject& subject, const std::vector<int32_t>& expected, const std::vector<int32_t>& found,
                 const std::string& what) {
  ASSERT_EQ(expected.size(), found.size()) << subject.name << " " << what;
  size_t differing = 0, first = 0;
  for (size_t i = 0; i < expected.size(); ++i)
    if (expected[i] != found[i] && differing++ == 0) first = i;
  EXPECT_EQ(differing, 0u) << subject.name << ", " << what << ": first in row " << first / static_cast<size_t>(subject.words)
                           << ", word " << first % static_cast<size_t>(subject.words) << ": "
                           << std::bit_cast<float>(expected[first]) << " " << std::bit_cast<float>(found[first]);
}

std::vector<int32_t> evaluate(backends::Backend& backend, const Subject& subject, const std::vector<int32_t>& table) {
  support::Diagnostics diagnostics;
  std::vector<int32_t> results;
  EXPECT_TRUE(backend.evaluate(subject.runtime, table, table.size() / static_cast<size_t>(subject.stride), results,
                               diagnostics))
      << subject.name << diagnostics.text();
  return results;
}

/// A folder of this test's own, removed at its end.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "isoshade-pure-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write(const fs::path& path, std::string_view text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
}

/// All headers in one program, which reads a table for each function and writes the results.
void expect_cpp_gives(const Subjects& subjects, const std::vector<std::vector<int32_t>>& tables,
                      const std::vector<std::vector<int32_t>>& expected, const std::string& compiler) {
  const Folder folder;
  for (const cpu::Header& header : cpu::lanes_headers()) write(folder.path() / header.path, header.text);
  std::string program = "#include <cstdio>\n#include <vector>\n";
  for (const auto& shader : subjects.shaders) {
    write(folder.path() / (shader->pure.prefix + ".h"), driver::text(*shader, *targets::find("cpp")));
    program += "#include \"" + shader->pure.prefix + ".h\"\n";
  }
  program += "namespace {\nusing namespace isoshade::lanes;\nusing namespace isoshade::shaders;\n" + std::string(cpp_host);
  std::string calls;
  for (size_t i = 0; i < subjects.all.size(); ++i) {
    const Subject& subject = subjects.all[i];
    program += cpp_caller(subject, i);
    calls += "  run(call_" + std::to_string(i) + "<F>, " + std::to_string(i) + ", " + std::to_string(subject.stride) + ", " +
             std::to_string(subject.words) + ", lane_count<F>);\n";
    write(folder.path() / (std::to_string(i) + ".in"),
          {reinterpret_cast<const char*>(tables[i].data()), 4 * tables[i].size()});
  }
  program += R"(
void run(void (*call)(const int*, int*), int number, int stride, int words, int lanes) {
  const auto open = [&](const char* ending, const char* mode) {
    char name[32];
    std::snprintf(name, sizeof name, "%d.%s", number, ending);
    return std::fopen(name, mode);
  };
  std::FILE* file = open("in", "rb");
  std::fseek(file, 0, SEEK_END);
  std::vector<int> in(static_cast<size_t>(std::ftell(file)) / 4);
  std::rewind(file);
  if (std::fread(in.data(), 4, in.size(), file) != in.size()) return;
  std::fclose(file);
  const size_t rows = in.size() / static_cast<size_t>(stride);
  std::vector<int> out(rows * static_cast<size_t>(words));
  for (size_t row = 0; row < rows; row += static_cast<size_t>(lanes))
    call(in.data() + row * static_cast<size_t>(stride), out.data() + row * static_cast<size_t>(words));
  file = open("out", "wb");
  std::fwrite(out.data(), 4, out.size(), file);
  std::fclose(file);
}
template <class F>
void all() {
)" + calls + "}\n}\nint main() {\n  const FpGuard guard;\n  all<NUMBER>();\n}\n";
  write(folder.path() / "program.cpp", program);
  for (const char* number : {"float", "Float<8,2>"}) {
    const bool is_one = number == std::string("float");
    const std::string command = "cd " + folder.path().string() + " && " + compiler + " -std=c++20 -O1 -Wall -Wextra -Werror " +
                                (is_one ? "" : "-march=x86-64-v3 ") +
                                "-ffp-contract=off -frounding-math -fwrapv '-DNUMBER=" + number +
                                "' -I. program.cpp -o program && ./program";
    ASSERT_EQ(std::system(command.c_str()), 0) << compiler << " " << number;
    for (size_t i = 0; i < subjects.all.size(); ++i) {
      std::vector<int32_t> found(expected[i].size());
      std::ifstream file(folder.path() / (std::to_string(i) + ".out"), std::ios::binary);
      file.read(reinterpret_cast<char*>(found.data()), static_cast<std::streamsize>(4 * found.size()));
      expect_same(subjects.all[i], expected[i], found, compiler + " " + number);
    }
  }
}

void expect_all_agree(const std::vector<fs::path>& paths, size_t rows, bool with_clang) {
  const Subjects subjects = subjects_of(paths);
  const auto interpreter = interpreter::create();
  std::vector<std::vector<int32_t>> tables, expected;
  for (const Subject& subject : subjects.all) {
    tables.push_back(table_of(subject, rows));
    expected.push_back(evaluate(*interpreter, subject, tables.back()));
  }
#ifdef ISOSHADE_VULKAN
  support::Diagnostics diagnostics;
  std::map<std::string, std::string> texts;
  vulkan::VulkanOptions options;
  options.glsl = [&](const driver::Program& program, driver::Division) { return texts.at(program.name); };
  const auto device = vulkan::create(options, diagnostics);
  ASSERT_TRUE(device) << diagnostics.text();
  for (size_t i = 0; i < subjects.all.size(); ++i) {
    const Subject& subject = subjects.all[i];
    texts[subject.runtime.name] = glsl_program(subject, driver::text(*subject.shader, *targets::find("glsl")));
    expect_same(subject, expected[i], evaluate(*device, subject, tables[i]), "vulkan");
  }
#endif
  expect_cpp_gives(subjects, tables, expected, "g++");
  if (with_clang) expect_cpp_gives(subjects, tables, expected, "clang++");
}

TEST(PureShaders, GiveTheRuntimesBitsForEveryPointOfATable) {
  const fs::path graphs = ISOSHADE_GRAPHS;
  expect_all_agree({graphs / "materials/cook_torrance.json", graphs / "effects/cartoon.json", graphs / "materials/gltf_pbr.json"},
                   256 * 256, true);
}

TEST(PureShaders, OfEveryShippedEffectAndPostGiveTheRuntimesBits) { expect_all_agree(shipped(), 512, false); }

}  // namespace
}  // namespace isoshade::equivalence
