// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/screen.h"

#include <algorithm>
#include <functional>

#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"

namespace isoshade::lower {
namespace {

using interface::Axis;
using interface::Binding;
using interface::Screen;
using nodes::Edge;

/// What the greatest coordinate of a scene is: farther away there is nothing.
constexpr float greatest_distance = 1e9f;

/// The group of values.def whose values are not the same for all pixels.
constexpr std::string_view place_group = "screen";

/// What names of an image begin with: "depth", "color" or "image_NAME".
std::string prefix_of(const check::TypedGraph& graph, interface::ImageNumber image) {
  if (image == depth_image) return "depth";
  return image == post_image(0) ? "color" : "image_" + graph.graph.images[image - post_image(1)].name;
}

/// Whether an offset of an image may be other than 0.
bool is_offset(const check::TypedGraph& graph, const check::Operand& operand) {
  return operand.from != check::Operand::From::words || graph.words[operand.index] != 0;
}

bool is_shift(const check::TypedGraph& graph, const check::Operand& operand) {
  return operand.from != check::Operand::From::words || graph.words[operand.index] != 0 ||
         graph.words[operand.index + 1] != 0;
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
  images.resize(post_image(graph.graph.images.size()) + 1);
  const auto need = [&](Screen value) { values[static_cast<size_t>(value)] = true; };
  const auto fetch = [&](nodes::Fetch what, ImageNeeds& image, bool linear) {
    namespace port = nodes::fetch_port;
    const bool shifted = is_shift(graph, ports[port::shift(what)]);
    image.read = true;
    image.inside |= linear || shifted;
    image.size |= linear || shifted || is_offset(graph, ports[port::offset_x(what)]) ||
                  is_offset(graph, ports[port::offset_y(what)]);
  };
  if (const auto* value = std::get_if<nodes::Screen>(&node.row->lowering)) need(*value);
  if (const auto* what = std::get_if<nodes::Fetch>(&node.row->lowering)) {
    switch (*what) {
      case nodes::Fetch::color:
        fetch(*what, images[post_image(ports[nodes::fetch_port::image].index)], ports[nodes::fetch_port::filter].index == 1);
        break;
      case nodes::Fetch::depth: fetch(*what, images[depth_image], false); break;
      case nodes::Fetch::motion: fetch(*what, images[motion_image(graph)], false); break;
    }
  }
  if (node.row->is<nodes::WorldPosition>()) {
    images[depth_image].read = true;
    for (const Screen value :
         {Screen::view_ray, Screen::relative_origin, Screen::depth_numerator, Screen::depth_denominator})
      need(value);
    if (ports[0].index == 0) need(Screen::camera_position);
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
  if (what != nullptr && *what == nodes::Fetch::depth && operand.output == linear)
    for (const Screen value : {Screen::depth_numerator, Screen::depth_denominator})
      values[static_cast<size_t>(value)] = true;
}

interface::ImageNumber motion_image(const check::TypedGraph& graph) {
  const auto& images = graph.graph.images;
  const auto found = std::ranges::find(images, graph::motion_image_name, &graph::InputImage::name);
  support::assert_that(found != images.end(), "a graph that reads the motion lacks its image");
  return post_image(1 + static_cast<size_t>(found - images.begin()));
}

std::vector<TapSum> tap_sums(const check::TypedGraph& graph) {
  std::vector<TapSum> sums;
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) {
    const check::Node& node = graph.nodes[i];
    if (node.row == nullptr || !node.row->is<nodes::SumTaps>()) continue;
    const std::span<const check::Operand> ports = graph.operands_of(node);
    const int first = static_cast<int32_t>(ports[1].index), last = static_cast<int32_t>(ports[2].index);
    sums.push_back({i, last - first + 1});
  }
  return sums;
}

void declare_reads(ir::Module& module, interface::Interface& host, const check::TypedGraph& graph,
                   const ScreenNeeds& needs) {
  for (interface::ImageNumber image = 0; image < needs.images.size(); ++image) {
    if (!needs.images[image].read) continue;
    const bool is_depth = image == depth_image;
    if (host.find(is_depth ? interface::Host::depth : interface::Host::image, image) != ir::none) continue;
    host.host.push_back({is_depth ? interface::Host::depth : interface::Host::image,
                         static_cast<uint32_t>(module.functions.size()), image});
    ir::Function& function = module.functions.emplace_back();
    function.name = prefix_of(graph, image) + "_at";
    function.parameters = {int_parameter("x"), int_parameter("y")};
    function.results = {{is_depth ? "depth" : "color", is_depth ? ir::float_type : ir::vector_type(4)}};
  }
}

std::vector<Binding> screen_bindings(const check::TypedGraph& graph, const ScreenNeeds& needs) {
  std::vector<Binding> bindings;
  const auto add_values = [&](std::string_view group) {
    for (size_t i = 0; i < interface::screen_value_count; ++i)
      if (const auto value = static_cast<Screen>(i); needs.values[i] && interface::row(value).group == group)
        bindings.push_back(interface::bind(value));
  };
  const auto add_images = [&](const std::function<void(interface::ImageNumber, const ImageNeeds&)>& add) {
    for (interface::ImageNumber image = 0; image < needs.images.size(); ++image)
      if (needs.images[image].read) add(image, needs.images[image]);
  };
  add_values(place_group);
  add_images([&](interface::ImageNumber image, const ImageNeeds& needed) {
    const std::string prefix = prefix_of(graph, image);
    for (const Axis axis : {Axis::x, Axis::y}) bindings.push_back(interface::bind_pixel(image, prefix, axis));
    if (needed.inside) bindings.push_back(interface::bind_offset(image, prefix));
  });
  add_values("sizes");
  add_images([&](interface::ImageNumber image, const ImageNeeds& needed) {
    if (!needed.size) return;
    for (const Axis axis : {Axis::x, Axis::y})
      bindings.push_back(interface::bind_size(image, prefix_of(graph, image), axis));
  });
  add_values("camera");
  return bindings;
}

std::vector<Binding> tap_bindings(const check::TypedGraph& graph, const ScreenNeeds& needs) {
  std::vector<Binding> bindings;
  for (const TapSum& sum : tap_sums(graph))
    if (std::ranges::find(needs.sums, sum.node) != needs.sums.end())
      bindings.push_back(interface::bind_taps(sum.node, graph.graph.nodes[sum.node].id, sum.taps));
  return bindings;
}

namespace {

/// The pixel of an image that lies at an offset, and where in it: a vec2, or none.
struct Spot {
  ir::ValueId x, y, inside;
  bool may_be_outside;
};

Spot spot_at(ir::Builder& b, const ReadImage& image, const FetchOffset& offset) {
  Spot spot{moved(b, image.x, offset.x), moved(b, image.y, offset.y), image.inside,
            offset.x != ir::none || offset.y != ir::none || offset.shift != ir::none};
  if (offset.shift == ir::none) return spot;
  const Vec2 shift(b, offset.shift), inside(b, image.inside);
  // Farther than any image is wide, and still an int.
  constexpr float most = 2.0f * static_cast<float>(interface::max_size);
  const Float farthest(most), least(-most);
  std::vector<ir::ValueId> rest;
  const auto move = [&](int axis, ir::ValueId& pixel, ir::ValueId size) {
    const Float wanted = inside[axis] + shift[axis] * to_float(Int(b, size));
    const Float not_before = select(wanted > least, wanted, least);  // of NaN, too
    const Float place = select(not_before < farthest, not_before, farthest);
    const Float whole = floor(place);
    pixel = b.op(ir::Opcode::iadd, {pixel, to_int(whole).id(b)});
    rest.push_back((place - whole).id(b));
  };
  move(0, spot.x, image.width);
  move(1, spot.y, image.height);
  spot.inside = b.construct(rest);
  return spot;
}

}  // namespace

nodes::Value fetch_color(ir::Builder& b, const ReadImage& image, const FetchOffset& offset,
                         const ColorFilter& filter) {
  const Spot spot = spot_at(b, image, offset);
  const auto guarded = [&](ir::ValueId color) {
    const Vec4 read(b, color);
    return filter.finite_only ? finite_or_zero(read) : read;
  };
  if (!filter.linear) {
    if (!spot.may_be_outside) return guarded(b.call(image.at, std::array{spot.x, spot.y})[0]).value;
    return guarded(read(b, image, spot.x, spot.y, filter.edge)).value;
  }
  const Vec2 inside(b, spot.inside);
  const Between across = between(Int(b, spot.x), inside[0]), down = between(Int(b, spot.y), inside[1]);
  const auto row = [&](Int at) {
    const Vec4 left = guarded(read(b, image, across.lower.value, at.value, filter.edge));
    const Vec4 right = guarded(read(b, image, across.upper.value, at.value, filter.edge));
    return mix(left, right, across.part);
  };
  const Vec4 upper = row(down.lower), lower = row(down.upper);
  return mix(upper, lower, down.part).value;
}

ir::ValueId fetch_depth(ir::Builder& b, const ReadImage& depth, const FetchOffset& offset, Edge edge) {
  const Spot spot = spot_at(b, depth, offset);
  if (!spot.may_be_outside) return b.call(depth.at, std::array{spot.x, spot.y})[0];
  return read(b, depth, spot.x, spot.y, edge);
}

ir::ValueId distance_of(ir::Builder& b, const ScreenInputs& screen, ir::ValueId depth) {
  const Vec2 above(b, screen[Screen::depth_numerator]), below(b, screen[Screen::depth_denominator]);
  const Float z(b, depth);
  return min((above[0] + z * above[1]) / (below[0] + z * below[1]), Float(greatest_distance)).value;
}

ir::ValueId relative_position(ir::Builder& b, const ScreenInputs& screen) {
  const ir::ValueId depth = fetch_depth(b, screen.images[depth_image], {}, Edge::clamp);
  const Float distance(b, distance_of(b, screen, depth));
  const Vec3 origin(b, screen[Screen::relative_origin]), ray(b, screen[Screen::view_ray]);
  return (origin + ray * functions::splat<3>(distance)).value;
}

bool is_pointwise(const Lowered& post) {
  namespace source = interface::source;
  const auto& [module, interface] = post;
  std::vector<ir::ValueId> own_pixel;
  for (size_t i = 0; i < interface.bindings.size(); ++i) {
    const interface::Source& from = interface.bindings[i].source;
    const auto* screen = std::get_if<source::ScreenValue>(&from);
    const bool needs_grid = std::holds_alternative<source::OffsetInPixel>(from) ||
                            std::holds_alternative<source::SizeOfImage>(from) ||
                            std::holds_alternative<source::TapCount>(from) ||
                            (screen != nullptr && (screen->value == interface::Screen::pixel ||
                                                   screen->value == interface::Screen::size));
    if (needs_grid) return false;
    if (std::holds_alternative<source::PixelOfImage>(from))
      own_pixel.push_back(module.functions[interface.entry].blocks[0].parameters[i]);
  }
  for (uint32_t f = 0; f < module.functions.size(); ++f) {
    const ir::Function& function = module.functions[f];
    for (const ir::Instruction& instruction : function.instructions) {
      const interface::HostFunction* const read =
          instruction.op == ir::Opcode::call ? interface.find(instruction.imm) : nullptr;
      if (read == nullptr || read->image == ir::none) continue;
      const bool is_own_image = read->image == interface::image_record::depth || read->image == interface::image_record::color;
      const bool is_own_pixel = std::ranges::all_of(function.operands_of(instruction), [&](ir::ValueId operand) {
        return std::ranges::find(own_pixel, operand) != own_pixel.end();
      });
      if (f != interface.entry || !is_own_image || !is_own_pixel) return false;
    }
  }
  return true;
}

bool ignores_place(const Lowered& post) {
  // The number of a pixel is passed to reads of it alone, see is_pointwise().
  return std::ranges::none_of(post.interface.bindings, [](const Binding& binding) {
    const auto* screen = std::get_if<interface::source::ScreenValue>(&binding.source);
    return screen != nullptr && interface::row(screen->value).group == place_group;
  });
}

}  // namespace isoshade::lower
