// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/forward.h"

#include <algorithm>

#include "compiler/driver/forward.h"
#include "compiler/support/assert.h"
#include "compiler/targets/targets.h"
#include "runtime/bench/backends.h"
#include "runtime/bench/subject.h"

namespace isoshade::bench {

namespace {

/// How each image of the parameters is sampled; nothing if one is sampled in several ways, or as a parameter says.
std::optional<std::vector<lower::Sampling>> samplings_of(const driver::Shader& shader) {
  std::vector<lower::Sampling> samplings;
  for (const driver::Image& image : shader.parameters.images) {
    if (image.slot.samplings.size() != 1) return std::nullopt;
    const lower::Sampling& sampling = image.slot.samplings[0];
    if (sampling.filter_input != ir::none || sampling.u_input != ir::none || sampling.v_input != ir::none)
      return std::nullopt;
    samplings.push_back(sampling);
  }
  return samplings;
}

/// Of all passes of an effect, or of a post.
std::optional<std::vector<vulkan::ForwardShader>> shaders_of(const std::string& path, emit::ForwardSampling sampling,
                                                             check::Library& library, support::Diagnostics& diagnostics) {
  const support::Source source = graph::read_source(path, diagnostics);
  driver::CompileOptions options;
  options.library = &library;
  const auto shader = source != nullptr ? driver::compile_shader(source, options, {}, diagnostics) : std::nullopt;
  if (!shader || !driver::can_be_forward(*shader, diagnostics)) return std::nullopt;
  std::optional<std::vector<lower::Sampling>> samplings;
  if (sampling == emit::ForwardSampling::samplers) samplings = samplings_of(*shader);
  std::vector<vulkan::ForwardShader> shaders;
  for (driver::ForwardPair& pair : driver::forward_pairs(
           *shader, targets::get(emit::TargetId::glsl), samplings ? sampling : emit::ForwardSampling::fetch))
    shaders.push_back({std::move(pair), samplings.value_or(std::vector<lower::Sampling>())});
  return shaders;
}

}  // namespace

std::string forward_lack(const render::Plan& plan) {
  const backends::View& picture = plan.frame.picture();
  if (plan.frame.views.size() > 1) return "shadows and other views";
  if (plan.samples > 1) return "several samples a pixel";
  if (plan.posts.reads_motion()) return "motion";
  if (plan.frame.light_count > emit::most_forward_lights) return "so many lights";
  if (std::ranges::any_of(picture.draws, &backends::Draw::blended)) return "blending";
  if (plan.stats.environment) return "an environment";
  return "";
}

std::optional<ForwardShaders> forward_shaders(const render::Plan& plan, const std::string& graphs,
                                              emit::ForwardSampling sampling, check::Library& library,
                                              support::Diagnostics& diagnostics) {
  ForwardShaders shaders;
  for (const driver::Effect& effect : plan.effects) {
    auto made = shaders_of(graphs + "/" + effect.document, sampling, library, diagnostics);
    if (!made) return std::nullopt;
    for (size_t i = 0; i < effect.passes.size(); ++i) shaders.passes[&effect.passes[i]] = std::move(made->at(i));
  }
  for (const driver::Post& post : plan.post_documents) {
    auto made = shaders_of(graphs + "/" + post.document, sampling, library, diagnostics);
    if (!made) return std::nullopt;
    shaders.posts[&post] = std::move(made->at(0));
  }
  return shaders;
}

void use_built_ins(ForwardShaders& shaders, const std::string& definitions) {
  const auto replace = [&](emit::ForwardText& text) {
    text.vertex = with_built_ins(std::move(text.vertex), definitions);
    text.fragment = with_built_ins(std::move(text.fragment), definitions);
  };
  for (auto& [pass, shader] : shaders.passes) replace(shader.pair.text);
  for (auto& [post, shader] : shaders.posts) replace(shader.pair.text);
}

vulkan::ForwardScene forward_scene(const render::Plan& plan, const ForwardShaders& shaders) {
  vulkan::ForwardScene scene{&plan.frame, {}, {}, plan.posts.result};
  for (const backends::Draw& draw : plan.frame.picture().draws) {
    const auto origin = std::ranges::find(plan.origins, draw.object, &render::RecordOrigin::record);
    support::assert_that(origin != plan.origins.end(), "a draw of no object");
    scene.shaders.push_back(&shaders.passes.at(origin->pass));
  }
  for (const render::PostStep& step : plan.posts.steps)
    scene.posts.push_back({&shaders.posts.at(step.post), step.record, step.width, step.height, step.sources});
  return scene;
}

std::unique_ptr<ForwardPeer> ForwardPeer::make(const render::Plan& plan, const std::string& graphs,
                                               const std::string& device, check::Library& library,
                                               support::Diagnostics& diagnostics) {
  auto shaders = forward_shaders(plan, graphs, emit::ForwardSampling::samplers, library, diagnostics);
  if (!shaders) return nullptr;
  auto peer = std::make_unique<ForwardPeer>();
  peer->shaders = *std::move(shaders);
  use_built_ins(peer->shaders, built_in_definitions);
  peer->scene = forward_scene(plan, peer->shaders);
  peer->renderer = vulkan::ForwardRenderer::create(peer->scene, device, glsl::Contract::free, diagnostics);
  return peer->renderer != nullptr ? std::move(peer) : nullptr;
}

}  // namespace isoshade::bench
