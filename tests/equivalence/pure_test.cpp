// SPDX-License-Identifier: Apache-2.0
// Pure shaders give the bits of the runtime: the GLSL on Vulkan, and the C++ on one lane and on 16, called for a table of
// points by programs that answer what the shaders ask their hosts for.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "backends/cpu/compiler.h"
#include "backends/interpreter/backend.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/targets.h"
#include "tests/equivalence/pure_host.h"
#include "tests/equivalence/pure_subject.h"
#include "tests/unit/temporary_folder.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::equivalence {
namespace {

namespace fs = std::filesystem;

// Programs that call the functions for each row.

std::string glsl_field(const std::string& target, const ir::Type type, int word) {
  const auto at = [&](int i) { return "inputs[row + " + std::to_string(word + i) + "]"; };
  if (type == ir::int_type) return "  " + target + " = " + at(0) + ";\n";
  if (type == ir::bool_type) return "  " + target + " = " + at(0) + " != 0;\n";
  std::string list;
  for (int i = 0; i < type.width; ++i) list += (i == 0 ? "" : ", ") + ("intBitsToFloat(" + at(i) + ")");
  return "  " + target + " = " + (type.width == 1 ? list : std::string(ir::name(type)) + "(" + list + ")") +
         ";\n";
}

std::string glsl_program(const Subject& subject, const std::string& pure) {
  const std::string prefix = name_prefix(subject.shader->pure);
  const std::string after = std::to_string(std::size(lower::frame_buffers) + 2);
  std::string text =
      glsl::head() +
      "layout(std430, set = 0, binding = 6) readonly buffer inputs_block { int inputs[]; };\n"
      "layout(std430, set = 0, binding = " +
      after +
      ") readonly buffer iso_zero_block { float iso_zero; };\n#define ISO_ZERO iso_zero\n"
      "layout(push_constant) uniform Push { int object, light_count, program, first, count, width, "
      "origin_x, origin_y, projected; } push;\n" +
      pure + glsl_host_of(pure);
  text +=
      "layout(location = 0) out ivec4 result_0;\n"
      "int canonical(float x) { int bits = floatBitsToInt(x); return (bits & 0x7fffffff) > 0x7f800000 ? "
      "0x7fc00000 : bits; }\n"
      "void main() {\n"
      "  int row = push.first + int(gl_FragCoord.x) + int(gl_FragCoord.y) * push.width;\n"
      "  if (row >= push.count) discard;\n"
      "  row = row * " +
      std::to_string(subject.stride) + ";\n";
  int word = 0;
  std::string arguments;
  const auto fill = [&](const std::string& record, const std::string& name,
                        const std::vector<emit::PureField>& fields) {
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
  const std::string call = prefix + subject.function + "(" + arguments + ");\n";
  if (subject.result == ir::bool_type) return text + "  bool value = " + call + "  result_0 = ivec4(int(value), 0, 0, 0);\n}\n";
  text += "  precise " + std::string(ir::name(subject.result)) + " value = " + call + "  result_0 = ivec4(";
  for (int i = 0; i < 4; ++i)
    text += (i == 0 ? "" : ", ") +
            (i < subject.words ? "canonical(value[" + std::to_string(i) + "])" : std::string("0"));
  return text + ");\n}\n";
}

std::string cpp_caller(const Subject& subject, size_t number) {
  const std::string space = subject.shader->pure.prefix + "::", stride = std::to_string(subject.stride);
  std::string text =
      "template <class F>\nvoid call_" + std::to_string(number) + "(const int* in, int* out) {\n";
  int word = 0;
  std::string arguments;
  const auto lanes = [&](const ir::Type type) {
    const auto at = [&](int i) { return "(in, " + stride + ", " + std::to_string(word + i) + ")"; };
    if (type == ir::int_type) return "lane_ints<F>" + at(0);
    if (type == ir::bool_type) return "lane_ints<F>" + at(0) + " != int_of<F>(0)";
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
  const auto fill = [&](const std::string& record, const std::string& name,
                        const std::vector<emit::PureField>& fields, const auto& value) {
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
  if (subject.result == ir::bool_type)
    return text + "  store_ints(out, select(value, int_of<F>(1), int_of<F>(0)));\n}\n";
  for (int i = 0; i < subject.words; ++i)
    text += "  store_words(out, " + std::to_string(subject.words) + ", " + std::to_string(i) + ", value." +
            "xyzw"[i] + ");\n";
  return text + "}\n";
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
void expect_same(const Subject& subject, const std::vector<int32_t>& expected,
                 const std::vector<int32_t>& found, const std::string& what) {
  ASSERT_EQ(expected.size(), found.size()) << subject.name << " " << what;
  size_t differing = 0, first = 0;
  for (size_t i = 0; i < expected.size(); ++i)
    if (expected[i] != found[i] && differing++ == 0) first = i;
  EXPECT_EQ(differing, 0u) << subject.name << ", " << what << ": first in row "
                           << first / static_cast<size_t>(subject.words) << ", word "
                           << first % static_cast<size_t>(subject.words) << ": "
                           << std::bit_cast<float>(expected[first]) << " "
                           << std::bit_cast<float>(found[first]);
}

std::vector<int32_t> evaluate(backends::Backend& backend, const Subject& subject,
                              const std::vector<int32_t>& table) {
  support::Diagnostics diagnostics;
  std::vector<int32_t> results;
  EXPECT_TRUE(backend.evaluate(subject.runtime, table, table.size() / static_cast<size_t>(subject.stride),
                               results, diagnostics))
      << subject.name << diagnostics.text();
  return results;
}

/// All headers in one program, which reads a table for each function and writes the results.
void expect_cpp_gives(const Subjects& subjects, const std::vector<std::vector<int32_t>>& tables,
                      const std::vector<std::vector<int32_t>>& expected, const std::string& compiler) {
  const testing::TemporaryFolder folder;
  for (const cpu::Header& header : cpu::lanes_headers()) folder.write(header.path, header.text);
  std::string program = "#include <cstdio>\n#include <vector>\n";
  for (const auto& shader : subjects.shaders) {
    folder.write(shader->pure.prefix + ".h", driver::text(*shader, *targets::find("cpp")));
    program += "#include \"" + shader->pure.prefix + ".h\"\n";
  }
  program += "namespace {\nusing namespace isoshade::lanes;\nusing namespace isoshade::shaders;\n" +
             std::string(cpp_host);
  std::string calls;
  for (size_t i = 0; i < subjects.all.size(); ++i) {
    const Subject& subject = subjects.all[i];
    program += cpp_caller(subject, i);
    calls += "  run(call_" + std::to_string(i) + "<F>, " + std::to_string(i) + ", " +
             std::to_string(subject.stride) + ", " + std::to_string(subject.words) + ", lane_count<F>);\n";
    folder.write(std::to_string(i) + ".in",
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
  folder.write("program.cpp", program);
  for (const char* number : {"float", "Float<8,2>"}) {
    const bool is_one = number == std::string("float");
    const std::string command = "cd " + folder.path().string() + " && " + compiler +
                                " -std=c++20 -O1 -Wall -Wextra -Werror " +
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
  for (const driver::Division division : {driver::Division::native, driver::Division::exact}) {
    support::Diagnostics diagnostics;
    std::map<std::string, std::string> texts;
    vulkan::VulkanOptions options;
    options.glsl = [&](const driver::Program& program, driver::Division) { return texts.at(program.name); };
    const auto device = vulkan::create(options, diagnostics);
    ASSERT_TRUE(device) << diagnostics.text();
    // Exact division gives the bits of a device that rounds correctly.
    if (division == driver::Division::native && device->division() == driver::Division::exact) continue;
    const Subjects divided = subjects_of(paths, division);
    for (size_t i = 0; i < subjects.all.size(); ++i) {
      const Subject& subject = divided.all[i];
      texts[subject.runtime.name] =
          glsl_program(subject, driver::text(*subject.shader, *targets::find("glsl")));
      expect_same(subject, expected[i], evaluate(*device, subject, tables[i]),
                  division == driver::Division::exact ? "vulkan, exact division" : "vulkan");
    }
  }
#endif
  expect_cpp_gives(subjects, tables, expected, "g++");
  if (with_clang) expect_cpp_gives(subjects, tables, expected, "clang++");
}

TEST(PureShaders, GiveTheRuntimesBitsForEveryPointOfATable) {
  const fs::path graphs = ISOSHADE_GRAPHS;
  expect_all_agree({graphs / "materials/cook_torrance.json", graphs / "effects/cartoon.json",
                    graphs / "materials/gltf_pbr.json"},
                   256 * 256, true);
}

TEST(PureShaders, OfEveryShippedEffectAndPostGiveTheRuntimesBits) { expect_all_agree(shipped(), 512, false); }

}  // namespace
}  // namespace isoshade::equivalence
