// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/document.h"

#include <algorithm>
#include <utility>

#include "compiler/lower/lower.h"
#include "compiler/lower/screen.h"
#include "compiler/lower/stages.h"

namespace isoshade::prove {
namespace {

using check::TypedGraph;

// What is assumed of what a host answers; graphs/README.md tells it.
constexpr double most_light = default_limit;
/// A value between texels is rounded: it may lie this much beyond them.
constexpr double beyond_texels = 1 + 0x1p-20;
/// What the mip levels of a texture are at most, in 1/65536.
constexpr double most_level = 13 * 65536;

/// Whether it reads how far things have moved.
bool is_motion(const TypedGraph& graph, const interface::HostFunction& host) {
  if (host.host != interface::Host::image || host.image < lower::post_image(1)) return false;
  const size_t image = host.image - lower::post_image(1);
  return image < graph.graph.images.size() && graph.graph.images[image].name == graph::motion_image_name;
}
Given motion_answer() {
  constexpr auto farthest = static_cast<double>(lower::farthest_motion);
  return {"motion", -farthest, farthest};
}

}  // namespace

std::vector<Given> answer_of(interface::Host host) {
  const auto texel = [](Answer answer, double beyond) {
    Given color{"texel", interface::assume::color.lo, interface::assume::color.hi * beyond};
    color.answer = answer;
    return std::vector{color};
  };
  switch (host) {
    case interface::Host::light: return {{"light.direction", -1, 1, true}, {"light.color", 0, most_light}};
    case interface::Host::light_change:
      return {{"change of light.direction", -default_limit, default_limit},
              {"change of light.color", -default_limit, default_limit}};
    case interface::Host::environment: return {{"environment", 0, most_light}};
    case interface::Host::irradiance: return {{"irradiance", 0, most_light}};
    case interface::Host::depth: return {{"depth", 0, 1}};
    case interface::Host::image: return {{"image", 0, default_limit}};
    case interface::Host::texel: return texel(Answer::other, 1);
    case interface::Host::texture_layer:
      return {{"picture", interface::assume::texture.lo, interface::assume::texture.hi}};
    case interface::Host::texture_size:
      return {{"width", 1, interface::max_size}, {"height", 1, interface::max_size}, {"smaller", 0, 13}};
    case interface::Host::mip_level: {
      Given level{"level", 0, most_level};
      level.answer = Answer::other;
      return {level};
    }
    case interface::Host::sample_closest: return texel(Answer::other, 1);
    case interface::Host::sample_linear: return texel(Answer::filtered, beyond_texels);
    case interface::Host::sample_trilinear: return texel(Answer::other, beyond_texels);
  }
  return {};
}

Given given_of(const TypedGraph& graph, const interface::Binding& binding) {
  const ir::Parameter& parameter = binding.parameter;
  const interface::Assumption& assumed = binding.assumed;
  Given given{parameter.group.empty() ? parameter.name : parameter.group + "." + parameter.name, assumed.lo,
              assumed.hi, assumed.unit};
  // An input is called as its document calls it, and a matrix's elements are numbered.
  if (const auto* input = std::get_if<interface::source::Input>(&binding.source))
    given.name = graph.graph.inputs[input->input].name;
  given.element = binding.element;
  given.quotient = assumed.quotient;
  if (parameter.type == ir::int_type) given.lo = std::max(given.lo, -0x1p31);
  if (parameter.type == ir::int_type) given.hi = std::min(given.hi, 0x1p31 - 1);
  return given;
}

std::optional<std::vector<Subject>> subjects_of(const TypedGraph& graph, support::Diagnostics& diagnostics,
                                                functions::Tier tier, const Change& change) {
  std::vector<Subject> subjects;
  const auto add = [&](const std::string& name, lower::LowerOptions part) {
    lower::NodesOfOrigins nodes;
    part.nodes = &nodes;
    lower::Lowered lowered = lower::lower(graph, part);
    if (change) change(lowered, part.pass);
    std::vector<Given> givens;
    for (const interface::Binding& binding : lowered.interface.bindings) givens.push_back(given_of(graph, binding));
    const auto outside = [&](uint32_t function) {
      const interface::HostFunction* host = lowered.interface.find(function);
      if (host != nullptr && is_motion(graph, *host)) return std::vector{motion_answer()};
      return host != nullptr ? answer_of(host->host) : std::vector<Given>();
    };
    auto tape = make_tape(lowered.module, lowered.interface.entry, givens, outside, tier);
    if (tape)
      subjects.push_back({name, std::move(*tape), std::move(nodes), std::move(lowered.interface)});
    else
      diagnostics.report(
          support::Id::too_large, graph.graph.span(graph.graph.name_place),
          "it becomes more than " + std::to_string(most_operations) + " operations, too many to be checked");
    return tape.has_value();
  };
  if (graph.graph.kind != graph::DocumentKind::effect) {
    if (!add(graph.graph.name, {})) return std::nullopt;
    return subjects;
  }
  for (size_t i = 0; i < graph.graph.passes.size(); ++i) {
    const std::string name = "pass " + graph.graph.passes[i].name;
    for (const auto& [part, suffix] : {std::pair{lower::PassPart::position, ", position"},
                                       {lower::PassPart::coverage, ", cutout"},
                                       {lower::PassPart::color, ""}})
      if (lower::has_part(graph, i, part) && !add(name + suffix, {i, part})) return std::nullopt;
  }
  return subjects;
}

}  // namespace isoshade::prove
