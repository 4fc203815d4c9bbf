// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/body.h"

#include <algorithm>

#include "compiler/functions/library.h"
#include "compiler/lower/light_sums.h"
#include "compiler/lower/sampling.h"
#include "compiler/support/assert.h"

namespace isoshade::lower {
namespace {

using check::Node;
using check::Operand;
using graph::Type;
using nodes::Value;
using From = Operand::From;

class Body {
 public:
  Body(ir::Builder& builder, const check::TypedGraph& graph, const Environment& environment)
      : b_(builder),
        graph_(graph),
        environment_(environment),
        values_(graph.types.size()),
        origins_(graph.nodes.size()),
        summed_by_(graph.nodes.size(), ir::none),
        is_inside_expression_(graph.nodes.size()) {
    for (const graph::Expression& expression : graph.graph.expressions)
      std::fill(is_inside_expression_.begin() + expression.first, is_inside_expression_.begin() + expression.end,
                true);
  }

  void make(uint32_t node);
  Value read(const Operand& operand);

 private:
  void make_row(const nodes::Row& row, uint32_t node);
  void make_call(uint32_t node);
  /// What a parameter of a called function is given; of an input, its value is kept in `input` for its next column.
  ir::ValueId argument(const interface::Binding& binding, const Node& node, std::span<const uint32_t> image_slots,
                       Value& input);
  void make_sum(uint32_t node);
  /// How often a sum over lights or taps turns.
  ir::ValueId turns_of(uint32_t sum);
  ir::ValueId is_lit();
  void make_fetch(const Node& node);
  FetchOffset offset(nodes::Fetch what, std::span<const Operand> ports);
  Value transform(nodes::Transform what, const Node& node);
  Value image(uint32_t node);
  Value environment(nodes::Environment what, const Node& node);
  std::vector<uint32_t> nodes_under(uint32_t sum);
  /// Gives the results of a node its name, but for those that stood before it under another.
  void name_results(uint32_t node, ir::ValueId first_new);
  void name_value(const Value& value, uint32_t origin, ir::ValueId first_new);
  uint32_t origin_of(uint32_t node);
  /// An origin of its own for a part of what the node makes.
  uint32_t add_origin(std::string name, uint32_t node);
  std::span<Value> results_of(const Node& node) {
    return {values_.data() + node.first_type, node.output_count};
  }

  ir::Builder& b_;
  const check::TypedGraph& graph_;
  const Environment& environment_;
  std::vector<Value> values_;        ///< of TypedGraph::types; of per-turn nodes, those of the last loop
  std::vector<uint32_t> origins_;    ///< of Graph::nodes; 0 until there is one
  std::vector<uint32_t> summed_by_;  ///< the last sum that met a node
  std::vector<bool> is_inside_expression_;  ///< by node: not one of the author's own
  std::vector<uint32_t> position_;   ///< in TypedGraph::order
  std::vector<ir::ValueId> light_;   ///< the results of light_at in the current loop
  ir::ValueId tap_ = ir::none;       ///< the number of the tap in the current loop
};

Value Body::read(const Operand& operand) {
  Value value;
  switch (operand.from) {
    case From::nothing:
    case From::file:
    case From::setting: return value;
    case From::words:
      return nodes::constant(b_, operand.needed, std::span(graph_.words).subspan(operand.index));
    case From::input: value = environment_.inputs[operand.index]; break;
    case From::node: value = values_[graph_.nodes[operand.index].first_type + operand.output]; break;
    case From::surface: return environment_.surface[operand.index];
  }
  if (operand.swizzle_count > 0) {
    std::array<ir::ValueId, 4> components;
    for (size_t i = 0; i < operand.swizzle_count; ++i)
      components[i] = b_.extract(value.id(), operand.swizzle[i]);
    value = b_.construct(std::span<const ir::ValueId>(components).first(operand.swizzle_count));
  }
  return nodes::broadcast(b_, value, operand.type, operand.needed);
}

uint32_t Body::origin_of(uint32_t node) {
  if (origins_[node] == 0) origins_[node] = add_origin(graph_.graph.nodes[node].id, node);
  return origins_[node];
}

uint32_t Body::add_origin(std::string name, uint32_t node) {
  const graph::Node& source = graph_.graph.nodes[node];
  const bool is_whole = name == source.id;
  // The comment behind a function names its own document, and so no line of a base.
  const uint32_t line = source.id_place.source == 0 ? graph_.graph.span(source.id_place).line() : 0;
  const uint32_t origin = b_.add_origin(std::move(name), line,
                                        is_whole ? source.doc : std::string());
  if (std::vector<uint32_t>* nodes = environment_.node_of_origin; nodes != nullptr) {
    nodes->resize(origin + 1, ir::none);
    (*nodes)[origin] = node;
  }
  return origin;
}

void Body::make(uint32_t index) {
  const Node& node = graph_.nodes[index];
  b_.set_origin(origin_of(index));
  const auto first_new = static_cast<ir::ValueId>(b_.function().values.size());
  if (node.row != nullptr) {
    make_row(*node.row, index);
  } else {
    make_call(index);
  }
  name_results(index, first_new);
  b_.set_origin(0);
}

void Body::make_row(const nodes::Row& row, uint32_t index) {
  const Node& node = graph_.nodes[index];
  const std::span<Value> out = results_of(node);
  if (row.is<nodes::Surface>()) {
    out[0] = environment_.surface[surface_value(graph_, node).index()];
    return;
  }
  if (row.is<nodes::Time>()) {
    out[0] = environment_.time;
    return;
  }
  if (const auto* what = std::get_if<nodes::Repetition>(&row.lowering)) {
    out[0] = environment_.repetition[static_cast<size_t>(*what)];
    return;
  }
  if (const auto* what = std::get_if<nodes::Transform>(&row.lowering)) {
    out[0] = transform(*what, node);
    return;
  }
  if (const auto* what = std::get_if<nodes::Light>(&row.lowering)) {
    out[0] = light_[static_cast<size_t>(*what)];
    return;
  }
  if (const auto* what = std::get_if<nodes::Environment>(&row.lowering)) {
    out[0] = environment(*what, node);
    if (out.size() > 1) out[1] = environment_.has_environment;
    return;
  }
  if (row.is<nodes::Image>()) {
    out[0] = image(index);
    return;
  }
  if (const auto* what = std::get_if<nodes::Screen>(&row.lowering)) {
    out[0] = environment_.screen[*what];
    return;
  }
  if (row.is<nodes::TapIndex>()) {
    out[0] = tap_;
    return;
  }
  if (row.is<nodes::Fetch>()) return make_fetch(node);
  if (row.is<nodes::WorldPosition>()) {
    out[0] = relative_position(b_, environment_.screen);
    if (graph_.operands_of(node)[0].index == 0)
      out[0] = b_.op(ir::Opcode::fadd, {environment_.screen[interface::Screen::camera_position], out[0].id()});
    return;
  }
  if (row.is_sum()) return make_sum(index);
  constexpr size_t most = 8;
  std::array<Value, most> in;
  std::array<Type, most> types{};
  std::array<uint32_t, most> settings{};
  const std::span<const Operand> operands = graph_.operands_of(node);
  const size_t count = operands.size();
  support::assert_that(count <= most, "a row has more ports than are provided for");
  for (size_t i = 0; i < count; ++i) {
    in[i] = read(operands[i]);
    types[i] = operands[i].needed;
    if (operands[i].from == From::setting) settings[i] = operands[i].index;
  }
  nodes::Site site{b_,
                   std::span<const Value>(in).first(count),
                   std::span<const Type>(types).first(count),
                   std::span<const uint32_t>(settings).first(count),
                   graph_.types_of(node),
                   out};
  nodes::lower(row, site);
}

Value Body::transform(nodes::Transform what, const Node& node) {
  ir::ValueId at = read(graph_.operands_of(node)[0]).id();
  for (const SpaceStep step : steps_between_spaces(graph_, node, what)) {
    const std::array<ir::ValueId, 4>& columns = environment_.matrices[static_cast<size_t>(step.matrix)];
    std::vector<ir::ValueId> arguments(columns.begin(), columns.begin() + 3);
    if (step.transposed) arguments = functions::call_library(b_, "transpose", arguments);
    arguments.push_back(at);
    at = functions::call_library(b_, "transform", arguments).front();
    if (what == nodes::Transform::point) at = b_.op(ir::Opcode::fadd, {at, columns[3]});
  }
  if (what != nodes::Transform::normal) return at;
  return functions::call_library(b_, "normalize", std::array{at}).front();
}

Value Body::image(uint32_t index) {
  namespace port = nodes::image_port;
  using nodes::AddressMode;
  const Node& node = graph_.nodes[index];
  const std::span<const Operand> operands = graph_.operands_of(node);
  const ir::ValueId texture = environment_.image_slots[environment_.images->of_node.at(index)[0]];
  const ir::ValueId otherwise = read(operands[port::default_value]).id();
  const ir::ValueId texcoord = read(operands[port::texcoord]).id();
  const Sampling sampling = sampling_of(graph_, node);
  const auto number = [&](size_t port) {
    return operands[port].from == From::input ? read(operands[port]).id() : ir::none;
  };
  Chosen chosen{number(port::filtertype), number(port::uaddressmode), number(port::vaddressmode),
                check::may_be_trilinear(graph_, node)};
  if (check::reads_layers(graph_, node)) chosen.layer = read(operands[port::layer]).id();
  const auto picture = [&] {
    const ir::ValueId color = sample(b_, environment_.interface, sampling, texture, texcoord, chosen);
    std::array<ir::ValueId, 4> components;
    const auto width = static_cast<size_t>(graph::float_count(graph_.types_of(node)[0]));
    for (uint32_t i = 0; i < width; ++i) components[i] = b_.extract(color, i);
    ir::ValueId result =
        width == 4 ? color : b_.construct(std::span<const ir::ValueId>(components).first(width));
    for (const uint32_t axis : {0u, 1u}) {
      const ir::ValueId mode = axis == 0 ? chosen.u : chosen.v;
      const uint32_t input = axis == 0 ? sampling.u_input : sampling.v_input;
      constexpr auto constant = static_cast<int>(AddressMode::constant);
      const bool may_be = input == ir::none ? (axis == 0 ? sampling.u : sampling.v) == AddressMode::constant
                                            : graph_.graph.inputs[input].names.size() > constant;
      if (!may_be) continue;
      const ir::ValueId at = b_.extract(texcoord, axis);
      const ir::ValueId from_0 = b_.op(ir::Opcode::fge, {at, b_.constant(0.0f)});
      const ir::ValueId to_1 = b_.op(ir::Opcode::fle, {at, b_.constant(1.0f)});
      ir::ValueId inside = b_.op(ir::Opcode::band, {from_0, to_1});
      if (mode != ir::none)
        inside = b_.op(ir::Opcode::bor, {inside, b_.op(ir::Opcode::ilt, {mode, b_.constant(constant)})});
      result = b_.op(ir::Opcode::select, {inside, result, otherwise});
    }
    return std::vector{result};
  };
  const ir::ValueId there = b_.op(ir::Opcode::ige, {texture, b_.constant(0)});
  return b_.branch(there, picture, [&] { return std::vector{otherwise}; }).front();
}

Value Body::environment(nodes::Environment what, const Node& node) {
  const std::span<const Operand> operands = graph_.operands_of(node);
  const bool is_radiance = what == nodes::Environment::radiance;
  const interface::Host host = is_radiance ? interface::Host::environment : interface::Host::irradiance;
  std::vector<ir::ValueId> arguments;
  for (const Operand& operand : operands.first(operands.size() - 1)) arguments.push_back(read(operand).id());
  const ir::ValueId otherwise = read(operands.back()).id();
  const auto arriving = [&] { return b_.call(environment_.interface.find(host), arguments); };
  return b_.branch(environment_.has_environment, arriving, [&] { return std::vector{otherwise}; }).front();
}

ir::ValueId Body::argument(const interface::Binding& binding, const Node& node,
                           std::span<const uint32_t> image_slots, Value& input) {
  namespace source = interface::source;
  const auto only_posts = [&]() -> ir::ValueId { support::bug("a function has " + binding.parameter.name); };
  return std::visit(
      interface::Cases{
          [&](const source::Attribute& s) { return environment_.surface[s.value.index()]; },
          [&](const source::MatrixColumn& s) {
            return environment_.matrices[static_cast<size_t>(s.matrix)][s.column];
          },
          [&](const source::Time&) { return environment_.time; },
          [&](const source::PassRepetition& s) { return environment_.repetition[static_cast<size_t>(s.what)]; },
          [&](const source::Input& s) {
            if (s.column == 0) input = read(graph_.operands_of(node)[s.input]);
            return input.ids()[s.column];
          },
          [&](const source::Image& s) { return environment_.image_slots[image_slots[s.slot]]; },
          [&](const source::LightCount&) { return environment_.light_count; },
          [&](const source::FirstLight&) { return environment_.first_light; },
          [&](const source::HasEnvironment&) { return environment_.has_environment; },
          [&](const source::ScreenValue&) { return only_posts(); },
          [&](const source::PixelOfImage&) { return only_posts(); },
          [&](const source::OffsetInPixel&) { return only_posts(); },
          [&](const source::SizeOfImage&) { return only_posts(); },
          [&](const source::TapCount&) { return only_posts(); },
      },
      binding.source);
}

void Body::make_call(uint32_t index) {
  const Node& node = graph_.nodes[index];
  const Callee& callee = environment_.callee_of(*node.callee);
  std::span<const uint32_t> image_slots;
  if (node.callee->needs(check::StageNeed::images)) image_slots = environment_.images->of_node.at(index);
  std::vector<ir::ValueId> arguments;
  Value input;
  for (const interface::Binding& binding : callee.bindings)
    arguments.push_back(argument(binding, node, image_slots, input));
  const std::vector<ir::ValueId> results = b_.call(callee.function, arguments);
  std::span<const ir::ValueId> rest(results);
  const std::span<const Type> types = graph_.types_of(node);
  for (size_t i = 0; i < types.size(); ++i) {
    const size_t columns = nodes::column_count(types[i]);
    results_of(node)[i] = Value(rest.first(columns));
    rest = rest.subspan(columns);
  }
}

/// How far from the pixel a node reads; none where it is written as 0.
FetchOffset Body::offset(nodes::Fetch what, std::span<const Operand> ports) {
  namespace port = nodes::fetch_port;
  const auto value = [&](const Operand& operand, size_t words) {
    const bool is_written = operand.from == From::words;
    const auto is_zero = [](uint32_t word) { return word == 0; };
    if (is_written && std::ranges::all_of(std::span(graph_.words).subspan(operand.index, words), is_zero))
      return ir::none;
    return read(operand).id();
  };
  return {value(ports[port::offset_x(what)], 1), value(ports[port::offset_y(what)], 1),
          value(ports[port::shift(what)], 2)};
}

void Body::make_fetch(const Node& node) {
  namespace port = nodes::fetch_port;
  const auto what = std::get<nodes::Fetch>(node.row->lowering);
  const std::span<const Operand> ports = graph_.operands_of(node);
  const std::span<Value> out = results_of(node);
  const auto edge = static_cast<nodes::Edge>(ports[port::edge(what)].index);
  if (what == nodes::Fetch::color) {
    const ReadImage& image = environment_.screen.images[post_image(ports[port::image].index)];
    const ColorFilter filter{edge, ports[port::filter].index == 1, ports[port::nonfinite].index == 1};
    out[0] = fetch_color(b_, image, offset(what, ports), filter);
    return;
  }
  if (what == nodes::Fetch::motion) {
    const ReadImage& image = environment_.screen.images[motion_image(graph_)];
    const ir::ValueId read = fetch_color(b_, image, offset(what, ports), {edge, false, false}).id();
    out[0] = b_.construct(std::array{b_.extract(read, 0), b_.extract(read, 1)});
    return;
  }
  out[0] = fetch_depth(b_, environment_.screen.images[depth_image], offset(what, ports), edge);
  if (environment_.screen[interface::Screen::depth_numerator] != ir::none) out[1] = distance_of(b_, environment_.screen, out[0].id());
  out[2] = b_.op(ir::Opcode::feq, {out[0].id(), b_.constant(0.0f)});
}

std::vector<uint32_t> Body::nodes_under(uint32_t sum) {
  if (position_.empty()) {
    position_.resize(graph_.nodes.size());
    for (uint32_t i = 0; i < graph_.order.size(); ++i) position_[graph_.order[i]] = i;
  }
  std::vector<uint32_t> found{sum};
  for (size_t next = 0; next < found.size(); ++next) {
    for (const Operand& operand : graph_.operands_of(graph_.nodes[found[next]])) {
      if (operand.from != From::node || summed_by_[operand.index] == sum) continue;
      if (!graph_.nodes[operand.index].per_iteration) continue;
      summed_by_[operand.index] = sum;
      found.push_back(operand.index);
    }
  }
  found.erase(found.begin());
  std::ranges::sort(found, {}, [&](uint32_t node) { return position_[node]; });
  return found;
}

void Body::make_sum(uint32_t index) {
  const Node& node = graph_.nodes[index];
  const Operand& summand = graph_.operands_of(node)[0];
  const std::vector<uint32_t> inside = nodes_under(index);
  const bool asks_light = std::ranges::any_of(inside, [&](uint32_t i) {
    return graph_.nodes[i].row != nullptr && graph_.nodes[i].row->is<nodes::Light>();
  });
  const bool asks_color = sums_colors(graph_, index);
  const std::vector<uint32_t> zero(graph::float_count(summand.needed), 0);
  const Value initial = nodes::constant(b_, summand.needed, zero);
  const auto body = [&](ir::ValueId turn, std::span<const ir::ValueId> carried) {
    if (node.row->is<nodes::SumTaps>()) {
      const auto first = static_cast<int32_t>(graph_.operands_of(node)[1].index);
      tap_ = first == 0 ? turn : b_.op(ir::Opcode::iadd, {turn, b_.constant(first)});
    }
    if (asks_light) {
      b_.set_origin(add_origin("light", index));
      const ir::ValueId first = environment_.first_light;
      const ir::ValueId light = first == ir::none ? turn : b_.op(ir::Opcode::iadd, {first, turn});
      const std::array arguments{light, environment_.surface[shown_position.index()]};
      light_ = b_.call(environment_.interface.find(interface::Host::light), arguments);
    }
    for (const uint32_t i : inside) make(i);
    b_.set_origin(origin_of(index));
    const ir::ValueId sum = b_.op(ir::Opcode::fadd, {carried[0], read(summand).id()});
    // A choice of sums and not of terms: to add 0 would make a sum of -0 positive.
    return std::vector{asks_color ? b_.op(ir::Opcode::select, {is_lit(), sum, carried[0]}) : sum};
  };
  results_of(node)[0] = b_.loop(turns_of(index), initial.ids(), body).front();
}

/// Whether any light arrives from the light of the current loop.
ir::ValueId Body::is_lit() {
  const ir::ValueId color = light_[static_cast<size_t>(nodes::Light::color)], zero = b_.constant(0.0f);
  ir::ValueId lit = ir::none;
  for (uint32_t c = 0; c < 3; ++c) {
    const ir::ValueId shines = b_.op(ir::Opcode::fne, {b_.extract(color, c), zero});
    lit = c == 0 ? shines : b_.op(ir::Opcode::bor, {lit, shines});
  }
  return lit;
}

ir::ValueId Body::turns_of(uint32_t sum) {
  if (graph_.nodes[sum].row->is<nodes::SumLights>()) return environment_.light_count;
  for (const auto& [node, count] : environment_.screen.tap_counts)
    if (node == sum) return count;
  support::bug("a sum over taps without a count");
}

void Body::name_value(const Value& value, uint32_t origin, ir::ValueId first_new) {
  for (const ir::ValueId id : value.ids())
    if (id >= first_new) b_.name(id, origin);
}

void Body::name_results(uint32_t index, ir::ValueId first_new) {
  if (is_inside_expression_[index]) return;
  const Node& node = graph_.nodes[index];
  const std::span<const Value> results = results_of(node);
  const bool summand = node.row != nullptr && node.row->is_summand();
  if (summand) {
    b_.name(results[0].id(), origin_of(index));
  } else if (results.size() == 1) {
    name_value(results[0], origin_of(index), first_new);
  } else {
    // Several outputs: each is the node's name and its own.
    const std::string id = graph_.graph.nodes[index].id;
    for (size_t i = 0; i < results.size(); ++i) {
      const std::string output =
          node.row != nullptr ? std::string(node.row->outputs[i].name) : node.callee->graph.outputs[i].name;
      name_value(results[i], add_origin(id + "_" + output, index), first_new);
    }
  }
}

}  // namespace

std::vector<Value> build_body(ir::Builder& builder, const check::TypedGraph& graph, const Needs& needs,
                              const Environment& environment, std::span<const Operand> results) {
  Body body(builder, graph, environment);
  // Nodes that depend on the light or the tap are made inside of the loops that sum them.
  for (const uint32_t node : graph.order)
    if (needs.nodes[node] && !graph.nodes[node].per_iteration) body.make(node);
  std::vector<Value> values;
  for (const Operand& result : results) values.push_back(body.read(result));
  return values;
}

}  // namespace isoshade::lower
