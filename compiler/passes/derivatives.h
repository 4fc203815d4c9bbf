// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces ddx and ddy by arithmetic: forward-mode automatic differentiation of what they are asked of, and of
/// nothing else.
///
/// The source of all change is a function (of a stage) beside which the module has two others with its parameters,
/// called as it is and then ddx_suffix or ddy_suffix: they give what its results change by from a pixel to the next.
/// From there changes go on by the rules of ops (tangents.h) and of library functions (functions/functions.def).
/// A function that asks for changes of its parameters gets them as more parameters, in the group "gradients", from
/// its callers. What called functions change by is computed in functions of their own, `..._change`.
///
/// Needs: a valid module in which no derivative is taken of a derivative, and calls not yet expanded (their rules
/// are those of functions, not of their bits). Leaves: no ddx and no ddy; without any before, the module as it is.
void derivatives(ir::Module& module);

inline constexpr std::string_view ddx_suffix = "_ddx";
inline constexpr std::string_view ddy_suffix = "_ddy";

}  // namespace isoshade::passes
