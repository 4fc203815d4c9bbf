// SPDX-License-Identifier: Apache-2.0
#include "compiler/analysis/document.h"

#include "compiler/lower/lower.h"
#include "compiler/lower/sampling.h"
#include "compiler/lower/stages.h"
#include "compiler/nodes/site.h"
#include "compiler/support/check.h"

namespace isoshade::analysis {
namespace {

using check::TypedGraph;

struct Assumed {
  std::string_view group, name;  ///< of a parameter of `shade`; the name is how it begins
  double lo, hi;
  bool unit = false;
};

/// What is assumed of a surface and a scene; graphs/README.md tells it.
constexpr Assumed assumptions[] = {
    {"surface", "position", -default_limit, default_limit},
    {"surface", "texcoord", -1e4, 1e4},
    {"surface", "color", 0, 1e3},
    {"surface", "pixel_size", 0, default_limit},
    {"surface", "", -1, 1, true},
    {"frame", "time", 0, default_limit},
    {"images", "", -1, default_limit},
    {"screen", "coordinate", 0, 1},
    {"screen", "view_ray", -1e3, 1e3},
    {"screen", "relative_origin", -default_limit, default_limit},
    {"screen", "", 0, 8192},
    {"sizes", "", 1, 8192},
    {"camera", "direction", -1, 1, true},
    {taps_group, "", 0, most_lights},
    {"", "light_count", 0, most_lights},
};

Given given_of(const ir::Parameter& parameter) {
  const std::string name = parameter.group.empty() ? parameter.name : parameter.group + "." + parameter.name;
  if (parameter.name.ends_with("_inside")) return {name, 0, 1};
  for (const Assumed& a : assumptions)
    if (a.group == parameter.group && parameter.name.starts_with(a.name)) return {name, a.lo, a.hi, a.unit};
  Given given{name, -default_limit, default_limit};
  // The distance of a depth of 0 is 1 / 0, and then the greatest that there is.
  if (parameter.group == lower::camera_group && parameter.name == "depth_denominator") given.quotient = 1e9;
  return given;
}

std::vector<Given> outside(std::string_view function) {
  if (function.starts_with(lower::sample_prefix)) return {{"texel", 0, 1e3}};
  if (function == std::string(lower::depth_prefix) + "_at") return {{"depth", 0, 1}};
  if (function != lower::light_at_name && function.ends_with("_at"))
    return {{std::string(function), 0, default_limit}};
  if (function != lower::light_at_name) return {};
  return {{"light.direction", -1, 1, true}, {"light.color", 0, default_limit}};
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
    all.push_back(found ? *found : given_of(parameter));
  }
  return all;
}

}  // namespace

std::optional<std::vector<Subject>> subjects_of(const TypedGraph& graph, support::Diagnostics& diagnostics,
                                                functions::Tier tier) {
  std::vector<Subject> subjects;
  const auto add = [&](const std::string& name, const lower::LowerOptions& part, const std::string& entry) {
    const ir::Module module = lower::lower(graph, part);
    const uint32_t function = module.find(entry);
    support::check(function != none, "lowering made no function");
    auto tape = make_tape(module, function, givens(graph, module.functions[function]), outside, tier);
    if (tape)
      subjects.push_back({name, std::move(*tape)});
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

}  // namespace isoshade::analysis
