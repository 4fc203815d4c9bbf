// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/surface.h"

#include "compiler/functions/octahedral.h"

namespace isoshade::lower {

namespace {

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

}  // namespace

Attributes attributes_of_pixel(Kernel& k, Int x, Int y, Int triangle) {
  const ir::ValueId edges = k.call("edges_at", {x.id(k.b), y.id(k.b), triangle.id(k.b)})[0];
  k.named("edges", edges);
  const Int record = k.named("record", triangle * Int(triangle_word::stride));
  std::vector<Float> inverse_w;
  std::vector<Int> first;  // word of each vertex's record
  for (int i = 0; i < 3; ++i) {
    const auto word = [&](int at) { return k.load_int(FrameBuffer::triangles, record + Int(at + i)); };
    const std::string digit = std::to_string(i);
    inverse_w.push_back(k.named("inverse_w" + digit, from_bits_normal(word(triangle_word::inverse_w))));
    first.push_back(k.named("first" + digit, word(triangle_word::vertex) * Int(vertex_word::stride)));
  }
  const Vec3 weights = k.named("weights", functions::attribute_weights<Float>(Vec3(k.b, edges), inverse_w[0],
                                                                              inverse_w[1], inverse_w[2]));
  return [&k, weights, first](int width, int word) {
    add_attribute(k.b.module(), width);
    const auto at = [&](size_t vertex) { return (first[vertex] + Int(word)).id(k.b); };
    return k.call("attribute" + std::to_string(width), {weights.value, at(0), at(1), at(2)})[0];
  };
}

Attributes attributes_of_vertex(Kernel& k, Int vertex) {
  const Int first = k.named("first", vertex * Int(vertex_word::stride));
  return [&k, first](int width, int word) {
    std::vector<ir::ValueId> components;
    for (int i = 0; i < width; ++i)
      components.push_back(k.load(FrameBuffer::vertices, first + Int(word + i)).value);
    return k.b.construct(components);
  };
}

ir::ValueId SurfacePoint::field(std::string_view name) {
  for (const SurfaceField& field : surface_fields())
    if (field.name == name) return k_.named(std::string(name), value_of(field.value));
  support::bug("a surface has no " + std::string(name));
}

ir::ValueId SurfacePoint::column(std::string_view name) {
  const int number = name.back() - '0';
  for (size_t m = 0; m < space_matrix_count; ++m)
    if (name.substr(0, name.size() - 2) == space_matrix_names[m])
      return k_.named(std::string(name), column(static_cast<SpaceMatrix>(m), number).value);
  support::bug("there is no matrix " + std::string(name));
}

ir::ValueId SurfacePoint::once(ir::ValueId& value, int width, int word) {
  if (value == ir::none) value = attributes_(width, word);
  return value;
}

Vec3 SurfacePoint::column(SpaceMatrix matrix, int number) {
  const Int frame(k_.b, k_.b.constant(0));
  switch (matrix) {
    case SpaceMatrix::world_from_object:
      return k_.load3(FrameBuffer::objects, object_, object_word::model + 3 * number);
    case SpaceMatrix::object_from_world:
      return k_.load3(FrameBuffer::objects, object_, object_word::inverse + 3 * number);
    case SpaceMatrix::view_from_world:
      return k_.load3(FrameBuffer::frame, frame, frame_word::view + 3 * number);
    case SpaceMatrix::world_from_view: break;
  }
  return k_.load3(FrameBuffer::frame, frame, frame_word::inverse_view + 3 * number);
}

Vec3 SurfacePoint::local_corner_normal(nodes::Surface which) {
  const Vec3 packed(k_.b, once(local_corner_normals_, 3, vertex_word::corner_normals));
  const int i = static_cast<int>(which) - static_cast<int>(nodes::Surface::corner_normal1);
  return functions::octahedral_decode(packed[i]);
}

std::array<Vec3, 3> SurfacePoint::linear(SpaceMatrix matrix) {
  return {column(matrix, 0), column(matrix, 1), column(matrix, 2)};
}

ir::ValueId SurfacePoint::value_of(nodes::SurfaceValue value) {
  const bool in_object = value.space == nodes::Space::object;
  const bool in_view = value.space == nodes::Space::view;
  if (value.attribute == nodes::Surface::texcoord) return attributes_(2, vertex_word::texcoord);
  if (value.attribute == nodes::Surface::color) return attributes_(4, vertex_word::color);
  if (value.attribute == nodes::Surface::pixel_size) return pixel_size().value;
  if (value.attribute == nodes::Surface::position) {
    if (in_object) return local_position().value;
    return (in_view ? to_view(position()) : position()).value;
  }
  const Vec3 direction = in_object ? object_direction(value.attribute) : world_direction(value.attribute);
  if (!in_view) return direction.value;
  return weighted(linear(SpaceMatrix::view_from_world), direction).value;
}

Vec3 SurfacePoint::position() {
  if (position_ == ir::none) {
    const Vec3 local = local_position();
    const Vec3 origin = column(SpaceMatrix::world_from_object, 3);
    position_ =
        k_.named("position", (weighted(linear(SpaceMatrix::world_from_object), local) + origin).value);
  }
  return Vec3(k_.b, position_);
}

Vec3 SurfacePoint::to_view(Vec3 point) {
  const Vec3 origin = column(SpaceMatrix::view_from_world, 3);
  return weighted(linear(SpaceMatrix::view_from_world), point) + origin;
}

Float SurfacePoint::pixel_size() {
  const Int frame(k_.b, k_.b.constant(frame_word::pixel_size));
  const Float constant = k_.load(FrameBuffer::frame, frame);
  const Float growth = k_.load(FrameBuffer::frame, frame + Int(1));
  return constant - growth * to_view(position())[2];
}

Vec3 SurfacePoint::tangent() {
  const Vec4 all = local_tangent();
  return Vec3(all[0], all[1], all[2]);
}

Vec3 SurfacePoint::bitangent() {
  return functions::cross(local_normal(), tangent()) * functions::splat<3>(local_tangent()[3]);
}

// The eye is homogeneous: a point for perspective, a direction for orthographic projection.
Vec3 SurfacePoint::towards_eye() {
  const Vec4 eye = k_.load4(FrameBuffer::frame, Int(k_.b, k_.b.constant(frame_word::eye)), 0);
  return Vec3(eye[0], eye[1], eye[2]) - position() * functions::splat<3>(eye[3]);
}

Vec3 SurfacePoint::object_direction(nodes::Surface attribute) {
  switch (attribute) {
    case nodes::Surface::normal: return normalize(local_normal());
    case nodes::Surface::outline_normal: return normalize(local_outline_normal());
    case nodes::Surface::corner_normal1:
    case nodes::Surface::corner_normal2:
    case nodes::Surface::corner_normal3: return normalize(local_corner_normal(attribute));
    case nodes::Surface::tangent: return normalize(tangent());
    case nodes::Surface::bitangent: return normalize(bitangent());
    default: return normalize(weighted(linear(SpaceMatrix::object_from_world), towards_eye()));
  }
}

Vec3 SurfacePoint::world_normal(Vec3 local) {
  const auto cofactors = [&](int i) {
    return k_.load3(FrameBuffer::objects, object_, object_word::normal + 3 * i);
  };
  return normalize(weighted<Vec3>({cofactors(0), cofactors(1), cofactors(2)}, local));
}

Vec3 SurfacePoint::world_direction(nodes::Surface attribute) {
  if (attribute == nodes::Surface::normal) return world_normal(local_normal());
  if (attribute == nodes::Surface::outline_normal) return world_normal(local_outline_normal());
  if (nodes::is_corner_normal(attribute)) return world_normal(local_corner_normal(attribute));
  if (attribute == nodes::Surface::view_direction) return normalize(towards_eye());
  const Vec3 local = attribute == nodes::Surface::tangent ? tangent() : bitangent();
  return normalize(weighted(linear(SpaceMatrix::world_from_object), local));
}

}  // namespace isoshade::lower
