// SPDX-License-Identifier: Apache-2.0
//
// C++ without lanes: the same headers and the same generated text, compiled as standard C++. On x86-64 it gives the
// bits of the lanes. On AArch64, run by qemu, too, but that products are flushed before they are rounded: of generated
// programs every bit is compared with what follows from that, of the kernels the results that differ are listed.
#include <array>
#include <compare>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

#include "backends/interpreter/backend.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/process.h"
#include "compiler/support/temporary.h"
#include "runtime/lanes/host.h"
#include "runtime/lanes/lanes.h"
#include "tests/conformance/cases.h"
#include "tests/unit/lanes_operands.h"

namespace isoshade::portable {
namespace {

/// A compiler, and what runs the programs that it makes.
struct Machine {
  const char* name;
  std::vector<std::string> compiler;
  std::vector<std::string> runner;
  bool flushes_before_rounding;
};

const Machine& x86() {
  static const Machine machine = {"x86-64", {"clang++", "-DISOSHADE_SIMD=0"}, {}, false};
  return machine;
}
const Machine& aarch64() {
  static const Machine machine = {
      "AArch64", {"aarch64-linux-gnu-g++"}, {"qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"}, true};
  return machine;
}

class Portable : public testing::TestWithParam<const Machine& (*)()> {
 protected:
  void SetUp() override {
    for (const std::vector<std::string>& words : {machine_.compiler, machine_.runner})
      if (!words.empty() && support::find_program(words[0]).empty())
        GTEST_SKIP() << "there is no " << words[0] << "; scripts/setup.sh installs it";
    ASSERT_TRUE(folder_);
  }

  std::string path(const std::string& name) const { return folder_->path() + "/" + name; }

  static std::string run(std::vector<std::string> words) {
    words[0] = support::find_program(words[0]);
    const auto end = support::run_process(words, {{"LC_ALL", "C"}}, support::Seconds(300));
    std::string line;
    for (const std::string& word : words) line += word + " ";
    EXPECT_TRUE(end) << "cannot start " << line;
    if (!end) return "";
    EXPECT_EQ(end->status, 0) << line << "\n" << end->output.substr(0, 8000);
    return end->output;
  }

  /// Compiles the files without the flags that make bits certain: the headers must suffice.
  void compile(const std::string& program, const std::vector<std::string>& words) const {
    std::vector<std::string> line = machine_.compiler;
    line.insert(line.end(), {"-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror",
                             "-I" ISOSHADE_ROOT "/include", "-I" ISOSHADE_ROOT, "-o", path(program)});
    line.insert(line.end(), words.begin(), words.end());
    run(std::move(line));
  }

  std::string execute(const std::string& program, const std::vector<std::string>& arguments = {}) const {
    std::vector<std::string> line = machine_.runner;
    line.push_back(path(program));
    line.insert(line.end(), arguments.begin(), arguments.end());
    return run(std::move(line));
  }

  void write(const std::string& name, const void* bytes, size_t size) const {
    std::ofstream(path(name), std::ios::binary)
        .write(static_cast<const char*>(bytes), static_cast<long>(size));
  }
  void write(const std::string& name, const std::vector<int32_t>& words) const {
    write(name, words.data(), 4 * words.size());
  }

  std::vector<int32_t> read(const std::string& name, size_t count) const {
    std::vector<int32_t> words(count);
    std::ifstream file(path(name), std::ios::binary);
    file.read(reinterpret_cast<char*>(words.data()), static_cast<long>(4 * count));
    EXPECT_EQ(file.gcount(), static_cast<long>(4 * count)) << name;
    return words;
  }

  const Machine& machine_ = GetParam()();

 private:
  const std::optional<support::TemporaryFolder> folder_ =
      support::TemporaryFolder::make(support::temporary_parent());
};

/// A kernel's result on AArch64 that is not that of x86.
struct Difference {
  std::string kernel;
  std::array<uint32_t, 3> operands;
  uint32_t aarch64, x86;
  auto operator<=>(const Difference&) const = default;
};

void PrintTo(const Difference& d, std::ostream* out) {
  *out << std::hex << d.kernel << " at " << d.operands[0] << " " << d.operands[1] << " " << d.operands[2]
       << ": " << d.aarch64 << ", on x86 " << d.x86;
}

/// All of them: products just below the least normal float.
const std::set<Difference> differences = {
    {"(vec3<F>(a, b, c) * vec3<F>(b, c, a)).z", {0x00800001, 0x80800000, 0x3f7ffffe}, 0, 0x00800000},
    {"(vec3<F>(a, b, c) * vec3<F>(b, c, a)).z", {0x00800001, 0x4b800000, 0xbf7ffffe}, 0x80000000, 0x80800000},
    {"(vec3<F>(a, b, c) * vec3<F>(b, c, a)).z", {0xbf000001, 0x00000100, 0x00fffffe}, 0x80000000, 0x80800000},
    {"(vec4<F>(a, b, c, s) * vec4<F>(b, c, a, a)).y", {0x40000000, 0x3f000001, 0x00fffffe}, 0, 0x00800000},
};

TEST_P(Portable, KernelsOfLanesGiveTheBitsOfX86) {
  namespace test = lanes::test;
  compile("kernels",
          {"-DLANES_TABLE=kernels_portable", "-DLANES_FLOAT=float",
           ISOSHADE_ROOT "/tests/unit/lanes_kernels.cpp", ISOSHADE_ROOT "/tests/portable/kernels.cpp"});
  constexpr int blocks = 64;
  std::vector<int32_t> operands;
  for (int i = 0; i < blocks; ++i) {
    const test::Inputs in = test::inputs_of_block(i * test::block);
    operands.insert(operands.end(), in.uniform, in.uniform + 2);
    for (const int* column : in.columns) operands.insert(operands.end(), column, column + test::block);
  }
  write("operands", operands);
  execute("kernels", {path("operands"), path("results")});

  const test::KernelTable& table = test::kernels_scalar_sse2();
  const size_t kernels = static_cast<size_t>(table.count);
  const std::vector<int32_t> results = read("results", blocks * kernels * test::block);
  std::set<Difference> found;
  std::vector<int32_t> expected(test::block);
  for (size_t i = 0; i < blocks; ++i) {
    const test::Inputs in = test::inputs_of_block(static_cast<int>(i) * test::block);
    for (size_t k = 0; k < kernels; ++k) {
      {
        const lanes::FpGuard guard;
        table.kernels[k].run(in, expected.data());
      }
      const int32_t* actual = results.data() + (i * kernels + k) * test::block;
      for (size_t row = 0; row < test::block; ++row) {
        if (actual[row] == expected[row]) continue;
        const auto word = [](int32_t value) { return static_cast<uint32_t>(value); };
        found.insert({table.kernels[k].text,
                      {word(in.columns[0][row]), word(in.columns[1][row]), word(in.columns[2][row])},
                      word(actual[row]),
                      word(expected[row])});
        ASSERT_LT(found.size(), 100u);
      }
    }
  }
  EXPECT_EQ(found, machine_.flushes_before_rounding ? differences : std::set<Difference>());
}

/// Multiplies as a processor that flushes before rounding: a product that rounds up to the least normal float is zero.
/// Its exact magnitude is below 2^-126 if the exponents of the operands sum up to -127 and the product of the
/// significands, 24-bit integers, is below 2^47.
ir::ValueId product_flushed_early(ir::Builder& k, ir::ValueId a, ir::ValueId b) {
  using ir::Opcode;
  const auto constant = [&](int32_t value) { return k.constant(value); };
  const ir::ValueId product = k.op(Opcode::fmul, {a, b}), bits = k.op(Opcode::fbits, {product});
  const ir::ValueId is_least =
      k.op(Opcode::ieq,
           {k.op(Opcode::iand, {bits, constant(lanes::exponent_bits | 0x7fffff)}), constant(0x00800000)});
  ir::ValueId exponents[2], significands[2];
  for (int i = 0; i < 2; ++i) {
    const ir::ValueId word = k.op(Opcode::fbits, {i == 0 ? a : b});
    exponents[i] =
        k.op(Opcode::ishr, {k.op(Opcode::iand, {word, constant(lanes::exponent_bits)}), constant(23)});
    const ir::ValueId fraction = k.op(Opcode::iand, {word, constant(0x7fffff)});
    significands[i] =
        k.op(Opcode::ishl, {k.op(Opcode::ior, {fraction, constant(0x800000)}), constant(8 - i)});
  }
  const ir::ValueId sum = k.op(Opcode::iadd, {exponents[0], exponents[1]});
  const ir::ValueId high = k.op(Opcode::umulhi, {significands[0], significands[1]});  // of the product * 2^15
  const ir::ValueId is_below = k.op(Opcode::band, {k.op(Opcode::ieq, {sum, constant(2 * 127 - 127)}),
                                                   k.op(Opcode::ult, {high, constant(1 << 30)})});
  const ir::ValueId zero = k.op(Opcode::bitsf, {k.op(Opcode::iand, {bits, constant(lanes::sign_bit)})});
  return k.op(Opcode::select, {k.op(Opcode::band, {is_least, is_below}), zero, product});
}

/// The program with every fmul replaced.
driver::Program flushing_early(driver::Program program) {
  ir::Module& module = program.module;
  const size_t own = module.functions.size();
  for (int width = 1; width <= 4; ++width) {
    const ir::Type type = ir::vector_type(width);
    ir::Function function;
    function.name = "product_" + std::to_string(width);
    function.parameters = {{"a", type, "", false}, {"b", type, "", false}};
    function.results = {{"out", type}};
    module.functions.push_back(function);
    ir::Builder k(module, static_cast<uint32_t>(module.functions.size() - 1));
    std::vector<ir::ValueId> components;
    for (uint32_t i = 0; i < static_cast<uint32_t>(width); ++i)
      components.push_back(
          product_flushed_early(k, k.extract(k.parameter(0), i), k.extract(k.parameter(1), i)));
    const ir::ValueId result = width == 1 ? components[0] : k.construct(components);
    k.finish(std::span(&result, 1));
  }
  for (size_t f = 0; f < own; ++f) {
    ir::Function& function = module.functions[f];
    for (ir::Instruction& instruction : function.instructions) {
      if (instruction.op != ir::Opcode::fmul) continue;
      const int width = function.type(function.operands_of(instruction)[0]).width;
      instruction.op = ir::Opcode::call;
      instruction.imm = static_cast<uint32_t>(own) + static_cast<uint32_t>(width - 1);
    }
  }
  return program;
}

/// One file of all programs, each in a namespace of its own, and a main that runs them on a table of inputs.
std::string one_file(const std::vector<conformance::Case>& cases) {
  std::string text = "#include <cstdio>\n#include <vector>\n#include \"isoshade/lanes/lanes.h\"\n";
  std::string calls;
  for (size_t i = 0; i < cases.size(); ++i) {
    std::string cpp = driver::cpp(cases[i].program);
    constexpr std::string_view exported = "extern \"C\" __attribute__((visibility(\"default\"))) void";
    cpp.replace(cpp.find(exported), exported.size(), "void");
    const std::string space = "program_" + std::to_string(i);
    text += "namespace " + space + " {\n" + cpp + "}\n";
    calls += "  run<" + space + "::BufferView>(" + space + "::isoshade_eval, " +
             std::to_string(cases[i].words.size()) + ", table, rows, out);\n";
  }
  return text +
         "template <class View, class Program>\n"
         "void run(Program program, int width, const std::vector<int>& table, int rows, FILE* out) {\n"
         "  View views[" +
         std::to_string(std::size(lower::frame_buffers)) +
         "] = {};\n"
         "  views[" +
         std::to_string(static_cast<int>(lower::FrameBuffer::inputs)) +
         "] = {table.data(), static_cast<int>(table.size())};\n"
         "  std::vector<int> results(static_cast<size_t>(rows * width));\n"
         "  {\n"
         "    const isoshade::lanes::FpGuard guard;\n"
         "    program(views, 0, rows, results.data());\n"
         "  }\n"
         "  std::fwrite(results.data(), sizeof(int), results.size(), out);\n"
         "}\n"
         "int main(int, char** arguments) {\n"
         "  std::vector<int> table;\n"
         "  FILE* in = std::fopen(arguments[1], \"rb\");\n"
         "  for (int word; std::fread(&word, sizeof word, 1, in) == 1;) table.push_back(word);\n"
         "  const int rows = static_cast<int>(table.size()) / " +
         std::to_string(conformance::input_words) +
         ";\n"
         "  FILE* out = std::fopen(arguments[2], \"wb\");\n" +
         calls + "  return std::fclose(out);\n}\n";
}

TEST_P(Portable, GeneratedOpsAndFunctionsGiveTheBitsOfX86) {
  // Every pair of special values, and random rows.
  constexpr size_t rows = 6000;
  std::vector<conformance::Case> cases;
  for (auto* more : {&conformance::op_cases, &conformance::function_cases, &conformance::tier_cases,
                     &conformance::idiom_cases})
    for (conformance::Case& made : more()) cases.push_back(std::move(made));
  const std::string text = one_file(cases);
  write("programs.cpp", text.data(), text.size());
  compile("programs", {path("programs.cpp")});
  const std::vector<int32_t> table = conformance::inputs(rows);
  write("table", table);
  execute("programs", {path("table"), path("results")});

  size_t width = 0;
  for (const conformance::Case& made : cases) width += made.words.size();
  const std::vector<int32_t> results = read("results", rows * width);
  const auto interpreter = interpreter::create();
  support::Diagnostics diagnostics;
  size_t differing = 0;  // from x86
  const int32_t* actual = results.data();
  for (const conformance::Case& made : cases) {
    std::vector<int32_t> x86, expected;
    ASSERT_TRUE(interpreter->evaluate(made.program, table, rows, x86, diagnostics)) << diagnostics.text();
    if (machine_.flushes_before_rounding) {
      const driver::Program early = flushing_early(made.program);
      ASSERT_TRUE(interpreter->evaluate(early, table, rows, expected, diagnostics)) << diagnostics.text();
    } else {
      expected = x86;
    }
    for (size_t i = 0; i < expected.size(); ++i) {
      const size_t row = i / made.words.size(), word = i % made.words.size();
      differing += actual[i] != x86[i];
      const int32_t* in = table.data() + row * conformance::input_words;
      ASSERT_EQ(actual[i], expected[i])
          << made.words[word] << std::hex << " of " << in[0] << " " << in[1] << " " << in[2] << " " << in[3]
          << " " << in[4] << "; on x86 " << x86[i];
    }
    actual += expected.size();
  }
  std::printf("%zu of %zu results are not those of x86\n", differing, results.size());
  EXPECT_EQ(differing > 0, machine_.flushes_before_rounding);
}

TEST_P(Portable, OnlyProductsJustBelowTheLeastNormalTellWhereFlushingHappens) {
  compile("tiny_results", {ISOSHADE_ROOT "/tests/portable/tiny_results.cpp"});
  const std::string text = execute("tiny_results");
  std::istringstream lines(text);
  int operations = 0;
  for (std::string line; std::getline(lines, line); ++operations) {
    std::istringstream words(line);
    std::string operation;
    long results = 0, normal = 0, differing = -1;
    words >> operation >> results >> normal >> differing;
    if (operation == "products_below_the_least_normal") {
      EXPECT_EQ(results, 2'907'534);  // float_rules.h and README state this number
      EXPECT_EQ(normal, results);
      EXPECT_EQ(differing, machine_.flushes_before_rounding ? results : 0);
    } else {
      EXPECT_EQ(differing, 0) << line;
      EXPECT_GT(normal, results / 10) << line;
      EXPECT_EQ(normal < results * 9 / 10, operation != "sqrt") << line;
    }
  }
  EXPECT_EQ(operations, 6) << text;
}

/// A host with every member of host.def, as host.h documents them.
struct WholeHost {
  template <class F>
  using vec3 = lanes::vec3<F>;
  template <class I>
  using texel_of = lanes::vec4<lanes::float_of<I>>;

  int light_count() const { return 0; }
  template <class F>
  Light<F> light(int, vec3<F>) const;
  template <class F>
  Light<F> light_change(int, vec3<F>, vec3<F>) const;
  template <class I>
  texel_of<I> texel(I, I, I) const;
  template <class I>
  ImageSize<I> image_size(I) const;
  template <class I>
  I image_layer(I, I) const;
  bool has_environment() const { return false; }
  template <class F>
  vec3<F> environment(vec3<F>, F) const;
  template <class F>
  vec3<F> irradiance(vec3<F>) const;
  float time() const;
  int pass_index() const;
  int pass_count() const;
  vec3<float> world_from_object(int) const;
  vec3<float> object_from_world(int) const;
  vec3<float> view_from_world(int) const;
  vec3<float> world_from_view(int) const;
  template <class I>
  texel_of<I> picture(int, I, I) const;
  int picture_width(int) const;
  int picture_height(int) const;
  template <class I>
  lanes::float_of<I> depth(I, I) const;
  int depth_width() const;
  int depth_height() const;
  lanes::vec2<float> screen_size() const;
  vec3<float> camera_position() const;
  vec3<float> camera_direction() const;
  lanes::vec2<float> depth_numerator() const;
  lanes::vec2<float> depth_denominator() const;
};
struct EmptyHost {};

TEST(HostHeader, HasAConceptForEveryRowOfHostDef) {
#define HOST(name, result, parameters, doc)                           \
  EXPECT_TRUE((gives::name<WholeHost, float>)) << #name;              \
  EXPECT_TRUE((gives::name<WholeHost, lanes::Float<4, 2>>)) << #name; \
  EXPECT_FALSE((gives::name<EmptyHost, float>)) << #name;
#include "compiler/interface/host.def"
}

INSTANTIATE_TEST_SUITE_P(Machines, Portable, testing::Values(x86, aarch64),
                         [](const auto& info) { return std::string(info.param == x86 ? "X86" : "Aarch64"); });

}  // namespace
}  // namespace isoshade::portable
