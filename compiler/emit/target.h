// SPDX-License-Identifier: Apache-2.0
// What a text language is to the rest: the rows of compiler/targets/targets.def, and what the folder of each defines.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/emit/forward.h"
#include "compiler/emit/printer.h"
#include "compiler/emit/pure.h"
#include "compiler/emit/target_id.h"
#include "compiler/ir/module.h"
#include "compiler/lower/stages.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::emit {

/// What stands at the head of a text: the document and what made the text.
struct Heading {
  std::string document;
  std::string name;
};

/// A form that a compiler makes of a target's whole shaders, with a name of its own on the command line. Gives bytes; a text
/// that does not compile is reported, and `what` names it there.
struct Binary {
  std::string_view name;       ///< "spirv"
  std::string_view doc;        ///< for the help of the command line
  std::string_view extension;  ///< behind the name of the text's file: ".spv"
  std::optional<std::string> (*kernel)(const std::string& text, lower::Stage stage, support::Diagnostics& diagnostics,
                                       const std::string& what);
  std::optional<ForwardText> (*forward)(const ForwardText& pair, support::Diagnostics& diagnostics,
                                        const std::string& what);
};

/// A target language. Its folder defines `const emit::Target& target()`, which compiler/targets/targets.cpp collects.
struct Target {
  TargetId id;
  std::string_view name;       ///< on the command line: "glsl-es"
  std::string_view doc;        ///< for the help of the command line: "GLSL 4.50 for Vulkan"
  std::string_view extension;  ///< of a pure shader's file: ".glsl"
  std::string_view head;       ///< stands above the functions of a pure shader; may be empty

  bool has_precise;          ///< a declaration can forbid to contract what computes it
  bool has_storage_buffers;  ///< functions can load from arrays of any length
  bool keeps_calls;          ///< its compilers keep large functions as calls; otherwise they expand all calls
  bool rounds_division;      ///< / and sqrt are correctly rounded wherever it runs

  /// Spells the functions that `entry` needs; for print_functions (printer.h).
  std::unique_ptr<Language> (*language)(const ir::Module& module, uint32_t entry);
  /// The text of a kernel with the stage around it, and the extension of its file. Null: the target has pure shaders alone.
  std::string (*kernel)(const ir::Module& module, uint32_t entry, lower::Stage stage, const Heading& heading);
  std::string_view (*kernel_extension)(lower::Stage stage);
  const Binary* binary;  ///< null: none
  std::string (*pure)(const PureShader& shader);  ///< a text to include (pure.h)
  /// A forward pair around a pure shader, and what stands before ".vert" and ".frag" in the names of its files. Null: the
  /// target has none.
  ForwardText (*forward)(const ForwardProgram& program);
  std::string_view forward_infix;
};

}  // namespace isoshade::emit
