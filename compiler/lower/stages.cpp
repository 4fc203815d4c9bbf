// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/stages.h"

#include <array>

#include "compiler/functions/all.h"
#include "compiler/functions/calls.h"
#include "compiler/functions/interpolation.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/check.h"

namespace isoshade::lower {

namespace {

using functions::traced::Bool;
using functions::traced::Float;
using functions::traced::Int;
using Vec2 = lanes::vec<Float, 2>;
using Vec3 = lanes::vec<Float, 3>;
using Vec4 = lanes::vec<Float, 4>;

/// A kernel under construction.
class Kernel {
 public:
  Kernel(ir::Module& module, std::string name, std::vector<ir::Parameter> parameters,
         std::vector<ir::Result> results)
      : index(new_function(module, std::move(name), std::move(parameters), std::move(results))),
        b(module, index) {}
  /// The body of a function that is declared.
  Kernel(ir::Module& module, uint32_t declared) : index(declared), b(module, declared) {}

  Int integer(size_t parameter) { return Int(b, b.parameter(parameter)); }
  Vec3 vector3(size_t parameter) { return Vec3(b, b.parameter(parameter)); }

  Float load(FrameBuffer buffer, Int word) {
    return Float(b, b.load(static_cast<uint32_t>(buffer), word.id(b)));
  }
  Int load_int(FrameBuffer buffer, Int word) {
    return Int(b, b.load(static_cast<uint32_t>(buffer), word.id(b)));
  }
  /// Three or four words of a record, from `record + word` on.
  Vec3 load3(FrameBuffer buffer, Int record, int word) {
    const auto at = [&](int i) { return load(buffer, record + Int(word + i)); };
    return Vec3(at(0), at(1), at(2));
  }
  Vec4 load4(FrameBuffer buffer, Int record, int word) {
    const auto at = [&](int i) { return load(buffer, record + Int(word + i)); };
    return Vec4(at(0), at(1), at(2), at(3));
  }

  /// Gives a value a name for readers of the emitted text.
  ir::ValueId named(std::string name, ir::ValueId value) {
    b.name(value, b.add_origin(std::move(name), 0));
    return value;
  }
  template <class T>
  T named(std::string name, T value) {
    named(std::move(name), value.value);
    return value;
  }

  std::vector<ir::ValueId> call(std::string_view function, std::initializer_list<ir::ValueId> arguments) {
    const uint32_t callee = b.module().find(function);
    support::check(callee != ir::none, function);
    return b.call(callee, std::span(arguments));
  }

  const uint32_t index;
  ir::Builder b;

 private:
  static uint32_t new_function(ir::Module& module, std::string name, std::vector<ir::Parameter> parameters,
                               std::vector<ir::Result> results) {
    support::check(module.find(name) == ir::none, name);
    ir::Function function;
    function.name = std::move(name);
    function.parameters = std::move(parameters);
    function.results = std::move(results);
    module.functions.push_back(std::move(function));
    return static_cast<uint32_t>(module.functions.size() - 1);
  }
};

ir::Parameter int_parameter(std::string name) { return {std::move(name), ir::int_type, "", false}; }
ir::Parameter uniform_int(std::string name) { return {std::move(name), ir::int_type, "", true}; }

/// edges_at(x, y, triangle): the edge functions at the centre of a pixel.
void add_edges(ir::Module& module) {
  if (module.find("edges_at") != ir::none) return;
  Kernel k(module, "edges_at", {int_parameter("x"), int_parameter("y"), int_parameter("triangle")},
           {{"edges", ir::vector_type(3)}});
  const Int record = k.named("record", k.integer(2) * Int(triangle_word::stride));
  const auto word = [&](int at) { return k.load_int(FrameBuffer::triangles, record + Int(at)); };
  const Bool wide = k.named("wide", (word(triangle_word::object) & Int(1)) != Int(0));
  std::vector<Int> p;
  for (int i = 0; i < 6; ++i)
    p.push_back(
        k.named(std::string(1, "xy"[i % 2]) + std::to_string(i / 2), word(triangle_word::position + i)));
  const Int px = k.named("px", shift_left(k.integer(0), Int(8)) + Int(128));
  const Int py = k.named("py", shift_left(k.integer(1), Int(8)) + Int(128));
  const Vec3 edges = functions::edge_functions<Float>(p[0], p[1], p[2], p[3], p[4], p[5], wide, px, py);
  k.b.finish(std::array{k.named("edges", edges.value)});
}

/// attributeN(weights, first0, first1, first2): N words of `vertices` from each vertex's own, interpolated.
void add_attribute(ir::Module& module, int width) {
  const std::string name = "attribute" + std::to_string(width);
  if (module.find(name) != ir::none) return;
  Kernel k(module, name,
           {{"weights", ir::vector_type(3), "", false},
            int_parameter("first0"),
            int_parameter("first1"),
            int_parameter("first2")},
           {{"value", ir::vector_type(width)}});
  std::vector<ir::ValueId> components;
  for (int i = 0; i < width; ++i) {
    const auto word = [&](size_t vertex) {
      return k.load(FrameBuffer::vertices, k.integer(vertex) + Int(i));
    };
    components.push_back(functions::interpolate<Float>(k.vector3(0), word(1), word(2), word(3)).value);
  }
  k.b.finish(std::array{k.b.construct(components)});
}

/// Sums `columns` weighted by the components of `v`, in order.
template <class Column>
Column weighted(const std::array<Column, 3>& columns, Vec3 v) {
  constexpr int n = std::is_same_v<Column, Vec4> ? 4 : 3;
  return (columns[0] * functions::splat<n>(v[0]) + columns[1] * functions::splat<n>(v[1])) +
         columns[2] * functions::splat<n>(v[2]);
}

Vec4 to_clip(Kernel& k, Int object, Vec3 position) {
  const auto column = [&](int i) {
    return k.load4(FrameBuffer::objects, object, object_word::projected + 4 * i);
  };
  return weighted<Vec4>({column(0), column(1), column(2)}, position) + column(3);
}

/// What `shade` may ask for, made once and only if it does.
class Surface {
 public:
  Surface(Kernel& kernel, Int x, Int y, Int triangle, Int object) : k_(kernel), object_(object) {
    const ir::ValueId edges = k_.call("edges_at", {x.id(k_.b), y.id(k_.b), triangle.id(k_.b)})[0];
    k_.named("edges", edges);
    const Int record = k_.named("record", triangle * Int(triangle_word::stride));
    std::vector<Float> inverse_w;
    for (int i = 0; i < 3; ++i) {
      const auto word = [&](int at) { return k_.load_int(FrameBuffer::triangles, record + Int(at + i)); };
      const std::string digit = std::to_string(i);
      inverse_w.push_back(k_.named("inverse_w" + digit, from_bits_normal(word(triangle_word::inverse_w))));
      first_.push_back(k_.named("first" + digit, word(triangle_word::vertex) * Int(vertex_word::stride)));
    }
    weights_ = k_.named("weights", functions::attribute_weights<Float>(Vec3(k_.b, edges), inverse_w[0],
                                                                       inverse_w[1], inverse_w[2]))
                   .value;
  }

  ir::ValueId field(std::string_view name) {
    if (name == "position") return position().value;
    if (name == "normal") return k_.named("normal", normal());
    if (name == "texcoord") return k_.named("texcoord", attribute(2, vertex_word::texcoord));
    if (name == "view_direction") return k_.named("view_direction", view_direction());
    support::bug("a surface has no " + std::string(name));
  }

 private:
  ir::ValueId attribute(int width, int word) {
    add_attribute(k_.b.module(), width);
    const auto first = [&](int vertex) { return (first_[static_cast<size_t>(vertex)] + Int(word)).id(k_.b); };
    return k_.call("attribute" + std::to_string(width), {weights_, first(0), first(1), first(2)})[0];
  }
  std::array<Vec3, 3> columns(int word) {
    const auto column = [&](int i) { return k_.load3(FrameBuffer::objects, object_, word + 3 * i); };
    return {column(0), column(1), column(2)};
  }
  Vec3 position() {
    if (position_ == ir::none) {
      const Vec3 local(k_.b, attribute(3, vertex_word::position));
      const Vec3 origin = k_.load3(FrameBuffer::objects, object_, object_word::model + 9);
      position_ = k_.named("position", (weighted(columns(object_word::model), local) + origin).value);
    }
    return Vec3(k_.b, position_);
  }
  ir::ValueId normal() {
    const Vec3 local(k_.b, attribute(3, vertex_word::normal));
    return normalize(weighted(columns(object_word::normal), local)).value;
  }
  // The eye is homogeneous: a point for perspective, a direction for orthographic projection.
  ir::ValueId view_direction() {
    const Vec4 eye = k_.load4(FrameBuffer::frame, Int(k_.b, k_.b.constant(frame_word::eye)), 0);
    return normalize(Vec3(eye[0], eye[1], eye[2]) - position() * functions::splat<3>(eye[3])).value;
  }

  Kernel& k_;
  Int object_;
  ir::ValueId weights_ = ir::none;
  std::vector<Int> first_;  ///< of each vertex: the first word of its record
  ir::ValueId position_ = ir::none;
};

ir::ValueId load_typed(Kernel& k, ir::Type type, Int object, int offset) {
  const auto word = [&](int i) { return k.load(FrameBuffer::objects, object + Int(offset + i)); };
  if (type == ir::int_type) return to_int(word(0)).value;
  if (type == ir::bool_type) return (word(0) != Float(0.0f)).value;
  std::vector<ir::ValueId> components;
  for (int i = 0; i < type.width; ++i) components.push_back(word(i).value);
  return k.b.construct(components);
}

/// glTF KHR_lights_punctual: inverse square, windowed by the range if there is one.
Float distance_falloff(Kernel& k, Int record, Float squared_distance) {
  const Float inverse_range = k.load(FrameBuffer::lights, record + Int(light_word::range));
  const Float ratio = squared_distance * inverse_range;
  const Float window = saturate(Float(1.0f) - ratio * ratio);
  return (window * window) / max(squared_distance, Float(1e-8f));
}

/// light_at(index, position): the unit direction towards a light and the radiance that arrives from it.
void define_light_at(ir::Module& module, uint32_t function, LightKinds kinds) {
  Kernel k(module, function);
  const Int record = k.integer(0) * Int(light_word::stride);
  const auto at = [&](int word) { return record + Int(word); };
  const auto finish = [&](Vec3 direction, Vec3 color) {
    k.b.finish(std::array{direction.value, color.value});
  };
  const Vec3 direction = k.load3(FrameBuffer::lights, record, light_word::direction);
  const Vec3 color = k.load3(FrameBuffer::lights, record, light_word::color);
  if (!kinds.point && !kinds.spot) return finish(direction, color);

  const Vec3 towards = k.load3(FrameBuffer::lights, record, light_word::position) - k.vector3(1);
  const Vec3 unit = normalize(towards);
  Float falloff = distance_falloff(k, record, dot(towards, towards));
  if (kinds.spot) {
    const Float scale = k.load(FrameBuffer::lights, at(light_word::cone_scale));
    const Float offset = k.load(FrameBuffer::lights, at(light_word::cone_offset));
    const Float cone = saturate(dot(unit, direction) * scale + offset);
    falloff = falloff * (cone * cone);  // a point light has scale 0 and offset 1
  }
  const Vec3 arriving = color * functions::splat<3>(falloff);
  if (!kinds.directional) return finish(unit, arriving);
  const Bool far_away = k.load(FrameBuffer::lights, at(light_word::kind)) == Float(0.0f);
  finish(select(far_away, direction, unit), select(far_away, color, arriving));
}

}  // namespace

std::string_view name(Stage stage) {
  constexpr std::string_view names[] = {"vertex", "depth", "pixel", "eval"};
  return names[static_cast<size_t>(stage)];
}

ir::Module frame_module() {
  ir::Module module;
  for (const FrameBufferInfo& buffer : frame_buffers)
    module.buffers.push_back({std::string(buffer.name), buffer.element});
  return module;
}

uint32_t add_vertex_kernel(ir::Module& module) {
  Kernel k(module, "vertex", {int_parameter("vertex"), uniform_int("object")},
           {{"clip", ir::vector_type(4)}});
  const Int first = k.integer(0) * Int(vertex_word::stride);
  const Vec3 position = k.load3(FrameBuffer::vertices, first, vertex_word::position);
  k.b.finish(std::array{to_clip(k, k.integer(1), position).value});
  return k.index;
}

uint32_t add_depth_kernel(ir::Module& module) {
  add_edges(module);
  Kernel k(module, "depth", {int_parameter("x"), int_parameter("y"), int_parameter("triangle")},
           {{"depth", ir::float_type}});
  const Vec3 edges(k.b, k.call("edges_at", {k.b.parameter(0), k.b.parameter(1), k.b.parameter(2)})[0]);
  const Int record = k.integer(2) * Int(triangle_word::stride);
  const auto z = [&](int i) {
    return from_bits_normal(k.load_int(FrameBuffer::triangles, record + Int(triangle_word::depth + i)));
  };
  k.b.finish(std::array{functions::interpolate_depth<Float>(edges, z(0), z(1), z(2)).value});
  return k.index;
}

uint32_t add_pixel_kernel(ir::Module& module, const FieldOffsets& parameters, LightKinds lights) {
  add_edges(module);
  if (const uint32_t light_at = module.find("light_at"); light_at != ir::none)
    define_light_at(module, light_at, lights);
  const uint32_t shade = module.find("shade");
  support::check(shade != ir::none, "no shade");
  Kernel k(module, "pixel",
           {int_parameter("x"), int_parameter("y"), int_parameter("triangle"), uniform_int("object"),
            uniform_int("light_count")},
           {{"color", ir::vector_type(4)}});
  const Int object = k.integer(3);
  Surface surface(k, k.integer(0), k.integer(1), k.integer(2), object);
  const std::vector<ir::Parameter> wanted = module.functions[shade].parameters;
  std::vector<ir::ValueId> arguments;
  for (const ir::Parameter& parameter : wanted) {
    if (parameter.group == "surface") {
      arguments.push_back(surface.field(parameter.name));
    } else if (parameter.group == "parameters") {
      int offset = -1;
      for (const auto& [name, word] : parameters)
        if (name == parameter.name) offset = word;
      support::check(offset >= 0, parameter.name);
      arguments.push_back(k.named(parameter.name, load_typed(k, parameter.type, object, offset)));
    } else {
      support::check(parameter.name == "light_count", parameter.name);
      arguments.push_back(k.b.parameter(4));
    }
  }
  k.b.finish(k.b.call(shade, arguments));
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
