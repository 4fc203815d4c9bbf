// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/cpp/stages.h"

#include <algorithm>

#include "compiler/emit/names.h"
#include "compiler/emit/result_words.h"
#include "compiler/ir/expansion.h"
#include "compiler/support/assert.h"
#include "compiler/targets/cpp/cpp.h"

namespace isoshade::cpp {

using namespace emit;

namespace {

constexpr std::string_view head =
    "#include \"isoshade/lanes/lanes.h\"\n\n"
    "#ifndef ISOSHADE_LANES\n#define ISOSHADE_LANES 1\n#endif\n"
    "#ifndef ISOSHADE_REGISTERS\n#define ISOSHADE_REGISTERS 1\n#endif\n\n"
    "namespace isoshade_program {\n\n"
    "using namespace isoshade::lanes;\n\n"
    "#if ISOSHADE_LANES == 1\n"
    "using Lanes = float;\n"
    "#else\n"
    "using Lanes = Float<ISOSHADE_LANES, ISOSHADE_REGISTERS>;\n"
    "#endif\n"
    "constexpr int batch = lane_count<Lanes>;\n\n";

// Before `head` in large programs: half of the text that a compiler sees.
constexpr std::string_view one_register =
    "// A large program: one register a value, or it would compile for twice as long.\n"
    "#undef ISOSHADE_REGISTERS\n#define ISOSHADE_REGISTERS 1\n";

constexpr std::string_view tail_head =
    "\n}  // namespace isoshade_program\n\n"
    "struct BufferView {\n  const void* data;\n  int size;\n};\n\n";

/// The statement that gives functions their buffers.
std::string bind(const ir::Module& module) {
  std::string text = "  const Buffers buffers{\n";
  for (size_t i = 0; i < module.buffers.size(); ++i) {
    const std::string view = "views[" + std::to_string(i) + "]";
    const bool floats = module.buffers[i].element == ir::Scalar::floating;
    text += "      {static_cast<const " + std::string(floats ? "float" : "int") + "*>(" + view + ".data), " +
            view + ".size},\n";
  }
  return text + "  };\n";
}

constexpr std::string_view vertex_main =
    "  using Ints = int_of<Lanes>;\n"
    "  for (int begin = 0; begin < count; begin += batch) {\n"
    "    const Ints vertex_index = lane_index<Ints>() + (first + begin);\n"
    "    const vec4<Lanes> position = vertex<Lanes>(buffers, vertex_index, object, projected);\n"
    "    store_pixels(clip + 4 * begin, position.x, position.y, position.z, position.w, count - begin);\n"
    "  }\n";

// Over lists of pixels, a batch at a time. A tail is filled up with its last pixel.
constexpr std::string_view pixel_loop =
    "  using Ints = int_of<Lanes>;\n"
    "  for (int begin = 0; begin < count; begin += batch) {\n"
    "    const int wanted = count - begin < batch ? count - begin : batch;\n"
    "    int filled[3][batch];\n"
    "    const int* at[3] = {x + begin, y + begin, triangle + begin};\n"
    "    if (wanted < batch)\n"
    "      for (int list = 0; list < 3; ++list) {\n"
    "        for (int lane = 0; lane < batch; ++lane)\n"
    "          filled[list][lane] = at[list][lane < wanted ? lane : wanted - 1];\n"
    "        at[list] = filled[list];\n"
    "      }\n";

constexpr std::string_view pixel_main =
    "    const vec4<Lanes> color = pixel<Lanes>(buffers, load_lanes<Ints>(at[0]), load_lanes<Ints>(at[1]),\n"
    "                                           load_lanes<Ints>(at[2]), object, light_count);\n"
    "    store_pixels(rgba + 4 * begin, color.x, color.y, color.z, color.w, wanted);\n"
    "  }\n";

/// What is behind each pixel comes in `rgba`, and what it then shows goes there.
std::string blend_main(const ir::Function& kernel, const FunctionText& called) {
  return std::string(pixel_loop) +
         "    float words[4][batch];\n"
         "    for (int lane = 0; lane < batch; ++lane)\n"
         "      for (int word = 0; word < 4; ++word)\n"
         "        words[word][lane] = rgba[4 * (begin + (lane < wanted ? lane : wanted - 1)) + word];\n"
         "    const vec4<Lanes> backdrop{load_lanes<Lanes>(words[0]), load_lanes<Lanes>(words[1]),\n"
         "                               load_lanes<Lanes>(words[2]), load_lanes<Lanes>(words[3])};\n"
         "    const auto blended = blend<Lanes>(buffers, load_lanes<Ints>(at[0]), load_lanes<Ints>(at[1]),\n"
         "                                      load_lanes<Ints>(at[2]), object, light_count, backdrop);\n" +
         [&] {
           const std::vector<ResultWord> results = result_words(kernel, called, "blended");
           return "    store_pixels(rgba + 4 * begin, " + results[0].text + ", " + results[1].text + ", " + results[2].text +
                  ", " + results[3].text + ", wanted);\n";
         }() +
         "  }\n";
}

/// The depth is for languages whose stage writes it; here the rasteriser has it.
std::string cutout_main(const ir::Function& kernel, const FunctionText& called) {
  return std::string(pixel_loop) +
         "    const auto covered = cutout<Lanes>(buffers, load_lanes<Ints>(at[0]), load_lanes<Ints>(at[1]),\n"
         "                                       load_lanes<Ints>(at[2]), object);\n"
         "    int words[batch];\n"
         "    store_lanes(words, select(" +
         result_words(kernel, called, "covered")[0].text +
         ", Ints(1), Ints(0)));\n"
         "    for (int lane = 0; lane < wanted; ++lane) drawn[begin + lane] = words[lane];\n"
         "  }\n";
}

constexpr std::string_view post_main =
    "  using Ints = int_of<Lanes>;\n"
    "  for (int begin = 0; begin < count; begin += batch) {\n"
    "    const Ints x = lane_index<Ints>() + (first + begin);\n"
    "    const vec4<Lanes> color = post<Lanes>(buffers, x, y);\n"
    "    store_pixels(rgba + 4 * begin, color.x, color.y, color.z, color.w, count - begin);\n"
    "  }\n";

std::string eval_main(const ir::Function& kernel, const FunctionText& called) {
  const std::vector<ResultWord> words = result_words(kernel, called, "row_results");
  const std::string count = std::to_string(words.size());
  std::string text =
      "  using Ints = int_of<Lanes>;\n"
      "  for (int begin = 0; begin < count; begin += batch) {\n"
      "    const auto row_results = eval<Lanes>(buffers, lane_index<Ints>() + (first + begin));\n"
      "    int words[" +
      count + "][batch];\n";
  for (size_t i = 0; i < words.size(); ++i) {
    std::string value = words[i].text;
    if (words[i].scalar == ir::Scalar::floating) value = "bits(" + value + ")";
    if (words[i].scalar == ir::Scalar::boolean) value = "select(" + value + ", Ints(1), Ints(0))";
    text += "    store_lanes(words[" + std::to_string(i) + "], " + value + ");\n";
  }
  return text +
         "    const int wanted = count - begin < batch ? count - begin : batch;\n"
         "    for (int lane = 0; lane < wanted; ++lane)\n"
         "      for (int word = 0; word < " +
         count +
         "; ++word)\n"
         "        results[" +
         count +
         " * (begin + lane) + word] = words[word][lane];\n"
         "  }\n";
}

}  // namespace

std::string stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const Heading& heading) {
  std::string text =
      "// " + comment_text(heading.name) + ", " + std::string(name(stage)) + " stage; generated by isoshade";
  text += heading.document.empty() ? "\n" : " from " + comment_text(heading.document) + "\n";
  if (ir::expanded_operations(module, entry)[entry] > large_program) text.append(one_register);
  text.append(head).append(buffers(module)).append("\n");
  std::vector<FunctionText> texts;
  text.append(functions(module, entry, texts)).append(tail_head);
  support::assert_that(texts[entry].name == name(stage), "a stage calls its kernel by its name");
  std::string signature, body;
  switch (stage) {
    case lower::Stage::vertex:
      signature = 
          "isoshade_vertex(const BufferView* views, int object, int projected, int first, int count,\n"
          "                                float* clip)";
      body = vertex_main;
      break;
    case lower::Stage::pixel:
      signature =
          "isoshade_pixel(const BufferView* views, int object, int light_count, int count, const int* x,\n"
          "                               const int* y, const int* triangle, float* rgba)";
      body.append(pixel_loop).append(pixel_main);
      break;
    case lower::Stage::blend:
      signature =
          "isoshade_blend(const BufferView* views, int object, int light_count, int count, const int* x,\n"
          "                               const int* y, const int* triangle, float* rgba)";
      body = blend_main(module.functions[entry], texts[entry]);
      break;
    case lower::Stage::cutout:
      signature =
          "isoshade_cutout(const BufferView* views, int object, int count, const int* x, const int* y,\n"
          "                                const int* triangle, int* drawn)";
      body = cutout_main(module.functions[entry], texts[entry]);
      break;
    case lower::Stage::eval:
      signature = "isoshade_eval(const BufferView* views, int first, int count, int* results)";
      body = eval_main(module.functions[entry], texts[entry]);
      break;
    case lower::Stage::post:
      signature = "isoshade_post(const BufferView* views, int first, int y, int count, float* rgba)";
      body = post_main;
      break;
    case lower::Stage::setup:
    case lower::Stage::depth: support::bug(std::string(lower::name(stage)) + " has no C++ stage");
  }
  text.append("extern \"C\" __attribute__((visibility(\"default\"))) void ").append(signature);
  text.append(" {\n  using namespace isoshade_program;\n");
  if (std::ranges::count(used_buffers(module, entry), true) != 0) {
    text += bind(module);
  } else {  // what reads nothing is given nothing
    constexpr std::string_view argument = "buffers, ";
    body.erase(body.find(argument), argument.size());
    text += "  static_cast<void>(views);\n";
  }
  text.append(body).append("}\n");
  return text;
}

}  // namespace isoshade::cpp
