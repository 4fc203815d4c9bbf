// SPDX-License-Identifier: Apache-2.0
// The parts of parse_scene. Each reports what is wrong and returns what it could read.
#pragma once

#include <optional>
#include <string>

#include "compiler/graph/reader.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

/// Coordinates and lengths that keep every matrix of a frame finite, products included.
inline constexpr graph::Range coordinates{-1e9, 1e9};
inline constexpr graph::Range lengths{1e-6, 1e9};
inline constexpr graph::Range brightness{0, 1e6};

Camera parse_camera(const graph::Document& document, const graph::Json& json,
                    support::Diagnostics& diagnostics);
Light parse_light(const graph::Document& document, const graph::Member& member,
                  support::Diagnostics& diagnostics);
Object parse_object(const graph::Document& document, const graph::Member& member,
                    support::Diagnostics& diagnostics);
/// `before`: the posts that stand before it.
Post parse_post(const graph::Document& document, const graph::Json& json, const std::vector<Post>& before,
                support::Diagnostics& diagnostics);
std::vector<Parameter> parse_parameters(const graph::Document& document, const graph::Json& json,
                                        support::Diagnostics& diagnostics);
/// A string ("sphere") or an object ({"type": "sphere", "radius": 2}).
MeshShape parse_mesh(const graph::Document& document, const graph::Json& json,
                     support::Diagnostics& diagnostics);
inline glm::vec3 to_vec3(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace isoshade::scene
