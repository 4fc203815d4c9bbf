// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl/stages.h"

#include "compiler/emit/names.h"
#include "compiler/emit/printer.h"
#include "compiler/emit/result_words.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/compute.h"
#include "compiler/targets/glsl/glsl.h"

namespace isoshade::glsl {

using namespace emit;

std::string head() {
  return "#version 450\n"
         "#extension GL_EXT_spirv_intrinsics : require\n"
         "// SignedZeroInfNanPreserve 32: without it some devices let a select swallow a NaN.\n"
         "spirv_execution_mode(extensions = [\"SPV_KHR_float_controls\"], capabilities = [4466], 4461, "
         "32);\n";
}

namespace {

std::string push_constants() { return std::string(push_words) + "; } push;\n"; }

// A uniform will not do: lavapipe compiles a shader again for the values of some.
constexpr std::string_view zero =
    "readonly buffer iso_zero_block { float iso_zero; };\n"
    "#define ISO_ZERO iso_zero  // 0.0 where a driver would fold arithmetic with a literal, by rules of its own\n";

/// Of depth and cutout.
std::string visibility_interface(Variant variant) {
  std::string text = push_constants();
  if (variant == Variant::layer)
    text += binding(3, "") + "uniform isampler2D former_ids;\n" + binding(4, "") + "uniform sampler2D former_depth;\n";
  return text + "layout(location = 0) flat in int triangle;\nlayout(location = 0) out int id;\n";
}

std::string buffers_of(const ir::Module& module, std::vector<bool> used) {
  std::string text;
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const std::string& name = module.buffers[i].name;
    const bool floats = module.buffers[i].element == ir::Scalar::floating;
    text += "layout(std430, set = 0, binding = " + std::to_string(i) + ") readonly buffer " + name +
            "_block { " + (floats ? "float " : "int ") + name + "[]; };\n";
  }
  return text;
}

std::string vertex_main() {
  return std::string(canonical_bits) + std::string(canonical_vector) +
         "\nvoid main() {\n"
         "  precise vec4 position = vertex(gl_VertexIndex, push.object, push.projected);\n"
         "  clip[gl_VertexIndex - push.first + push.count] = uvec4(canonical(position));\n"
         "  gl_PointSize = 1.0;\n"
         "}\n";
}

std::string depth_main() {
  return "void main() {\n"
         "  ivec2 at = ivec2(gl_FragCoord.xy) + ivec2(push.origin_x, push.origin_y);\n"
         "  precise float z = depth(at.x, at.y, triangle);\n"
         "  gl_FragDepth = z;\n"
         "  id = triangle + 1;\n"
         "}\n";
}

/// `CutoutResult covered = cutout(...)`; what does not hold is never seen.
std::string cutout_main(const FunctionText& called) {
  using namespace lower;
  return "void main() {\n"
         "  ivec2 at = ivec2(gl_FragCoord.xy) + ivec2(push.origin_x, push.origin_y);\n"
         "  int object = triangles[triangle * " +
         std::to_string(triangle_word::stride) + " + " + std::to_string(triangle_word::object) + "] >> " +
         std::to_string(triangle_flag::bits) + ";\n  " + called.result_type + " covered = " + called.name +
         "(at.x, at.y, triangle, object);\n"
         "  if (!covered." + called.result_fields[0] + ") discard;\n"
         "  precise float z = covered." + called.result_fields[1] + ";\n"
         "  gl_FragDepth = z;\n"
         "  id = triangle + 1;\n"
         "}\n";
}

std::string push_of(Variant variant, bool of_pixels) {
  return variant == Variant::compute ? compute_interface(of_pixels) : push_constants();
}

/// The pixel of the target, as the ivec2 `name`; none beyond the rectangle of a compute shader.
std::string pixel_head(Variant variant, const std::string& name) {
  if (variant != Variant::compute) return "  ivec2 " + name + " = ivec2(gl_FragCoord.xy);\n";
  return "  ivec2 " + name + " = ivec2(gl_GlobalInvocationID.xy);\n  if (" + name + ".x >= push.columns || " +
         name + ".y >= push.rows) return;\n  " + name + " += ivec2(push.left, push.top);\n";
}

/// How a pixel ends that another program shows.
std::string_view skip(Variant variant) { return variant == Variant::compute ? "return" : "discard"; }

/// Stores the vec4 of an expression as the color of the pixel `at` of the target.
std::string store_color(Variant variant, const std::string& at, const std::string& expression) {
  if (variant != Variant::compute) return "  color = intBitsToFloat(canonical(" + expression + "));\n";
  return "  ivec4 color = canonical(" + expression + ");\n  int word = push.place + 4 * (" + at +
         ".y * push.pitch + " + at + ".x);\n  for (int i = 0; i < 4; ++i) made[word + i] = color[i];\n";
}

/// What pixel and post write to.
std::string color_interface(Variant variant) {
  if (variant != Variant::compute) return "layout(location = 0) out vec4 color;\n";
  return "layout(std430, set = 0, binding = " + std::to_string(static_cast<int>(lower::FrameBuffer::layers)) +
         ") buffer made_block { int made[]; };\n";
}

std::string pixel_main(Variant variant) {
  using namespace lower;
  const std::string stride = std::to_string(triangle_word::stride), skip(glsl::skip(variant));
  return std::string(canonical_bits) + std::string(canonical_vector) + "\nvoid main() {\n" +
         pixel_head(variant, "target") +
         "  ivec2 at = target + ivec2(push.origin_x, push.origin_y);\n"
         "  int triangle = " +
         (variant == Variant::compute ? "seen[target.y * push.pitch + target.x]"
                                      : "texelFetch(ids, target, 0).x - 1") +
         ";\n"
         "  if (triangle < 0) " +
         skip +
         ";\n"
         "  int object = triangles[triangle * " +
         stride + " + " + std::to_string(triangle_word::object) + "] >> " +
         std::to_string(triangle_flag::bits) +
         ";\n"
         "  if (int(objects[object + " +
         std::to_string(object_word::program) + "]) != push.program) " + skip + ";\n" +
         store_color(variant, "target", "pixel(at.x, at.y, triangle, object, push.light_count)") + "}\n";
}

/// As below, in a compute shader: the color behind is that which is replaced, and depths lie from the word `first` on.
std::string blend_compute_main(const FunctionText& called) {
  using namespace lower;
  const auto word = [](int at) { return std::to_string(at); };
  return std::string(canonical_bits) + std::string(canonical_vector) + "\nvoid main() {\n" +
         pixel_head(Variant::compute, "target") +
         "  ivec2 at = target + ivec2(push.origin_x, push.origin_y);\n"
         "  int pixel = target.y * push.pitch + target.x, triangle = seen[pixel];\n"
         "  if (triangle < 0) return;\n"
         "  int last = triangles[triangle * " +
         word(triangle_word::stride) + " + " + word(triangle_word::object) + "], object = last >> " +
         word(triangle_flag::bits) +
         ";\n"
         "  if (int(objects[object + " +
         word(object_word::program) +
         "]) != push.program) return;\n"
         "  int place = push.place + 4 * pixel;\n"
         "  ivec4 former = ivec4(made[place], made[place + 1], made[place + 2], made[place + 3]);\n"
         "  precise vec4 behind = intBitsToFloat(former);\n  " +
         called.result_type + " blended = " + called.name +
         "(at.x, at.y, triangle, object, push.light_count, behind);\n"
         "  ivec4 color = canonical(blended." +
         called.result_fields[0] +
         ");\n"
         "  for (int i = 0; i < 4; ++i) made[place + i] = color[i];\n"
         "  if ((last & " +
         word(triangle_flag::keeps_depth) + ") == 0) made[push.first + pixel] = floatBitsToInt(blended." +
         called.result_fields[1] + ");\n}\n";
}

/// `BlendResult blended = blend(...)` over what is behind the pixel.
std::string blend_main(const FunctionText& called, Variant variant) {
  using namespace lower;
  return std::string(canonical_bits) + std::string(canonical_vector) +
         "\nvoid main() {\n"
         "  ivec2 target = ivec2(gl_FragCoord.xy), at = target + ivec2(push.origin_x, push.origin_y);\n"
         "  int triangle = texelFetch(ids, target, 0).x - 1;\n"
         "  if (triangle < 0) discard;\n"
         "  int object = triangles[triangle * " +
         std::to_string(triangle_word::stride) + " + " + std::to_string(triangle_word::object) + "] >> " +
         std::to_string(triangle_flag::bits) +
         ";\n"
         "  if (int(objects[object + " +
         std::to_string(object_word::program) +
         "]) != push.program) discard;\n"
         "  precise vec4 behind = texelFetch(former_color, target, 0);\n  " +
         called.result_type + " blended = " + called.name +
         "(at.x, at.y, triangle, object, push.light_count, behind);\n"
         "  color = intBitsToFloat(canonical(blended." +
         called.result_fields[0] + "));\n" +
         (variant == Variant::layer ? "  new_depth = blended." + called.result_fields[1] + ";\n" : "") + "}\n";
}

/// The head of the visibility shader of a layer: `at`, and whether the pixel comes after the layer before.
std::string layer_head() {
  return "void main() {\n"
         "  ivec2 target = ivec2(gl_FragCoord.xy), at = target + ivec2(push.origin_x, push.origin_y);\n"
         "  int after = push.first;\n"
         "  if (after < 0) {\n"
         "    after = texelFetch(former_ids, target, 0).x;\n"
         "    if (after == 0) discard;  // the pixel has no further layer\n"
         "  }\n"
         "  if (triangle < after) discard;\n";
}
/// The test of its depth `z`. Triangles are drawn in their order, and of those that come through the first is kept.
std::string layer_tail() {
  using namespace lower;
  return "  int word = triangles[triangle * " + std::to_string(triangle_word::stride) + " + " +
         std::to_string(triangle_word::object) +
         "];\n"
         "  if ((word & " +
         std::to_string(triangle_flag::over) +
         ") == 0 && !(z > texelFetch(former_depth, target, 0).x)) discard;\n"
         "  gl_FragDepth = 1.0;\n"
         "  id = triangle + 1;\n"
         "}\n";
}

std::string depth_layer_main() {
  return layer_head() + "  precise float z = depth(at.x, at.y, triangle);\n" + layer_tail();
}

std::string cutout_layer_main(const FunctionText& called) {
  using namespace lower;
  return layer_head() + "  int object = triangles[triangle * " + std::to_string(triangle_word::stride) + " + " +
         std::to_string(triangle_word::object) + "] >> " + std::to_string(triangle_flag::bits) + ";\n  " +
         called.result_type + " covered = " + called.name +
         "(at.x, at.y, triangle, object);\n"
         "  if (!covered." +
         called.result_fields[0] + ") discard;\n  precise float z = covered." + called.result_fields[1] + ";\n" +
         layer_tail();
}

std::string post_main(Variant variant) {
  return std::string(canonical_bits) + std::string(canonical_vector) + "\nvoid main() {\n" +
         pixel_head(variant, "at") + store_color(variant, "at", "post(at.x, at.y + push.origin_y)") + "}\n";
}

std::string word_bits(const ResultWord& word) {
  switch (word.scalar) {
    case ir::Scalar::floating: return "canonical(" + word.text + ")";
    case ir::Scalar::boolean: return "int(" + word.text + ")";
    case ir::Scalar::integer: break;
  }
  return word.text;
}

/// `EvalResult row_results = eval(row);`
std::string eval_call(const ir::Function& kernel, const FunctionText& called, std::string_view row) {
  const ir::Type type = kernel.results[0].type;
  const bool single = kernel.results.size() == 1;
  return std::string(single && type.is_float() ? "  precise " : "  ") +
         (single ? std::string(ir::name(type)) : called.result_type) + " row_results = " + called.name + "(" +
         std::string(row) + ");\n";
}

std::string eval_main(const ir::Function& kernel, const FunctionText& called) {
  const std::vector<ResultWord> words = result_words(kernel, called, "row_results");
  const size_t targets = (words.size() + 3) / 4;
  std::string text;
  for (size_t i = 0; i < targets; ++i)
    text += "layout(location = " + std::to_string(i) + ") out ivec4 result_" + std::to_string(i) + ";\n";
  text += std::string(canonical_bits) +
          "\nvoid main() {\n"
          "  int row = push.first + int(gl_FragCoord.x) + int(gl_FragCoord.y) * push.width;\n"
          "  if (row >= push.count) discard;\n" +
          eval_call(kernel, called, "row");
  for (size_t i = 0; i < targets; ++i) {
    std::string list;
    for (size_t k = 4 * i; k < 4 * i + 4; ++k)
      list += (list.empty() ? "" : ", ") + (k < words.size() ? word_bits(words[k]) : "0");
    text += "  result_" + std::to_string(i) + " = ivec4(" + list + ");\n";
  }
  return text + "}\n";
}

std::string vertex_eval_main(const ir::Function& kernel, const FunctionText& called) {
  const std::vector<ResultWord> words = result_words(kernel, called, "row_results");
  std::string text =
      std::string(canonical_bits) + "\nvoid main() {\n" + eval_call(kernel, called, "gl_VertexIndex");
  text += "  int word = gl_VertexIndex * " + std::to_string(words.size()) + ";\n";
  for (size_t k = 0; k < words.size(); ++k)
    text += "  words[word + " + std::to_string(k) + "] = " + word_bits(words[k]) + ";\n";
  return text + "  gl_PointSize = 1.0;\n}\n";
}

}  // namespace

std::string stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const Heading& heading,
                       Variant variant) {
  std::vector<bool> used = used_buffers(module, entry);
  std::string text = head();
  text +=
      "// " + comment_text(heading.name) + ", " + std::string(name(stage)) + " stage; generated by isoshade";
  text += heading.document.empty() ? "\n\n" : " from " + comment_text(heading.document) + "\n\n";
  std::vector<FunctionText> texts;
  const std::string printed = functions(module, entry, texts);
  std::string interface, body;
  switch (stage) {
    case lower::Stage::vertex:
      interface = push_of(variant, false) + binding(0) + "writeonly buffer clip_block { uvec4 clip[]; };\n";
      used[static_cast<size_t>(lower::FrameBuffer::inputs)] = variant == Variant::compute;
      body = variant == Variant::compute ? vertex_compute_main() : vertex_main();
      break;
    case lower::Stage::setup:
      interface = setup_interface();
      body = setup_main(texts[entry]);
      break;
    case lower::Stage::depth:
      if (variant == Variant::compute) {
        interface = seen_interface(used);
        body = seen_main(nullptr);
        break;
      }
      interface = visibility_interface(variant);
      body = variant == Variant::layer ? depth_layer_main() : depth_main();
      break;
    case lower::Stage::cutout:
      if (variant == Variant::compute) {
        interface = seen_interface(used);
        body = seen_main(&texts[entry]);
        break;
      }
      used[static_cast<size_t>(lower::FrameBuffer::triangles)] = true;
      interface = visibility_interface(variant);
      body = variant == Variant::layer ? cutout_layer_main(texts[entry]) : cutout_main(texts[entry]);
      break;
    case lower::Stage::pixel:
      used[static_cast<size_t>(lower::FrameBuffer::triangles)] = true;
      used[static_cast<size_t>(lower::FrameBuffer::objects)] = true;
      interface = push_of(variant, true) +
                  (variant == Variant::compute ? binding(9) + "readonly buffer seen_block { int seen[]; };\n"
                                               : binding(1, "") + "uniform isampler2D ids;\n") +
                  color_interface(variant);
      body = pixel_main(variant);
      break;
    case lower::Stage::blend:
      used[static_cast<size_t>(lower::FrameBuffer::triangles)] = true;
      used[static_cast<size_t>(lower::FrameBuffer::objects)] = true;
      if (variant == Variant::compute) {
        interface = compute_interface(true) + binding(9) + "readonly buffer seen_block { int seen[]; };\n" +
                    color_interface(variant);
        body = blend_compute_main(texts[entry]);
        break;
      }
      interface = push_constants() + binding(1, "") + "uniform isampler2D ids;\n" + binding(5, "") +
                  "uniform sampler2D former_color;\nlayout(location = 0) out vec4 color;\n";
      if (variant == Variant::layer) interface += "layout(location = 1) out float new_depth;\n";
      body = blend_main(texts[entry], variant);
      break;
    case lower::Stage::eval:
      if (variant == Variant::vertex_eval) {
        interface = binding(0) + "writeonly buffer words_block { int words[]; };\n";
        body = vertex_eval_main(module.functions[entry], texts[entry]);
        break;
      }
      interface = push_constants();
      body = eval_main(module.functions[entry], texts[entry]);
      break;
    case lower::Stage::post:
      interface = push_of(variant, true) + color_interface(variant);
      body = post_main(variant);
      break;
  }
  support::assert_that(texts[entry].name == name(stage), "a stage calls its kernel by its name");
  if (uses_hidden_zero(module, entry)) interface.append(binding(2)).append(zero);
  text.append(buffers_of(module, used)).append(interface).append("\n");
  text.append(printed).append("\n").append(body);
  return text;
}

}  // namespace isoshade::glsl
