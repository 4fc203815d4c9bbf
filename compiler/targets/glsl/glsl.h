// SPDX-License-Identifier: Apache-2.0
// GLSL 4.50 for Vulkan, and what its dialects share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/emit/pure.h"
#include "compiler/emit/target.h"
#include "compiler/ir/module.h"

namespace isoshade::glsl {

/// The entry function and all that it calls, without a stage around them: engine-neutral text.
std::string functions(const ir::Module& module, uint32_t entry);
/// The same for a text that defines ISO_ZERO itself. `texts` receives what print_functions (printer.h) gives.
std::string functions(const ir::Module& module, uint32_t entry, std::vector<emit::FunctionText>& texts);

/// What GLSL and its dialects differ in, as far as functions show it.
struct Dialect {
  emit::TargetId target;
  bool has_precise;
};
std::unique_ptr<emit::Language> language(const Dialect& dialect);

const emit::Target& target();

/// A pure shader, whole. `head`: Target::head.
std::string pure(const emit::PureShader& shader, const Dialect& dialect, std::string_view head);
/// A forward pair, whole.
emit::ForwardText forward(const emit::ForwardProgram& program, const Dialect& dialect);

/// Defines ISO_ZERO for a text that is not a stage of ours.
inline constexpr std::string_view hidden_zero_head =
    "// 0.0 where a driver would fold arithmetic with a literal, by rules of its own (x * 0.0 is not always "
    "0.0).\n"
    "// With the literal in its place bits may differ in rare cases. For the same bits on every device "
    "define it as\n"
    "// something that the compiler cannot see through, which is always 0.0: a word of a storage buffer.\n"
    "#ifndef ISO_ZERO\n#define ISO_ZERO 0.0\n#endif\n\n";

/// What every shader of ours begins with: the version, and the execution mode without which `a < b ? a : b`
/// may swallow a NaN.
std::string head();

}  // namespace isoshade::glsl
