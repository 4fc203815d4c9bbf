// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces ddx and ddy by arithmetic: forward-mode automatic differentiation of their operands, and of nothing else.
///
/// Derivatives start at a function of a stage for which the module has two more, with the same parameters and with
/// ddx_suffix or ddy_suffix appended to the name: these return the derivatives of its results along x and y. From there
/// they propagate by the change rules of ops (tangents.h) and of library functions (functions/functions.def). A
/// function that needs the derivatives of its parameters gets them from its callers as further parameters, in the
/// group "gradients". The derivatives of called functions are computed in functions of their own, `..._change`.
///
/// Needs: a valid module without derivatives of derivatives, in which calls are not yet expanded (the rules are those
/// of the functions, not of their bit operations). Leaves: no ddx and no ddy; a module without any is left as it is.
void derivatives(ir::Module& module);

inline constexpr std::string_view ddx_suffix = "_ddx";
inline constexpr std::string_view ddy_suffix = "_ddy";

}  // namespace isoshade::passes
