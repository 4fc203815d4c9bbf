// SPDX-License-Identifier: Apache-2.0
// Planned frames as an ordinary renderer draws them: with the forward pairs of their effects and posts.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "backends/vulkan/forward.h"
#include "runtime/render/plan.h"

namespace isoshade::bench {

struct ForwardShaders {
  std::map<const driver::EffectPass*, vulkan::ForwardShader> passes;
  std::map<const driver::Post*, vulkan::ForwardShader> posts;
};

/// What of a plan the ordinary renderer cannot draw; empty if it can draw all.
std::string forward_lack(const render::Plan& plan);

/// The pairs of all that the plan draws, in GLSL, with precision `default`. `graphs`: the folder that the documents' names
/// begin in. With ForwardSampling::samplers the device samples for the documents that sample each image in one way. The plan
/// must outlive the result.
std::optional<ForwardShaders> forward_shaders(const render::Plan& plan, const std::string& graphs,
                                              emit::ForwardSampling sampling, check::Library& library,
                                              support::Diagnostics& diagnostics);

/// Puts definitions of GLSL's built-in functions in place of generated ones, see with_built_ins().
void use_built_ins(ForwardShaders& shaders, const std::string& definitions);

/// The plan and the shaders must outlive the result.
vulkan::ForwardScene forward_scene(const render::Plan& plan, const ForwardShaders& shaders);

/// A plan as an ordinary renderer draws it: what the contract costs beside it. Its shaders call GLSL's built-in functions
/// and sample by the device, and the driver may contract and reorder what they compute.
struct ForwardPeer {
  ForwardShaders shaders;
  vulkan::ForwardScene scene;
  std::unique_ptr<vulkan::ForwardRenderer> renderer;

  /// Null after an error. The plan must outlive it. `device`: see VulkanOptions::device.
  static std::unique_ptr<ForwardPeer> make(const render::Plan& plan, const std::string& graphs, const std::string& device,
                                           check::Library& library, support::Diagnostics& diagnostics);
};

}  // namespace isoshade::bench
