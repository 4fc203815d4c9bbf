// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/limits.h"
#include "backends/vulkan/probe_parts.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/stages.h"
#include "runtime/lanes/scalar.h"

namespace isoshade::vulkan {

namespace {

/// What probe_words.def calls beside operators. The host has lanes/scalar.h.
constexpr std::string_view helpers = R"(
int bits(float x) {
  return (floatBitsToInt(x) & 0x7fffffff) > 0x7f800000 ? 0x7fc00000 : floatBitsToInt(x);
}
float from_bits(int x) { return intBitsToFloat((x & 0x7f800000) == 0 ? x & int(0x80000000) : x); }
float negate(float x) { return intBitsToFloat(floatBitsToInt(x) ^ int(0x80000000)); }
float magnitude(float x) { return intBitsToFloat(floatBitsToInt(x) & 0x7fffffff); }
int to_int(float x) { return int(x); }
float to_float(int x) { return float(x); }
int mul_hi(int x, int y) { int high; int low; imulExtended(x, y, high, low); return high; }
int unsigned_mul_hi(int x, int y) {
  uint high; uint low; umulExtended(uint(x), uint(y), high, low); return int(high);
}
int shift_left(int x, int amount) { return x << amount; }
int shift_right(int x, int amount) { return int(uint(x) >> amount); }
int shift_right_signed(int x, int amount) { return x >> amount; }
bool unsigned_less(int x, int y) { return uint(x) < uint(y); }
int branch(float x, float y) {
  int taken = 0;
  if (x < y) taken = 1; else if (x >= y) taken = 2;
  return taken;
}
)";

constexpr Topic topics[] = {
#define FLOAT(topic, ...) Topic::topic,
#define INT(topic, ...) Topic::topic,
#include "backends/vulkan/probe_words.def"
};
static_assert(std::size(topics) <= max_result_words);

/// Declares a value under its name; `word` is that value as a word.
struct Statement {
  std::string_view name;
  std::string_view declaration;
  std::string_view word;
};
constexpr Statement statements[] = {
#define FLOAT(topic, name, ...) {#name, "precise float " #name " = " #__VA_ARGS__, "bits(" #name ")"},
#define INT(topic, name, ...) {#name, "int " #name " = " #__VA_ARGS__, #name},
#include "backends/vulkan/probe_words.def"
};

std::string compute_row() {
  std::string text =
      "  int i = inputs[3 * row];\n  int j = inputs[3 * row + 1];\n  int k = inputs[3 * row + 2];\n"
      "  float a = from_bits(i);\n  float b = from_bits(j);\n  float c = from_bits(k);\n";
  for (const Statement& statement : statements) text += "  " + std::string(statement.declaration) + ";\n";
  return text;
}

constexpr std::string_view push_interface =
    "layout(push_constant) uniform Push {\n"
    "  int object; int light_count; int program; int first; int count; int width;\n} push;\n";

std::string head(std::string_view interface) {
  return glsl::head() +
         "layout(std430, set = 0, binding = " + std::to_string(static_cast<int>(lower::FrameBuffer::inputs)) +
         ") readonly buffer inputs_block { int inputs[]; };\n" + std::string(interface) +
         std::string(helpers);
}

// The names that probe_words.def uses, for the host.
using lanes::bits;
using lanes::floor;
using lanes::from_bits;
using lanes::mul_hi;
using lanes::negate;
using lanes::shift_left;
using lanes::shift_right;
using lanes::shift_right_signed;
using lanes::sqrt;
using lanes::to_float;
using lanes::to_int;
using lanes::unsigned_less;
using lanes::unsigned_mul_hi;
inline float magnitude(float x) { return lanes::abs(x); }
inline int branch(float x, float y) { return x < y ? 1 : x >= y ? 2 : 0; }

/// From memory to memory, so that the compiler cannot move arithmetic past the guard.
[[gnu::noinline]] void compute_rows(std::span<const Operands> rows, int32_t* words) {
  const lanes::FpGuard guard;
  for (const Operands& row : rows) {
    const int i = row.a, j = row.b, k = row.c;
    const float a = from_bits(i), b = from_bits(j), c = from_bits(k);
#define FLOAT(topic, name, ...)   \
  const float name = __VA_ARGS__; \
  *words++ = bits(name);
#define INT(topic, name, ...)   \
  const int name = __VA_ARGS__; \
  *words++ = name;
#include "backends/vulkan/probe_words.def"
  }
}

}  // namespace

std::string_view name(Topic topic) {
  switch (topic) {
    case Topic::arithmetic: return "addition, subtraction, multiplication";
    case Topic::fusing: return "no fusing or reordering";
    case Topic::division: return "division and square root";
    case Topic::selection: return "selection with NaN";
    case Topic::comparisons: return "comparisons";
    case Topic::rounding: return "floor";
    case Topic::bits: return "bits of floats";
    case Topic::conversions: return "conversions";
    case Topic::integers: return "integers";
  }
  support::bug("no such topic of the probe");
}

std::span<const Topic> word_topics() { return topics; }
std::string_view word_name(size_t word) { return statements[word].name; }

std::vector<int32_t> expected_words(std::span<const Operands> rows) {
  std::vector<int32_t> words(rows.size() * std::size(topics));
  compute_rows(rows, words.data());
  return words;
}

std::string probe_fragment_glsl() {
  std::string text = head(push_interface);
  std::string stores;
  for (size_t word = 0; word < std::size(statements); word += 4) {
    const std::string target = "result_" + std::to_string(word / 4);
    text += "layout(location = " + std::to_string(word / 4) + ") out ivec4 " + target + ";\n";
    std::string list;
    for (size_t i = word; i < word + 4; ++i)
      list += (i == word ? "" : ", ") +
              std::string(i < std::size(statements) ? statements[i].word : std::string_view("0"));
    stores += "  " + target + " = ivec4(" + list + ");\n";
  }
  return text +
         "\nvoid main() {\n"
         "  int row = push.first + int(gl_FragCoord.x) + int(gl_FragCoord.y) * push.width;\n"
         "  if (row >= push.count) discard;\n" +
         compute_row() + stores + "}\n";
}

namespace {

/// A shader that stores the words of a row, one record after another.
std::string storing_glsl(std::string_view interface, std::string_view row, std::string_view end) {
  std::string stores;
  for (size_t word = 0; word < std::size(statements); ++word)
    stores += "  words[at + " + std::to_string(word) + "] = " + std::string(statements[word].word) + ";\n";
  return head(interface) + "layout(std430, set = 0, binding = " + std::to_string(output_binding) +
         ") writeonly buffer words_block { int words[]; };\n"
         "\nvoid main() {\n" +
         std::string(row) + compute_row() + "  int at = row * " + std::to_string(std::size(statements)) +
         ";\n" + stores + std::string(end) + "}\n";
}

}  // namespace

std::string probe_vertex_glsl() {
  return storing_glsl(push_interface, "  int row = gl_VertexIndex;\n", "  gl_PointSize = 1.0;\n");
}

std::string probe_compute_glsl() {
  return storing_glsl(glsl::compute_interface(false),
                      "  int row = int(gl_GlobalInvocationID.x);\n  if (row >= push.columns) return;\n", "");
}

}  // namespace isoshade::vulkan
