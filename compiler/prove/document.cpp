// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/document.h"

#include <algorithm>

#include "compiler/lower/limits.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/sampling.h"
#include "compiler/lower/screen.h"
#include "compiler/lower/stages.h"
#include "compiler/nodes/site.h"
#include "compiler/support/assert.h"

namespace isoshade::prove {
namespace {

using check::TypedGraph;

struct Range {
  double lo, hi;
  bool unit = false;
};

// What is assumed of a surface and a scene; graphs/README.md tells it.
constexpr Range anywhere{-default_limit, default_limit}, direction{-1, 1, true}, texel{0, 1e3};
constexpr Range anything_at_all{-largest, largest};
/// A value between texels is rounded: it may lie this much beyond them.
constexpr double beyond_texels = 1 + 0x1p-20;
/// What the mip levels of a texture are at most, in 1/65536.
constexpr double most_level = 13 * 65536;

Range range_of(nodes::Surface attribute) {
  using enum nodes::Surface;
  switch (attribute) {
    case position: return anywhere;
    case texcoord: return {-1e4, 1e4};
    case color: return {0, 1e3};
    case pixel_size: return {0, default_limit};
    case normal:
    case view_direction:
    case tangent:
    case bitangent:
    case outline_normal:
    case corner_normal1:
    case corner_normal2:
    case corner_normal3: return direction;
  }
  return anything_at_all;
}

Range surface_range(std::string_view name) {
  for (const lower::SurfaceField& field : lower::surface_fields())
    if (field.name == name) return range_of(field.value.attribute);
  return anything_at_all;
}

/// Of the groups "screen", "sizes" and "camera": of the screen itself, and of each image that is read.
Range screen_range(const ir::Parameter& p) {
  const bool is_int = p.type == ir::int_type;
  if (p.group == lower::screen_group) {
    if (p.name == "coordinate") return {0, 1};
    if (p.name == "pixel") return {0, lower::max_size};
    if (p.name == "view_ray") return {-1e3, 1e3};
    if (p.name == "relative_origin") return anywhere;
    if (is_int && (p.name.ends_with("_x") || p.name.ends_with("_y"))) return {0, lower::max_size};
    if (p.name.ends_with("_inside")) return {0, 1};
  }
  if (p.group == lower::sizes_group) {
    const bool is_size = is_int && (p.name.ends_with("_width") || p.name.ends_with("_height"));
    if (p.name == "screen" || is_size) return {1, lower::max_size};
  }
  if (p.group == lower::camera_group) {
    if (p.name == "direction") return direction;
    if (p.name == "position" || p.name == "depth_numerator" || p.name == "depth_denominator") return anywhere;
  }
  return anything_at_all;
}

Range range_of(const ir::Parameter& p) {
  if (p.group == "surface") return surface_range(p.name);
  if (p.group == "frame" && p.name == "time") return {0, default_limit};
  if (p.group == "images") return {-1, default_limit};
  if (p.group == "spaces") return anywhere;
  if (p.group.empty() && p.name == "light_count") return {0, lower::max_lights};
  return screen_range(p);
}

Given given_of(const ir::Parameter& parameter) {
  const std::string name = parameter.group.empty() ? parameter.name : parameter.group + "." + parameter.name;
  Range range = range_of(parameter);
  if (parameter.type == ir::int_type) range = {std::max(range.lo, -0x1p31), std::min(range.hi, 0x1p31 - 1)};
  if (parameter.type == ir::bool_type) range = {0, 1};
  Given given{name, range.lo, range.hi, range.unit};
  // The distance of a depth of 0 is 1 / 0, and then the greatest that there is.
  if (parameter.group == lower::camera_group && parameter.name == "depth_denominator") given.quotient = 1e9;
  return given;
}

/// How a function that reads textures (sampling.h) answers.
std::vector<Given> answer_of_sampler(std::string_view function) {
  const std::string_view rest = function.substr(std::string_view(lower::sample_prefix).size());
  Given level{"level", 0, most_level}, color{"texel", texel.lo, texel.hi};
  level.answer = color.answer = Answer::other;
  if (rest == "level") return {level};
  if (rest.starts_with("closest_")) return {color};
  color.hi *= beyond_texels;
  if (rest.starts_with("trilinear_")) return {color};
  color.answer = Answer::filtered;
  return rest.starts_with("linear_") ? std::vector{color} : std::vector<Given>();
}

std::vector<Given> outside(std::string_view function) {
  if (function.starts_with(lower::sample_prefix)) return answer_of_sampler(function);
  if (function == lower::light_at_name)
    return {{"light.direction", -1, 1, true}, {"light.color", 0, default_limit}};
  if (function == std::string(lower::depth_prefix) + "_at") return {{"depth", 0, 1}};
  if (function.ends_with("_at")) return {{std::string(function), 0, default_limit}};
  return {};
}

/// By parameter: an input of the document, a matrix one column after another.
std::vector<Given> given_of(const graph::Input& input) {
  const double unbounded = input.type == graph::Type::boolean ? 1 : default_limit;
  Given given{input.name, input.type == graph::Type::boolean ? 0 : -unbounded, unbounded, input.unit};
  if (input.unit) given.lo = -1;
  if (input.unit) given.hi = 1;
  if (input.min) given.lo = static_cast<double>(*input.min);
  if (input.max) given.hi = static_cast<double>(*input.max);
  if (!input.names.empty()) given.lo = 0;
  if (!input.names.empty()) given.hi = static_cast<double>(input.names.size() - 1);
  // A given end may lie beyond the other one that is assumed.
  if (given.lo > given.hi && !input.max) given.hi = given.lo;
  if (given.lo > given.hi) given.lo = given.hi;
  const int columns = nodes::column_count(input.type);
  if (columns == 1) return {given};
  std::vector<Given> all;
  for (int c = 0; c < columns; ++c) {
    all.push_back(given);
    all.back().element = c * columns;
  }
  return all;
}

/// How many taps a post's sum has: as many as it is written for, no fewer.
Given taps_of(const TypedGraph& graph, const ir::Parameter& parameter) {
  for (const auto& [node, count] : lower::tap_counts(graph))
    if (node == parameter.name)
      return {parameter.group + "." + parameter.name, static_cast<double>(count), static_cast<double>(count)};
  return given_of(parameter);
}

std::vector<Given> givens(const TypedGraph& graph, const ir::Function& function) {
  std::vector<Given> all;
  if (graph.graph.kind == graph::DocumentKind::function) {
    for (const graph::Input& input : graph.graph.inputs)
      for (const Given& given : given_of(input)) all.push_back(given);
    return all;
  }
  for (const ir::Parameter& parameter : function.parameters) {
    std::optional<Given> found;
    if (parameter.group == "parameters")
      for (const graph::Input& input : graph.graph.inputs)
        for (const Given& given : given_of(input)) {
          const std::string column =
              given.element < 0 ? "" : "_" + std::to_string(given.element / parameter.type.width);
          if (given.name + column == parameter.name) found = given;
        }
    if (!found)
      found = parameter.group == lower::taps_group ? taps_of(graph, parameter) : given_of(parameter);
    all.push_back(*found);
  }
  return all;
}

}  // namespace

std::optional<std::vector<Subject>> subjects_of(const TypedGraph& graph, support::Diagnostics& diagnostics,
                                                functions::Tier tier) {
  std::vector<Subject> subjects;
  const auto add = [&](const std::string& name, lower::LowerOptions part, const std::string& entry) {
    lower::NodesOfOrigins nodes;
    part.nodes = &nodes;
    const ir::Module module = lower::lower(graph, part);
    const uint32_t function = module.find(entry);
    support::assert_that(function != none, "lowering made no function");
    auto tape = make_tape(module, function, givens(graph, module.functions[function]), outside, tier);
    if (tape)
      subjects.push_back({name, std::move(*tape), std::move(nodes)});
    else
      diagnostics.report(
          support::Id::too_large, graph.graph.span(graph.graph.name_place),
          "it becomes more than " + std::to_string(most_operations) + " operations, too many to be checked");
    return tape.has_value();
  };
  if (graph.graph.kind != graph::DocumentKind::effect) {
    if (!add(graph.graph.name, {}, lower::entry_name(graph))) return std::nullopt;
    return subjects;
  }
  for (size_t i = 0; i < graph.graph.passes.size(); ++i) {
    const std::string name = "pass " + graph.graph.passes[i].name;
    if (graph.position_of(i) != nullptr &&
        !add(name + ", position", {i, lower::PassPart::position}, lower::move_vertex_name))
      return std::nullopt;
    if (!add(name, {i}, lower::shade_name)) return std::nullopt;
  }
  return subjects;
}

}  // namespace isoshade::prove
