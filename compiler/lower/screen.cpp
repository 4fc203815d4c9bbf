// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/screen.h"

#include <algorithm>

#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/stages.h"

namespace isoshade::lower {
namespace {

using nodes::Edge;

/// What the greatest coordinate of a scene is: farther away there is nothing.
constexpr float greatest_distance = 1e9f;

struct ScreenValue {
  nodes::Screen what;
  const char* group;
  const char* name;
  int width;
};
constexpr ScreenValue screen_values[] = {
    {nodes::Screen::pixel, screen_group, "pixel", 2},
    {nodes::Screen::coordinate, screen_group, "coordinate", 2},
    {nodes::Screen::view_ray, screen_group, "view_ray", 3},
    {nodes::Screen::relative_origin, screen_group, "relative_origin", 3},
    {nodes::Screen::size, sizes_group, "screen", 2},
    {nodes::Screen::camera_position, camera_group, "position", 3},
    {nodes::Screen::camera_direction, camera_group, "direction", 3},
};
static_assert(std::size(screen_values) == nodes::screen_value_count);

/// An image that is read, and how its names begin.
struct NamedImage {
  std::string prefix;
  ImageNeeds needs;
};
std::vector<NamedImage> images_read(const check::TypedGraph& graph, const ScreenNeeds& needs) {
  std::vector<NamedImage> all;
  if (needs.depth.read) all.push_back({std::string(depth_prefix), needs.depth});
  for (size_t i = 0; i < needs.images.size(); ++i)
    if (needs.images[i].read) all.push_back({image_prefix(graph, i), needs.images[i]});
  return all;
}

/// Whether an offset of an image may be other than 0.
bool is_offset(const check::TypedGraph& graph, const check::Operand& operand) {
  return operand.from != check::Operand::From::words || graph.words[operand.index] != 0;
}

/// edge_clamp(at, size): a pixel of the image, for any coordinate.
uint32_t edge_clamp(ir::Module& module) {
  if (const uint32_t found = module.find("edge_clamp"); found != ir::none) return found;
  Kernel k(module, "edge_clamp", {int_parameter("at"), uniform_int("size")}, {{"place", ir::int_type}});
  const Int at = k.integer(0), last = k.named("last", k.integer(1) - Int(1));
  const Int not_after = k.named("not_after", select(at > last, last, at));
  k.b.finish(std::array{select(not_after < Int(0), Int(0), not_after).value});
  return k.index;
}

/// edge_mirror(at, size): beyond an edge the image is mirrored at it, once; further out its last pixel.
uint32_t edge_mirror(ir::Module& module) {
  if (const uint32_t found = module.find("edge_mirror"); found != ir::none) return found;
  const uint32_t clamp = edge_clamp(module);
  Kernel k(module, "edge_mirror", {int_parameter("at"), uniform_int("size")}, {{"place", ir::int_type}});
  const Int at = k.integer(0), size = k.integer(1);
  const Int before = k.named("before", Int(-1) - at);
  const Int after = k.named("after", k.named("twice", shift_left(size, Int(1))) + before);
  const Int mirrored = k.named("mirrored", select(at < Int(0), before, select(at >= size, after, at)));
  k.b.finish(k.b.call(clamp, std::array{mirrored.value, size.value}));
  return k.index;
}

/// The pixel (x, y) of an image, by the rule for what lies beyond it.
ir::ValueId read(ir::Builder& b, const ReadImage& image, ir::ValueId x, ir::ValueId y, Edge edge) {
  const uint32_t rule = edge == Edge::mirror ? edge_mirror(b.module()) : edge_clamp(b.module());
  const ir::ValueId inside_x = b.call(rule, std::array{x, image.width})[0];
  const ir::ValueId inside_y = b.call(rule, std::array{y, image.height})[0];
  const ir::ValueId value = b.call(image.at, std::array{inside_x, inside_y})[0];
  if (edge != Edge::constant) return value;
  const Bool is_inside = (Int(b, inside_x) == Int(b, x)) & (Int(b, inside_y) == Int(b, y));
  const ir::ValueId zero = b.constant(0.0f);
  const ir::ValueId nothing =
      b.type(value).width == 4 ? b.construct(std::array{zero, zero, zero, zero}) : zero;
  return b.op(ir::Opcode::select, {is_inside.value, value, nothing});
}

ir::ValueId moved(ir::Builder& b, ir::ValueId at, ir::ValueId offset) {
  return offset == ir::none ? at : b.op(ir::Opcode::iadd, {at, offset});
}

/// The lower of the two pixels whose centres lie around a place, and how far it is from that to the other.
struct Between {
  Int lower, upper;
  Float part;
};
Between between(Int pixel, Float inside) {
  const Float from_centre = inside - Float(0.5f);
  const Bool before = from_centre < Float(0.0f);
  const Int lower = select(before, pixel - Int(1), pixel);
  return {lower, lower + Int(1), select(before, from_centre + Float(1.0f), from_centre)};
}

}  // namespace

void ScreenNeeds::add(const check::TypedGraph& graph, uint32_t index) {
  const check::Node& node = graph.nodes[index];
  const std::span<const check::Operand> ports = graph.operands_of(node);
  images.resize(1 + graph.graph.images.size());
  const auto need = [&](nodes::Screen value) { values[static_cast<size_t>(value)] = true; };
  const auto fetch = [&](ImageNeeds& image, size_t first_offset, bool linear) {
    image.read = true;
    image.inside |= linear;
    image.size |=
        linear || is_offset(graph, ports[first_offset]) || is_offset(graph, ports[first_offset + 1]);
  };
  if (const auto* value = std::get_if<nodes::Screen>(&node.row->lowering)) need(*value);
  if (const auto* what = std::get_if<nodes::Fetch>(&node.row->lowering)) {
    if (*what == nodes::Fetch::color) fetch(images[ports[0].index], 1, ports[4].index == 1);
    if (*what == nodes::Fetch::depth) fetch(depth, 0, false);
  }
  if (node.row->is<nodes::WorldPosition>()) {
    depth.read = distance = true;
    need(nodes::Screen::view_ray);
    need(nodes::Screen::relative_origin);
    if (ports[0].index == 0) need(nodes::Screen::camera_position);
  }
  if (node.row->is<nodes::SumTaps>()) {
    sums.push_back(index);
    std::ranges::sort(sums);
  }
}

void ScreenNeeds::add(const check::TypedGraph& graph, const check::Operand& operand) {
  if (operand.from != check::Operand::From::node) return;
  const nodes::Row* row = graph.nodes[operand.index].row;
  const auto* what = row != nullptr ? std::get_if<nodes::Fetch>(&row->lowering) : nullptr;
  constexpr uint32_t linear = 1;  // of the outputs of scenedepth
  if (what != nullptr && *what == nodes::Fetch::depth && operand.output == linear) distance = true;
}

std::string image_prefix(const check::TypedGraph& graph, size_t image) {
  return image == 0 ? "color" : "image_" + graph.graph.images[image - 1].name;
}

std::vector<std::string> screen_function_names(const check::TypedGraph& graph) {
  std::vector<std::string> names = {"post", post_name, "edge_clamp", "edge_mirror", "under", "depth_at"};
  for (size_t i = 0; i <= graph.graph.images.size(); ++i) names.push_back(image_prefix(graph, i) + "_at");
  return names;
}

std::vector<std::pair<std::string, int>> tap_counts(const check::TypedGraph& graph) {
  std::vector<std::pair<std::string, int>> counts;
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    const check::Node& node = graph.nodes[i];
    if (node.row == nullptr || !node.row->is<nodes::SumTaps>()) continue;
    const std::span<const check::Operand> ports = graph.operands_of(node);
    const int first = static_cast<int32_t>(ports[1].index), last = static_cast<int32_t>(ports[2].index);
    counts.emplace_back(graph.graph.nodes[i].id, last - first + 1);
  }
  return counts;
}

void declare_reads(ir::Module& module, const check::TypedGraph& graph, const ScreenNeeds& needs) {
  for (const auto& [prefix, image] : images_read(graph, needs)) {
    ir::Function& function = module.functions.emplace_back();
    function.name = prefix + "_at";
    function.parameters = {{"x", ir::int_type, "", false}, {"y", ir::int_type, "", false}};
    const bool is_depth = prefix == depth_prefix;
    function.results = {{is_depth ? "depth" : "color", is_depth ? ir::float_type : ir::vector_type(4)}};
  }
}

void add_screen_parameters(ir::Function& function, const check::TypedGraph& graph, const ScreenNeeds& needs) {
  const auto add = [&](std::string name, ir::Type type, const char* group) {
    function.parameters.push_back({std::move(name), type, group, std::string_view(group) != screen_group});
  };
  const auto add_values = [&](const char* group) {
    for (const ScreenValue& value : screen_values)
      if (std::string_view(value.group) == group && needs.values[static_cast<size_t>(value.what)])
        add(value.name, ir::vector_type(value.width), group);
  };
  add_values(screen_group);
  for (const auto& [prefix, image] : images_read(graph, needs)) {
    add(prefix + "_x", ir::int_type, screen_group);
    add(prefix + "_y", ir::int_type, screen_group);
    if (image.inside) add(prefix + "_inside", ir::vector_type(2), screen_group);
  }
  add_values(sizes_group);
  for (const auto& [prefix, image] : images_read(graph, needs)) {
    if (!image.size) continue;
    add(prefix + "_width", ir::int_type, sizes_group);
    add(prefix + "_height", ir::int_type, sizes_group);
  }
  add_values(camera_group);
  if (!needs.distance) return;
  add("depth_numerator", ir::vector_type(2), camera_group);
  add("depth_denominator", ir::vector_type(2), camera_group);
}

void add_tap_parameters(ir::Function& function, const check::TypedGraph& graph, const ScreenNeeds& needs) {
  for (const uint32_t node : needs.sums)
    function.parameters.push_back({graph.graph.nodes[node].id, ir::int_type, taps_group, true});
}

ScreenInputs screen_inputs(ir::Builder& b, const check::TypedGraph& graph, const ScreenNeeds& needs) {
  const auto value = [&](const char* group, const std::string& name) {
    const std::vector<ir::Parameter>& parameters = b.function().parameters;
    for (size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].group == group && parameters[i].name == name) return b.parameter(i);
    support::bug("post_process has no " + name);
  };
  const auto image = [&](const std::string& prefix, const ImageNeeds& of) {
    ReadImage read;
    if (!of.read) return read;
    read.x = value(screen_group, prefix + "_x");
    read.y = value(screen_group, prefix + "_y");
    if (of.inside) read.inside = value(screen_group, prefix + "_inside");
    if (of.size) read.width = value(sizes_group, prefix + "_width");
    if (of.size) read.height = value(sizes_group, prefix + "_height");
    read.at = b.module().find(prefix + "_at");
    return read;
  };
  ScreenInputs inputs;
  for (const ScreenValue& screen : screen_values)
    if (const auto i = static_cast<size_t>(screen.what); needs.values[i])
      inputs.values[i] = value(screen.group, screen.name);
  inputs.depth = image(std::string(depth_prefix), needs.depth);
  for (size_t i = 0; i < needs.images.size(); ++i)
    inputs.images.push_back(image(image_prefix(graph, i), needs.images[i]));
  if (needs.distance) {
    inputs.depth_numerator = value(camera_group, "depth_numerator");
    inputs.depth_denominator = value(camera_group, "depth_denominator");
  }
  for (const uint32_t node : needs.sums)
    inputs.tap_counts.emplace_back(node, value(taps_group, graph.graph.nodes[node].id));
  return inputs;
}

nodes::Value fetch_color(ir::Builder& b, const ReadImage& image, ir::ValueId offset_x, ir::ValueId offset_y,
                         const ColorFilter& filter) {
  const ir::ValueId x = moved(b, image.x, offset_x), y = moved(b, image.y, offset_y);
  const auto guarded = [&](ir::ValueId color) {
    const Vec4 read(b, color);
    return filter.finite_only ? finite_or_zero(read) : read;
  };
  if (!filter.linear) {
    if (offset_x == ir::none && offset_y == ir::none)
      return guarded(b.call(image.at, std::array{x, y})[0]).value;
    return guarded(read(b, image, x, y, filter.edge)).value;
  }
  const Vec2 inside(b, image.inside);
  const Between across = between(Int(b, x), inside[0]), down = between(Int(b, y), inside[1]);
  const auto row = [&](Int at) {
    const Vec4 left = guarded(read(b, image, across.lower.value, at.value, filter.edge));
    const Vec4 right = guarded(read(b, image, across.upper.value, at.value, filter.edge));
    return mix(left, right, across.part);
  };
  const Vec4 upper = row(down.lower), lower = row(down.upper);
  return mix(upper, lower, down.part).value;
}

ir::ValueId fetch_depth(ir::Builder& b, const ReadImage& depth, ir::ValueId offset_x, ir::ValueId offset_y,
                        Edge edge) {
  const ir::ValueId x = moved(b, depth.x, offset_x), y = moved(b, depth.y, offset_y);
  if (offset_x == ir::none && offset_y == ir::none) return b.call(depth.at, std::array{x, y})[0];
  return read(b, depth, x, y, edge);
}

ir::ValueId distance_of(ir::Builder& b, const ScreenInputs& screen, ir::ValueId depth) {
  const Vec2 above(b, screen.depth_numerator), below(b, screen.depth_denominator);
  const Float z(b, depth);
  return min((above[0] + z * above[1]) / (below[0] + z * below[1]), Float(greatest_distance)).value;
}

ir::ValueId relative_position(ir::Builder& b, const ScreenInputs& screen) {
  const auto value = [&](nodes::Screen what) { return Vec3(b, screen.values[static_cast<size_t>(what)]); };
  const ir::ValueId depth = fetch_depth(b, screen.depth, ir::none, ir::none, Edge::clamp);
  const Float distance(b, distance_of(b, screen, depth));
  return (value(nodes::Screen::relative_origin) +
          value(nodes::Screen::view_ray) * functions::splat<3>(distance))
      .value;
}

}  // namespace isoshade::lower
