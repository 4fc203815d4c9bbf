// SPDX-License-Identifier: Apache-2.0
// The whole compiler on one page: a document in, programs out.
//
//   JSON text -> Document -> Graph -> TypedGraph -> ir::Module -> passes -> Program -> GLSL, C++, SPIR-V
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/check/library.h"
#include "compiler/driver/parameter_block.h"
#include "compiler/driver/program.h"
#include "compiler/graph/graph.h"

namespace isoshade::driver {

/// Called with what a stage made, as text. Stages: document, graph, typed, lower, then each pass by its name.
using Dump = std::function<void(std::string_view stage, const std::function<std::string()>& text)>;

struct CompileOptions {
  check::Library* library = nullptr;  ///< where sub-graphs come from; required
  lower::LightKinds lights;           ///< the kinds that the scene has
  /// For backends/reference: eval and pixel programs stay as lowered, with calls of functions.def and no optimisation;
  /// only ddx and ddy are gone.
  bool reference = false;
  /// Of functions and of what pixels compute. Vertices are always transformed by the default's functions, so that the
  /// same pixels are visible in every tier.
  functions::Tier tier = functions::Tier::standard;
  Dump dump;  ///< empty: nothing is dumped
};

/// One pass of an effect.
struct EffectPass {
  std::string name;
  interface::PassState state;
  bool moves_vertices = false;
  std::optional<size_t> enabled;  ///< of the parameters' fields; the pass is drawn where it is not 0
  Program vertex;
  Program pixel;
};

struct Effect {
  std::string name;
  std::string document;
  ParameterBlock parameters;  ///< in an object's record from object_word::parameters on
  std::vector<EffectPass> passes;
};

/// A full-screen effect.
struct Post {
  std::string name;
  std::string document;
  ParameterBlock parameters;        ///< its whole record; without images
  std::vector<std::string> images;  ///< that it asks for by name
  std::vector<bool> reads;          ///< of the image that it goes over, then of `images`: whether it reads it
  bool reads_depth = false;
  std::optional<size_t> enabled;  ///< of the parameters' fields; where it is 0, the post does nothing
  Program program;
};

/// Which kind of document a source holds.
std::optional<graph::DocumentKind> kind_of(const support::Source& source, support::Diagnostics& diagnostics);

/// The graph of a function or effect document, checked: the front half of the pipeline.
std::shared_ptr<const check::TypedGraph> check_document(const support::Source& source,
                                                        const CompileOptions& options,
                                                        support::Diagnostics& diagnostics);

/// `source` is an effect document.
std::optional<Effect> compile_effect(const support::Source& source, const CompileOptions& options,
                                     support::Diagnostics& diagnostics);

/// `source` is a post document.
std::optional<Post> compile_post(const support::Source& source, const CompileOptions& options,
                                 support::Diagnostics& diagnostics);

/// `source` is a function document; the program is its eval kernel.
std::optional<Program> compile_function(const support::Source& source, const CompileOptions& options,
                                        support::Diagnostics& diagnostics);

/// The visibility pass's program, the same for every scene.
const Program& depth_program();

/// An eval program of a function of a module that frame_module() began.
Program finish_eval(ir::Module module, uint32_t function, std::string name,
                    functions::Tier tier = functions::Tier::standard);

}  // namespace isoshade::driver
