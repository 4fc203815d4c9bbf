// SPDX-License-Identifier: Apache-2.0
// A program: one kernel at the end of the pipeline, with its reflection. Backends run programs.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/interface/binding.h"
#include "compiler/ir/module.h"
#include "compiler/lower/stages.h"
#include "compiler/passes/hoist.h"
#include "compiler/support/source.h"

namespace isoshade::driver {

using lower::Stage;

/// An effect parameter or an eval column, in the reflection.
struct Field {
  std::string name;
  std::string type;  ///< its name in documents: "float", "color3", ...
  int words = 1;
  std::vector<float> value;             ///< the default, `words` long; empty for eval columns
  std::optional<float> min, max;        ///< of each component
  std::vector<std::string> names = {};  ///< of the values 0, 1, ... of an integer ("enum"); empty if it has none
  bool dynamic = false;                 ///< of a parameter: programs are never compiled for one value of it
};

struct Program {
  Stage stage = Stage::pixel;
  std::string name;            ///< of the document: "cook_torrance"
  std::string document;        ///< its path
  ir::Module module;           ///< expanded, optimised; `/` and sqrt still native
  uint32_t entry = 0;          ///< the kernel's index in the module
  std::vector<Field> inputs;   ///< eval: input columns
  std::vector<Field> results;  ///< eval: output columns
  functions::Tier tier = functions::Tier::standard;
  support::Source source = nullptr;  ///< of the document, for messages; null if there is none
  /// The bindings of the document's function, as lowered; empty if there is none.
  std::vector<interface::Binding> bindings = {};
  /// What is computed once for a draw and lies in its record; null if nothing is.
  std::shared_ptr<const passes::DrawValues> draw = nullptr;
  /// Of what was compiled in this process; copies have the same. So backends need not print a program to recognise it.
  /// 0: it was not compiled.
  uint64_t number = 0;
};

/// Whether the device computes `/` and `sqrt`, or Newton steps with an exact integer remainder do.
enum class Division : uint8_t { native, exact };
inline constexpr std::array division_names{"native", "exact"};

constexpr std::string_view name(Division division) { return division_names[static_cast<size_t>(division)]; }

/// For messages: `the pixel stage of "fur" (fur.json)`.
std::string description(const Program& program);

/// The program as a Vulkan shader of its stage; see targets/glsl/stages.h for its interface.
std::string glsl(const Program& program, Division division);
/// The same, but an eval program becomes a vertex shader.
std::string glsl_with_vertex_eval(const Program& program, Division division);
/// A program as a compute shader; not of Stage::eval.
std::string glsl_of_compute(const Program& program, Division division);
/// The shader for a layer of triangles that are blended: of a program that decides visibility in pixels, and of Stage::blend
/// where the triangles write depth.
std::string glsl_of_layer(const Program& program, Division division);
/// The program as C++ that exports its entry point; see targets/cpp/stages.h. Not for Stage::setup and Stage::depth.
std::string cpp(const Program& program);

}  // namespace isoshade::driver
