// SPDX-License-Identifier: Apache-2.0
// The effects and posts of a scene as programs for WebGL2.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/page/page.h"
#include "runtime/render/plan.h"

namespace isoshade::page {

/// A forward pair for WebGL2 (emit/forward.h).
struct ProgramText {
  std::string name;  ///< for messages: "cartoon, pass outline"
  std::string vertex, fragment;
  /// The members of its block of parameters, by the first word of each in the record; otherwise empty.
  std::vector<std::string> parameters;
};

/// What the panel says of an effect or a post.
struct DocumentText {
  std::string name, doc;
  std::vector<std::string> docs;  ///< of each of its parameters
};

/// The documents of a scene, compiled.
struct Shaders {
  std::vector<ProgramText> programs;
  std::vector<DocumentText> effects;        ///< as Plan::effects
  std::vector<std::vector<size_t>> passes;  ///< in `programs`: of each effect, of each of its passes
  std::vector<DocumentText> posts;          ///< as Plan::post_documents
  std::vector<size_t> post_programs;        ///< in `programs`: of each of them
  bool reads_time = false;
};

/// Compiles the documents that the plan has compiled for its backends.
std::optional<Shaders> compile_shaders(const render::Plan& plan, const PageOptions& options,
                                       support::Diagnostics& diagnostics);

}  // namespace isoshade::page
