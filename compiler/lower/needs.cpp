// SPDX-License-Identifier: Apache-2.0
// What the body of a function needs from outside, and where it finds that.
#include <algorithm>
#include <cmath>

#include "compiler/lower/body.h"

namespace isoshade::lower {

using check::Node;
using check::Operand;
using graph::Type;
using nodes::Value;
using From = Operand::From;

interface::SurfaceValue surface_value(const check::TypedGraph& graph, const Node& node) {
  const auto first = std::get<nodes::Surface>(node.row->lowering);
  nodes::Space space = nodes::Space::world;
  uint32_t set = 0;
  for (size_t i = 0; i < node.row->ports.size(); ++i) {
    const uint32_t setting = graph.operands_of(node)[i].index;
    if (node.row->ports[i].name == "space") space = nodes::space_of(setting);
    if (node.row->ports[i].name == "index") set = setting;
  }
  return {static_cast<nodes::Surface>(static_cast<uint32_t>(first) + set), space};
}

std::vector<SpaceStep> steps_between_spaces(const check::TypedGraph& graph, const Node& node, nodes::Transform what) {
  using enum interface::SpaceMatrix;
  const std::span<const Operand> operands = graph.operands_of(node);
  const nodes::Space from = nodes::space_of(operands[1].index), to = nodes::space_of(operands[2].index);
  if (from == to) return {};
  std::vector<SpaceStep> steps;
  const bool normal = what == nodes::Transform::normal;
  if (from == nodes::Space::object)
    steps.push_back(normal ? SpaceStep{object_from_world, true} : SpaceStep{world_from_object, false});
  if (from == nodes::Space::view) steps.push_back({world_from_view, false});  // a rotation
  if (to == nodes::Space::object)
    steps.push_back(normal ? SpaceStep{world_from_object, true} : SpaceStep{object_from_world, false});
  if (to == nodes::Space::view) steps.push_back({view_from_world, false});
  return steps;
}

Environment::Environment(ir::Builder& b, const check::TypedGraph& graph,
                         const std::vector<interface::Binding>& bindings, interface::Interface& host)
    : interface(host), inputs(graph.graph.inputs.size()) {
  namespace source = interface::source;
  std::vector<std::vector<ir::ValueId>> columns(inputs.size());
  surface.fill(ir::none);
  screen.values.fill(ir::none);
  screen.images.resize(post_image(graph.graph.images.size()) + 1);
  for (size_t i = 0; i < bindings.size(); ++i) {
    const ir::ValueId id = b.parameter(i);
    std::visit(interface::Cases{
                   [&](const source::Attribute& s) { surface[s.value.index()] = id; },
                   [&](const source::MatrixColumn& s) { matrices[static_cast<size_t>(s.matrix)][s.column] = id; },
                   [&](const source::Time&) { time = id; },
                   [&](const source::PassRepetition& s) { repetition[static_cast<size_t>(s.what)] = id; },
                   [&](const source::Input& s) { columns[s.input].push_back(id); },
                   [&](const source::Image& s) {
                     image_slots.resize(std::max<size_t>(image_slots.size(), s.slot + 1), ir::none);
                     image_slots[s.slot] = id;
                   },
                   [&](const source::LightCount&) { light_count = id; },
                   [&](const source::FirstLight&) { first_light = id; },
                   [&](const source::HasEnvironment&) { has_environment = id; },
                   [&](const source::ScreenValue& s) { screen.values[static_cast<size_t>(s.value)] = id; },
                   [&](const source::PixelOfImage& s) {
                     ReadImage& image = screen.images[s.image];
                     (s.axis == interface::Axis::x ? image.x : image.y) = id;
                     const bool is_depth = s.image == depth_image;
                     image.at = host.find(is_depth ? interface::Host::depth : interface::Host::image, s.image);
                   },
                   [&](const source::OffsetInPixel& s) { screen.images[s.image].inside = id; },
                   [&](const source::SizeOfImage& s) {
                     ReadImage& image = screen.images[s.image];
                     (s.axis == interface::Axis::x ? image.width : image.height) = id;
                   },
                   [&](const source::TapCount& s) { screen.tap_counts.emplace_back(s.node, id); },
               },
               bindings[i].source);
  }
  for (size_t i = 0; i < inputs.size(); ++i)
    if (!columns[i].empty()) inputs[i] = Value(columns[i]);
}

void Needs::add_callee(const std::vector<interface::Binding>& bindings) {
  namespace source = interface::source;
  for (const interface::Binding& binding : bindings) {
    if (const auto* attribute = std::get_if<source::Attribute>(&binding.source))
      surface[attribute->value.index()] = true;
    if (const auto* column = std::get_if<source::MatrixColumn>(&binding.source)) {
      size_t& count = columns[static_cast<size_t>(column->matrix)];
      count = std::max<size_t>(count, column->column + 1);
    }
    time |= std::holds_alternative<source::Time>(binding.source);
    if (const auto* number = std::get_if<source::PassRepetition>(&binding.source))
      repetition[static_cast<size_t>(number->what)] = true;
    lights |= std::holds_alternative<source::LightCount>(binding.source);
    has_environment |= std::holds_alternative<source::HasEnvironment>(binding.source);
  }
}

Needs::Needs(const check::TypedGraph& graph, std::span<const Operand> results)
    : nodes(graph.nodes.size()), inputs(graph.graph.inputs.size()) {
  const auto need = [&](const Operand& operand) {
    if (operand.from == From::node) nodes[operand.index] = true;
    screen.add(graph, operand);
    if (operand.from == From::input && operand.needed != Type::filename) inputs[operand.index] = true;
    if (operand.from == From::surface) surface[operand.index] = true;
  };
  std::ranges::for_each(results, need);
  for (auto it = graph.order.rbegin(); it != graph.order.rend(); ++it) {
    if (!nodes[*it]) continue;
    const Node& node = graph.nodes[*it];
    std::ranges::for_each(graph.operands_of(node), need);
    if (node.row == nullptr) continue;
    if (node.row->is<nodes::Surface>()) surface[surface_value(graph, node).index()] = true;
    if (const auto* what = std::get_if<nodes::Transform>(&node.row->lowering)) {
      for (const SpaceStep step : steps_between_spaces(graph, node, *what)) {
        size_t& count = columns[static_cast<size_t>(step.matrix)];
        count = std::max<size_t>(count, *what == nodes::Transform::point ? 4 : 3);
      }
    }
    time |= node.row->is<nodes::Time>();
    if (const auto* what = std::get_if<nodes::Repetition>(&node.row->lowering)) repetition[static_cast<size_t>(*what)] = true;
    lights |= node.row->is<nodes::SumLights>();
    light_at |= node.row->is<nodes::Light>();
    if (const auto* what = std::get_if<nodes::Environment>(&node.row->lowering)) {
      has_environment = true;
      (*what == nodes::Environment::radiance ? radiance : irradiance) = true;
    }
    screen.add(graph, *it);
  }
  surface[shown_position.index()] |= light_at;
}

void Needs::draw_in(const graph::Graph& graph, const interface::Repeat& repeat) {
  double least = repeat.count, most = repeat.count;
  if (repeat.parameter) {
    least = std::floor(*graph.inputs[*repeat.parameter].min);
    most = std::floor(*graph.inputs[*repeat.parameter].max);
  }
  repetition_range = {interface::Assumption{0, most - 1}, interface::Assumption{least, most}};
}

void Needs::add_frame(std::vector<interface::Binding>& bindings) const {
  if (time) bindings.push_back(interface::bind_time());
  for (const auto what : {interface::Repetition::index, interface::Repetition::count})
    if (const auto i = static_cast<size_t>(what); repetition[i])
      bindings.push_back(interface::bind_repetition(what, repetition_range[i]));
  if (has_environment) bindings.push_back(interface::bind_has_environment());
}

void Needs::show_mesh() {
  bool& shown = surface[shown_position.index()];
  surface[world_position.index()] |= shown;
  shown = false;
}

}  // namespace isoshade::lower
