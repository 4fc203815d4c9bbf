// SPDX-License-Identifier: Apache-2.0
// A program: what a backend runs. One IR function at the end of the pipeline, and how it is called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::driver {

/// The kernels, each a function of the module named as the enumerator:
///   vertex (vertex: int, object: int uniform) -> (clip: vec4)
///   depth  (x: int, y: int, triangle: int) -> (depth: float)                      the same for every scene
///   pixel  (x: int, y: int, triangle: int, object: int uniform, light_count: int uniform) -> (color: vec4)
///   eval   (row: int) -> (any results, flattened to words)
/// `object` is the first word of the object's record; buffers are those of lower/frame_layout.h.
enum class Stage : uint8_t { vertex, depth, pixel, eval };
std::string_view name(Stage stage);

/// One effect parameter or eval column, as reflection tells it.
struct Field {
  std::string name;
  std::string type;  ///< as documents spell it: "float", "color3", ...
  int words = 1;
  std::vector<float> value;  ///< the default, `words` long; empty for eval columns
};

struct Program {
  Stage stage = Stage::pixel;
  std::string name;            ///< of the document: "cook_torrance"
  std::string document;        ///< its path
  ir::Module module;           ///< expanded, optimised; fdiv and fsqrt still native
  uint32_t entry = 0;          ///< the kernel's index in the module
  std::vector<Field> fields;   ///< effect parameters after object_word::parameters; eval: input columns
  std::vector<Field> results;  ///< eval: output columns
  bool uses_lights = false;
};

/// How `/` and `sqrt` are computed: by the device, or by Newton steps and an exact integer residual.
enum class Division : uint8_t { native, exact };

/// The program as a Vulkan shader of its stage, readable; see emit/glsl_stages.h for the interface of each.
std::string glsl(const Program& program, Division division);
/// The program as C++ that exports `extern "C"` entry points; see emit/cpp_stages.h.
std::string cpp(const Program& program);

}  // namespace isoshade::driver
