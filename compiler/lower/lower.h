// SPDX-License-Identifier: Apache-2.0
// TypedGraph -> ir::Module.
#pragma once

#include <cstddef>
#include <string>

#include "compiler/check/typed_graph.h"
#include "compiler/ir/module.h"

namespace isoshade::lower {

struct LowerOptions {
  size_t pass = 0;  ///< of an effect
};

/// The name of an effect's function; it is the same for every effect.
inline constexpr const char* shade_name = "shade";
inline constexpr const char* light_at_name = "light_at";

/// The module of a function document or of one pass of an effect: the functions that it uses, one a document,
/// and last its own. Nodes that the result does not depend on are left out. Calls to functions.def stay
/// calls, and their declarations have no bodies yet.
///
/// A function document becomes a function of entry_name(), its parameters the inputs, its results the
/// outputs, in order; a matrix is its columns: "m_0", "m_1", ...
///
/// A pass becomes `shade` -> (color: vec4) with these parameters, as far as they are used:
///   surface.position vec3, .normal vec3 (unit), .texcoord vec2, .view_direction vec3 (unit): world space
///   parameters.NAME  uniform; of the effect, in its order
///   light_count      int, uniform: where there is a sum over lights
/// What a light gives comes from light_at(index: int uniform, position: vec3) -> (direction: vec3, color:
/// vec3), which is declared without a body where it is needed (see add_pixel_kernel).
ir::Module lower(const check::TypedGraph& graph, const LowerOptions& options = {});

/// The name of the function that lower() makes of a document.
std::string entry_name(const check::TypedGraph& graph);

}  // namespace isoshade::lower
