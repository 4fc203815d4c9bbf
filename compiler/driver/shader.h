// SPDX-License-Identifier: Apache-2.0
// A document as a pure shader: functions that other programs link (emit/pure.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "compiler/emit/target.h"

namespace isoshade::driver {

/// A pass of an effect, by its functions in Shader::pure.
struct ShaderPass {
  std::string name;
  interface::PassState state;
  size_t shade = 0;
  std::optional<size_t> move_vertex, coverage;
  graph::PositionSpace position_space{};  ///< of what move_vertex returns
  std::optional<size_t> enabled;          ///< index of a parameter field; the pass is drawn if it is not 0
  std::optional<size_t> double_sided;     ///< index of a parameter field; no face is culled if it is not 0
  std::optional<size_t> blended;          ///< index of a parameter field; the pass is opaque if it is 0
  bool casts_shadow = true, receives_shadow = true;
  interface::Repeat repeat;  ///< its parameter is the index of a parameter field
};

/// A document that is compiled to be linked.
struct Shader {
  graph::DocumentKind kind{};
  emit::PureShader pure;
  /// Of an effect or a post; the words are those of Program's records. Of a function only the images.
  ParameterBlock parameters;
  std::vector<ShaderPass> passes;      ///< of an effect
  std::vector<std::string> images;     ///< of a post: the names of further input images
  std::optional<size_t> enabled;       ///< of a post: index of a parameter field
  std::vector<Field> inputs, outputs;  ///< of a function
  std::shared_ptr<const check::TypedGraph> typed;
  functions::Tier tier = functions::Tier::standard;
  FixedWords fixed = {};  ///< what it is compiled for
  interface::Skips skips = {};
  Division division = Division::native;  ///< of its module
};

struct ShaderOptions {
  std::string prefix;  ///< of names; empty: the document's name
  Division division = Division::native;
};

/// The common beginning of the names of the files of a pass of an effect; `number` is that of the pass.
std::string pass_stem(const std::string& effect, const std::string& pass, size_t number);

/// `source` is a function, effect or post document.
std::optional<Shader> compile_shader(const support::Source& source, const CompileOptions& options,
                                     const ShaderOptions& shader_options, support::Diagnostics& diagnostics);
/// Reports a prefix that names cannot begin with.
std::optional<Shader> compile_shader(const Checked& document, const CompileOptions& options,
                                     const ShaderOptions& shader_options, support::Diagnostics& diagnostics);

/// The shader without ops that the language lacks, and with functions that its compilers can take.
emit::PureShader prepared(const Shader& shader, const emit::Target& target);

/// A program with the stage around it in a language that has kernels.
std::string text(const Program& program, const emit::Target& target, Division division);
/// The shader in a language.
std::string text(const Shader& shader, const emit::Target& target);

}  // namespace isoshade::driver
