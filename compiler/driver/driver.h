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
#include "compiler/driver/environment_reads.h"
#include "compiler/driver/fixed.h"
#include "compiler/driver/parameter_block.h"
#include "compiler/driver/program.h"
#include "compiler/graph/graph.h"
#include "compiler/interface/skips.h"

namespace isoshade::driver {

/// Receives the result of a stage as text. Stages: document, graph, typed, lower, then the name of each pass.
using Dump = std::function<void(std::string_view stage, const std::function<std::string()>& text)>;

struct CompileOptions {
  check::Library* library = nullptr;  ///< of function documents; required
  lower::LightKinds lights;           ///< the kinds that the scene has
  /// For backends/reference: eval and pixel programs stay as lowered, with calls of functions.def and without
  /// optimisation; only ddx and ddy are replaced.
  bool reference = false;
  /// Of eval and pixel programs. What decides visibility always uses the default tier, so that every tier shows the same
  /// pixels.
  functions::Tier tier = functions::Tier::standard;
  interface::Skips skips;  ///< what programs and frames may leave out
  FixedWords fixed;        ///< of the record of the effect or post; the programs are for these values alone
  Dump dump;               ///< may be empty
};

/// One pass of an effect.
struct EffectPass {
  std::string name;
  interface::PassState state;
  bool moves_vertices = false;
  bool reads_scene = false;            ///< its `blend` reads the color or the depth of what is opaque
  std::optional<size_t> enabled;       ///< index of a parameter field; the pass is drawn if it is not 0
  std::optional<size_t> double_sided;  ///< index of a parameter field; no face is culled if it is not 0
  std::optional<size_t> blended;       ///< index of a parameter field; the pass is opaque if it is 0
  std::optional<size_t> cutoff;        ///< index of a parameter field; there is no cut-out if it is 0 or less
  bool casts_shadow = true, casts_blended_shadow = false;  ///< the second: where it is blended
  bool sums_lights = false;     ///< its color depends on lights
  bool receives_shadow = true;  ///< its color depends on lights, and on whether anything stands before them
  interface::Repeat repeat;     ///< its parameter is the index of a parameter field
  Program vertex;
  Program pixel;                  ///< of Stage::pixel, where the pass is opaque
  std::optional<Program> blend;   ///< of Stage::blend, where it is blended; there is none if `state` does not blend
  std::optional<Program> cutout;  ///< whether a pixel is drawn; every pixel is if there is none
};

/// Calls `use` for each program of a pass.
template <class Use>
void for_each_program(const EffectPass& pass, const Use& use) {
  use(pass.vertex);
  use(pass.pixel);
  if (pass.blend) use(*pass.blend);
  if (pass.cutout) use(*pass.cutout);
}

struct Effect {
  std::string name;
  std::string document;
  ParameterBlock parameters;  ///< in the object's record, from object_word::parameters
  std::vector<EffectPass> passes;
  /// Behind the parameters, the object's record has the columns that led to world space at the frame before.
  bool reads_previous = false;
  EnvironmentReads environment;
  std::shared_ptr<const check::TypedGraph> typed = nullptr;
  /// Each object lists the lights that its programs sum up: CompileOptions::lights asks for it, and no bit tells whether
  /// a black light is in the list.
  bool lists_lights = false;
  FixedWords fixed = {};  ///< what its programs are compiled for
  /// Behind all of that each record has what is the same all over a draw (Program::draw), at most so many words. Where
  /// there are any, there are always words for the columns before them.
  uint32_t draw_words = 0;
};

/// A full-screen effect.
struct Post {
  std::string name;
  std::string document;
  ParameterBlock parameters;        ///< its whole record; without images
  std::vector<std::string> images;  ///< names of further input images
  /// The one of `images` that is how far things have moved, unless the scene says otherwise.
  std::optional<size_t> motion;
  std::vector<bool> reads;          ///< whether it reads the image that it processes, then each of `images`
  bool reads_depth = false;
  bool is_pointwise = false;      ///< of images it reads no pixel but the one that it makes, and the size does not matter
  bool keeps_background_plain = false;  ///< is_pointwise, and pixels without a surface that have one color keep one
  EnvironmentReads environment;   ///< none if the scene has no environment
  std::optional<size_t> enabled;  ///< index of a parameter field; the post is skipped if it is 0
  Program program;
  std::shared_ptr<const check::TypedGraph> typed = nullptr;
  FixedWords fixed = {};  ///< what its program is compiled for
};

std::optional<graph::DocumentKind> kind_of(const support::Source& source, support::Diagnostics& diagnostics);

/// A document that has passed the front end.
using Checked = std::shared_ptr<const check::TypedGraph>;

/// The front end: parses and checks a function, effect or post document.
Checked check_document(const support::Source& source, const CompileOptions& options, support::Diagnostics& diagnostics);

/// The parts of an effect document, and of a post document, that need no programs: a scene tells by the parameters which
/// values are fixed. Until there are programs, nothing is known of what these read.
std::optional<Effect> check_effect(const support::Source& source, const CompileOptions& options,
                                   support::Diagnostics& diagnostics);
std::optional<Post> check_post(const support::Source& source, const CompileOptions& options,
                               support::Diagnostics& diagnostics);
Effect effect_of(const Checked& effect, const CompileOptions& options);
Post post_of(const Checked& post, const CompileOptions& options);
/// Make the programs of what was checked.
void make_programs(Effect& effect, const CompileOptions& options);
void make_program(Post& post, const CompileOptions& options);

/// `source` is an effect document.
std::optional<Effect> compile_effect(const support::Source& source, const CompileOptions& options,
                                     support::Diagnostics& diagnostics);

/// `source` is a post document.
std::optional<Post> compile_post(const support::Source& source, const CompileOptions& options,
                                 support::Diagnostics& diagnostics);

/// `source` is a function document; the program is its eval kernel.
std::optional<Program> compile_function(const support::Source& source, const CompileOptions& options,
                                        support::Diagnostics& diagnostics);
std::optional<Program> compile_function(const Checked& function, const CompileOptions& options,
                                        support::Diagnostics& diagnostics);

/// The program of the visibility pass, the same for every scene.
const Program& depth_program();
/// The program that makes triangle records (lower::add_setup_kernel).
const Program& setup_program();
/// The programs that draw how far what is seen has moved (lower::add_motion_kernel) and complete it where nothing is drawn
/// (lower::add_backdrop_motion_kernel). `reference`: CompileOptions::reference.
const Program& motion_program(bool reference);
const Program& backdrop_motion_program(bool reference);

/// Makes an eval program of a function of a module created by frame_module().
Program finish_eval(ir::Module module, uint32_t function, std::string name,
                    functions::Tier tier = functions::Tier::standard, const interface::Skips& skips = {});

}  // namespace isoshade::driver
