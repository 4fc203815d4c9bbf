// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/stages.h"

#include "compiler/lower/environment.h"
#include "compiler/lower/forward.h"
#include "compiler/lower/sampling.h"
#include "compiler/lower/shadow.h"
#include "compiler/lower/surface.h"

namespace isoshade::lower {

namespace {

/// wide_edge(x0, y0, x1, y1, px, py): one edge function, through 64 bits.
uint32_t add_wide_edge(ir::Module& module) {
  std::vector<ir::Parameter> parameters;
  for (const char* name : {"x0", "y0", "x1", "y1", "px", "py"}) parameters.push_back(int_parameter(name));
  Kernel k(module, interface::names::wide_edge, std::move(parameters), {{"edge", ir::float_type}});
  const auto at = [&](size_t parameter) { return k.integer(parameter); };
  k.b.finish(std::array{functions::edge_wide<Float>(at(0), at(1), at(2), at(3), at(4), at(5)).value});
  return k.index;
}

/// edges_at(x, y, triangle): the edge functions at the centre of a pixel.
void add_edges(ir::Module& module) {
  if (module.find("edges_at") != ir::none) return;
  const uint32_t wide_edge = add_wide_edge(module);
  Kernel k(module, "edges_at", {int_parameter("x"), int_parameter("y"), int_parameter("triangle")},
           {{"edges", ir::vector_type(3)}});
  const Int record = k.named("record", k.integer(2) * Int(triangle_word::stride));
  const auto word = [&](int at) { return k.load_int(FrameBuffer::triangles, record + Int(at)); };
  const Bool wide = k.named("wide", (word(triangle_word::object) & Int(triangle_flag::wide)) != Int(0));
  std::vector<Int> p;
  for (int i = 0; i < 6; ++i)
    p.push_back(
        k.named(std::string(1, "xy"[i % 2]) + std::to_string(i / 2), word(triangle_word::position + i)));
  const Int px = k.named("px", shift_left(k.integer(0), Int(8)) + Int(128));
  const Int py = k.named("py", shift_left(k.integer(1), Int(8)) + Int(128));
  const auto call_wide_edge = [&](auto... coordinates) {
    return Float(k.b, k.b.call(wide_edge, std::array{coordinates.id(k.b)...})[0]);
  };
  const Vec3 edges =
      functions::edge_functions<Float>(p[0], p[1], p[2], p[3], p[4], p[5], wide, px, py, call_wide_edge);
  k.b.finish(std::array{k.named("edges", edges.value)});
}

/// edges_at_ddx(x, y, triangle) and edges_at_ddy: what the edge functions change by from a pixel to the next. That is
/// the same all over the triangle, and exact. They are the source of all derivatives (passes/passes.h).
void add_edge_gradients(ir::Module& module) {
  for (const int axis : {0, 1}) {
    Kernel k(module, axis == 0 ? "edges_at_ddx" : "edges_at_ddy",
             {int_parameter("x"), int_parameter("y"), int_parameter("triangle")},
             {{"edges", ir::vector_type(3)}});
    const Int record = k.named("record", k.integer(2) * Int(triangle_word::stride));
    // The edge function from one vertex to the next grows by its x downwards, and falls by its y to the right.
    const auto coordinate = [&](int vertex) {
      const int word = triangle_word::position + 2 * (vertex % 3) + (1 - axis);
      return k.load_int(FrameBuffer::triangles, record + Int(word));
    };
    constexpr float pixel = 256.0f;
    const auto edge = [&](int from) {
      const Int along =
          axis == 0 ? coordinate(from) - coordinate(from + 1) : coordinate(from + 1) - coordinate(from);
      return to_float(along) * Float(pixel);
    };
    k.b.finish(std::array{Vec3(edge(1), edge(2), edge(0)).value});
  }
}

/// By the matrix of 4 columns of 4 in `view` from this word on.
Vec4 to_clip(Kernel& k, Int matrix, Vec3 position) {
  const auto column = [&](int i) { return k.load4(FrameBuffer::view, matrix, 4 * i); };
  return weighted<Vec4>({column(0), column(1), column(2)}, position) + column(3);
}

/// What surfaces and records give to the parameters of a document's function.
class SurfaceArguments {
 public:
  SurfaceArguments(Kernel& k, SurfacePoint& surface, Int object, const interface::RecordLayout& record,
                   ir::ValueId light_count, LightKinds lights = {.environment = false})
      : k_(k),
        surface_(surface),
        object_(object),
        record_(record),
        light_count_(light_count),
        lights_(lights) {}

  std::vector<ir::ValueId> of(const interface::Interface& interface) {
    std::vector<ir::ValueId> values;
    for (const interface::Binding& binding : interface.bindings) values.push_back(of(binding));
    return values;
  }

 private:
  ir::ValueId of(const interface::Binding& binding) {
    namespace source = interface::source;
    const ir::Parameter& parameter = binding.parameter;
    const auto field = [&](int word) { return load_field(k_, parameter.type, object_, word); };
    const auto screen = [&] {
      if (!screen_) screen_ = screen_arguments(k_);
      return screen_(binding);
    };
    const ir::ValueId value = std::visit(
        interface::Cases{
            [&](const source::Attribute& s) { return surface_.value(s.value); },
            [&](const source::MatrixColumn& s) { return surface_.column(s.matrix, s.column).value; },
            [&](const source::Time&) { return k_.load(FrameBuffer::frame, k_.constant(frame_word::time)).value; },
            [&](const source::PassRepetition& s) {
              return field(s.what == interface::Repetition::index ? object_word::pass_index : object_word::pass_count);
            },
            [&](const source::Input& s) { return field(column_word(record_, s, parameter.type)); },
            [&](const source::Image& s) { return field(record_.images[s.slot]); },
            [&](const source::LightCount&) { return lights_.lists ? field(object_word::light_count) : light_count_; },
            [&](const source::FirstLight&) { return field(object_word::first_light); },
            [&](const source::HasEnvironment&) { return has_environment(k_, lights_.environment); },
            [&](const source::ScreenValue&) { return screen(); },
            [&](const source::PixelOfImage&) { return screen(); },
            [&](const source::OffsetInPixel&) { return screen(); },
            [&](const source::SizeOfImage&) { return screen(); },
            [&](const source::TapCount&) -> ir::ValueId { support::bug("only posts have " + parameter.name); },
        },
        binding.source);
    if (value == light_count_ || std::holds_alternative<source::HasEnvironment>(binding.source)) return value;
    return k_.named(parameter.name, value);
  }

  Kernel& k_;
  SurfacePoint& surface_;
  Int object_;
  const interface::RecordLayout& record_;
  ir::ValueId light_count_;
  LightKinds lights_;
  std::function<ir::ValueId(const interface::Binding&)> screen_;  ///< made when it is first asked for
};

/// glTF KHR_lights_punctual: inverse square, windowed by the range if there is one.
Float distance_falloff(Kernel& k, Int record, Float squared_distance) {
  const Float inverse_range = k.load(FrameBuffer::lights, record, light_word::range);
  const Float ratio = squared_distance * inverse_range;
  const Float window = saturate(Float(1.0f) - ratio * ratio);
  return (window * window) / max(squared_distance, Float(1e-8f));
}

/// light_at(index, position); the index is that of a light, or of its place in a list.
void define_light_at(ir::Module& module, uint32_t function, LightKinds kinds) {
  if (kinds.shadows) add_shadow_at(module);
  Kernel k(module, function);
  const Int index = k.integer(0);
  const Int record = kinds.lists ? to_int(k.load(FrameBuffer::lights, index)) : index * Int(light_word::stride);
  k.b.finish(light_values(k, record, k.vector3(1), kinds));
}

}  // namespace

std::array<ir::ValueId, 2> light_values(Kernel& k, Int record, Vec3 position, LightKinds kinds) {
  const auto finish = [&](Vec3 direction, Vec3 color) {
    if (!kinds.shadows) return std::array{direction.value, color.value};
    // Nothing changes where no light arrives.
    const Float dark(0.0f);
    const Bool arrives = k.named("arrives", (color[0] != dark) | (color[1] != dark) | (color[2] != dark));
    const Float visible(k.b, k.call("shadow_at", {record.id(k.b), position.value})[0]);
    return std::array{direction.value, (color * functions::splat<3>(select(arrives, visible, Float(1.0f)))).value};
  };
  const Vec3 direction = k.load3(FrameBuffer::lights, record, light_word::direction);
  const Vec3 color = k.load3(FrameBuffer::lights, record, light_word::color);
  if (!kinds.point && !kinds.spot) return finish(direction, color);

  const Vec3 towards = k.load3(FrameBuffer::lights, record, light_word::position) - position;
  const Vec3 unit = normalize(towards);
  Float falloff = distance_falloff(k, record, dot(towards, towards));
  if (kinds.spot) {
    const Float scale = k.load(FrameBuffer::lights, record, light_word::cone_scale);
    const Float offset = k.load(FrameBuffer::lights, record, light_word::cone_offset);
    const Float cone = saturate(dot(unit, direction) * scale + offset);
    falloff = falloff * (cone * cone);  // a point light has scale 0 and offset 1
  }
  const Vec3 arriving = color * functions::splat<3>(falloff);
  if (!kinds.directional) return finish(unit, arriving);
  const Bool far_away = k.load(FrameBuffer::lights, record, light_word::kind) == Float(0.0f);
  return finish(select(far_away, direction, unit), select(far_away, color, arriving));
}

int column_word(const interface::RecordLayout& record, const interface::source::Input& input, ir::Type column) {
  const int first = record.inputs[input.input];
  support::assert_that(first >= 0, "a parameter has no words in its record");
  return first + static_cast<int>(input.column) * column.width;
}

ir::ValueId load_field(Kernel& k, ir::Type type, Int object, int offset) {
  const auto word = [&](int i) { return k.load(FrameBuffer::objects, object + Int(offset + i)); };
  if (type == ir::int_type) return to_int(word(0)).value;
  if (type == ir::bool_type) return (word(0) != Float(0.0f)).value;
  std::vector<ir::ValueId> components;
  for (int i = 0; i < type.width; ++i) components.push_back(word(i).value);
  return k.b.construct(components);
}

std::string_view name(Stage stage) {
  constexpr std::string_view names[] = {"vertex", "setup", "depth", "cutout",
                                        "pixel",  "blend", "eval",  "post"};
  return names[static_cast<size_t>(stage)];
}

uint32_t add_vertex_kernel(ir::Module& module) {
  Kernel k(module, "vertex", {int_parameter("vertex"), uniform_int("object"), uniform_int("projected")},
           {{"clip", ir::vector_type(4)}});
  const Int first = k.integer(0) * Int(vertex_word::stride);
  const Vec3 position = k.load3(FrameBuffer::vertices, first, vertex_word::position);
  k.b.finish(std::array{to_clip(k, k.integer(2), position).value});
  return k.index;
}

uint32_t add_moving_vertex_kernel(ir::Module& module, const interface::Interface& interface,
                                  const interface::RecordLayout& record, graph::PositionSpace space) {
  define_texture_reads(module, interface);
  Kernel k(module, "vertex", {int_parameter("vertex"), uniform_int("object"), uniform_int("projected")},
           {{"clip", ir::vector_type(4)}});
  const Int object = k.integer(1);
  SurfacePoint surface(k, object, attributes_of_vertex(k, k.integer(0)), {}, record.previous);
  SurfaceArguments arguments(k, surface, object, record, ir::none);
  Vec3 position(k.b, k.b.call(interface.entry, arguments.of(interface))[0]);
  k.named("position", position);
  if (space == graph::PositionSpace::object) {
    k.b.finish(std::array{to_clip(k, k.integer(2), position).value});
    return k.index;
  }
  if (space == graph::PositionSpace::world) position = k.named("view_position", surface.to_view(position));
  const Vec4 clip = to_clip(k, k.constant(view_word::projection), position);
  k.b.finish(std::array{clip.value});
  return k.index;
}

namespace {

/// Of the triangle at the pixel, in a kernel whose first parameters are x, y and the triangle.
Float depth_of_pixel(Kernel& k) {
  const Vec3 edges(k.b, k.call("edges_at", {k.b.parameter(0), k.b.parameter(1), k.b.parameter(2)})[0]);
  const Int record = k.integer(2) * Int(triangle_word::stride);
  const auto z = [&](int i) {
    return from_bits_normal(k.load_int(FrameBuffer::triangles, record + Int(triangle_word::depth + i)));
  };
  return functions::interpolate_depth<Float>(edges, z(0), z(1), z(2));
}

}  // namespace

uint32_t add_depth_kernel(ir::Module& module) {
  add_edges(module);
  Kernel k(module, "depth", {int_parameter("x"), int_parameter("y"), int_parameter("triangle")},
           {{"depth", ir::float_type}});
  k.b.finish(std::array{depth_of_pixel(k).value});
  return k.index;
}

uint32_t add_cutout_kernel(ir::Module& module, const interface::Interface& interface,
                           const interface::RecordLayout& record) {
  add_edges(module);
  if (ir::asks_for_derivatives(module)) add_edge_gradients(module);
  define_texture_reads(module, interface);
  Kernel k(module, "cutout",
           {int_parameter("x"), int_parameter("y"), int_parameter("triangle"), uniform_int("object")},
           {{"drawn", ir::bool_type}, {"depth", ir::float_type}});
  const Int object = k.integer(3);
  SurfacePoint surface(k, object, attributes_of_pixel(k, k.integer(0), k.integer(1), k.integer(2)),
                       seen_at_pixel(k, k.integer(0), k.integer(1), k.integer(2)), record.previous);
  SurfaceArguments arguments(k, surface, object, record, ir::none);
  const ir::ValueId drawn = k.named("drawn", k.b.call(interface.entry, arguments.of(interface))[0]);
  k.b.finish(std::array{drawn, depth_of_pixel(k).value});
  return k.index;
}

namespace {

/// What a pixel shows, in a kernel whose first parameters are x, y, the triangle, the object and the number of lights.
ir::ValueId color_of_pixel(Kernel& k, const interface::Interface& interface, const interface::RecordLayout& record,
                           LightKinds lights) {
  const Int object = k.integer(3);
  SurfacePoint surface(k, object, attributes_of_pixel(k, k.integer(0), k.integer(1), k.integer(2)),
                       seen_at_pixel(k, k.integer(0), k.integer(1), k.integer(2)), record.previous);
  SurfaceArguments arguments(k, surface, object, record, k.b.parameter(4), lights);
  return k.b.call(interface.entry, arguments.of(interface))[0];
}

std::vector<ir::Parameter> pixel_parameters() {
  return {int_parameter("x"), int_parameter("y"), int_parameter("triangle"), uniform_int("object"),
          uniform_int("light_count")};
}

/// What kernels of pixels call, and the bodies of what their document asks its host for.
void define_for_pixels(ir::Module& module, const interface::Interface& interface, LightKinds lights) {
  add_edges(module);
  if (ir::asks_for_derivatives(module)) add_edge_gradients(module);
  if (const uint32_t light_at = interface.find(interface::Host::light); light_at != ir::none)
    define_light_at(module, light_at, lights);
  define_environment(module, interface);
  define_texture_reads(module, interface);
  define_reads(module, interface);
}

Vec4 blended(interface::Blend blend, Vec4 source, Vec4 backdrop) {
  switch (blend) {
    case interface::Blend::none: return source;
    case interface::Blend::over: return functions::blend_over(source, backdrop);
    case interface::Blend::add: return functions::blend_add(source, backdrop);
    case interface::Blend::multiply: return functions::blend_multiply(source, backdrop);
    case interface::Blend::premultiplied: return functions::blend_premultiplied(source, backdrop);
  }
  support::bug("no such way to blend");
}

}  // namespace

uint32_t add_pixel_kernel(ir::Module& module, const interface::Interface& interface,
                          const interface::RecordLayout& record, LightKinds lights) {
  define_for_pixels(module, interface, lights);
  Kernel k(module, "pixel", pixel_parameters(), {{"color", ir::vector_type(4)}});
  k.b.finish(std::array{color_of_pixel(k, interface, record, lights)});
  return k.index;
}

uint32_t add_blend_kernel(ir::Module& module, const interface::Interface& interface,
                          const interface::RecordLayout& record, LightKinds lights, interface::Blend blend) {
  define_for_pixels(module, interface, lights);
  std::vector<ir::Parameter> parameters = pixel_parameters();
  parameters.push_back({"backdrop", ir::vector_type(4), "", false});
  Kernel k(module, "blend", std::move(parameters), {{"color", ir::vector_type(4)}, {"depth", ir::float_type}});
  const Vec4 source = k.named("source", Vec4(k.b, color_of_pixel(k, interface, record, lights)));
  const Vec4 color = k.named("color", blended(blend, source, k.vector4(5)));
  k.b.finish(std::array{color.value, depth_of_pixel(k).value});
  return k.index;
}

Vec2 moved_pixels(Kernel& k, Vec2 from_middle, Float w, Vec3 change, Vec2 half_size) {
  const Float w_before = k.named("w_before", w - change[2]);
  const Bool was_in_front = w_before > Float(0.0f);
  const auto along = [&](int axis) {
    const Float moved = (change[axis] - from_middle[axis] * change[2]) / select(was_in_front, w_before, Float(1.0f));
    const Float pixels = max(min(moved * half_size[axis], Float(farthest_motion)), Float(-farthest_motion));
    return select(was_in_front, pixels, Float(0.0f));
  };
  return Vec2(along(0), along(1));
}

uint32_t add_motion_kernel(ir::Module& module) {
  add_edges(module);
  Kernel k(module, "pixel", pixel_parameters(), {{"color", ir::vector_type(4)}});
  const Int x = k.integer(0), y = k.integer(1), triangle = k.integer(2);
  const Attributes attributes = attributes_of_pixel(k, x, y, triangle);
  const Vec3 change(k.b, attributes(3, vertex_word::corner_normals));
  k.named("change", change.value);
  const Vec3 edges(k.b, k.call("edges_at", {x.value, y.value, triangle.value})[0]);
  const Int record = triangle * Int(triangle_word::stride);
  const auto inverse_w = [&](int i) {
    return from_bits_normal(k.load_int(FrameBuffer::triangles, record + Int(triangle_word::inverse_w + i)));
  };
  const Float area = (edges[0] + edges[1]) + edges[2];
  const Float w = k.named("w", area / ((edges[0] * inverse_w(0) + edges[1] * inverse_w(1)) + edges[2] * inverse_w(2)));
  const auto size = [&](int word) { return to_float(k.load_int(FrameBuffer::layer_records, k.constant(0), word)); };
  const Vec2 half_size =
      k.named("half_size", Vec2(size(image_word::width) * Float(0.5f), size(image_word::height) * Float(-0.5f)));
  const auto from_middle = [&](Int pixel, int axis) {
    return (to_float(pixel) + Float(0.5f) - abs(half_size[axis])) / half_size[axis];
  };
  const Vec2 moved = k.named(
      "moved", moved_pixels(k, Vec2(from_middle(x, 0), from_middle(y, 1)), w, change, half_size));
  k.b.finish(std::array{Vec4(moved[0], moved[1], Float(0.0f), Float(1.0f)).value});
  return k.index;
}

uint32_t add_eval_kernel(ir::Module& module, uint32_t function) {
  const std::vector<ir::Parameter> parameters = module.functions[function].parameters;
  int words = 0;
  for (const ir::Parameter& parameter : parameters) words += parameter.type.width;
  Kernel k(module, "eval", {int_parameter("row")}, module.functions[function].results);
  const Int first = k.integer(0) * Int(words);
  std::vector<ir::ValueId> arguments;
  int word = 0;
  for (const ir::Parameter& parameter : parameters) {
    const auto at = [&](int i) { return k.load_int(FrameBuffer::inputs, first + Int(word + i)); };
    if (parameter.type == ir::int_type) {
      arguments.push_back(at(0).value);
    } else if (parameter.type == ir::bool_type) {
      arguments.push_back((at(0) != Int(0)).value);
    } else {
      std::vector<ir::ValueId> components;
      for (int i = 0; i < parameter.type.width; ++i) components.push_back(from_bits_normal(at(i)).value);
      arguments.push_back(k.b.construct(components));
    }
    word += parameter.type.width;
  }
  k.b.finish(k.b.call(function, arguments));
  return k.index;
}

}  // namespace isoshade::lower
