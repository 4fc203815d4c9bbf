// SPDX-License-Identifier: Apache-2.0
// The pipelines of the ordinary renderer (forward.h). Internal: includes Vulkan-Hpp.
#pragma once

#include <optional>
#include <tuple>

#include "backends/vulkan/forward_device.h"
#include "compiler/driver/forward.h"
#include "compiler/interface/pass_state.h"
#include "compiler/lower/sampling.h"
#include "compiler/targets/glsl/spirv.h"

namespace isoshade::vulkan::forward {

/// A pair in one state of the device.
struct Pipeline {
  vk::raii::DescriptorSetLayout set{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

/// What of the fixed functions a draw decides; `bool`: mirrored.
using State = std::tuple<interface::Cull, bool, interface::DepthTest>;

/// Clears and draws a color and a depth; or, for a post, a color whose every pixel it writes. Both are left to be read by
/// shaders.
vk::raii::RenderPass render_pass(const Device& device, bool has_depth);

/// Nothing, with a diagnostic, if the pair does not compile. `state`: of a draw; a post has none.
std::optional<Pipeline> pipeline(const Device& device, const driver::ForwardPair& pair, const std::optional<State>& state,
                                 const vk::raii::RenderPass& pass, glsl::Contract contract,
                                 support::Diagnostics& diagnostics);

vk::raii::Sampler sampler(const Device& device, const lower::Sampling& sampling);

}  // namespace isoshade::vulkan::forward
