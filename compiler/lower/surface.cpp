// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/surface.h"

#include "compiler/functions/octahedral.h"

namespace isoshade::lower {

using interface::Space;
using interface::SpaceMatrix;
using interface::Surface;

namespace {

/// attributeN(weights, first0, first1, first2): N words of `vertices` from each vertex's own, interpolated.
template <int N>
void add_attribute(ir::Module& module) {
  const std::string name = "attribute" + std::to_string(N);
  if (module.find(name) != ir::none) return;
  Kernel k(module, name,
           {{"weights", ir::vector_type(3), "", false},
            int_parameter("first0"),
            int_parameter("first1"),
            int_parameter("first2")},
           {{"value", ir::vector_type(N)}});
  const auto words = [&](size_t vertex) {
    std::vector<ir::ValueId> components;
    for (int i = 0; i < N; ++i)
      components.push_back(k.load(FrameBuffer::vertices, k.integer(vertex) + Int(i)).value);
    return lanes::vec<Float, N>(k.b, k.b.construct(components));
  };
  k.b.finish(std::array{functions::interpolate<Float>(k.vector3(0), words(1), words(2), words(3)).value});
}

void add_attribute(ir::Module& module, int width) {
  switch (width) {
    case 2: return add_attribute<2>(module);
    case 3: return add_attribute<3>(module);
    case 4: return add_attribute<4>(module);
  }
  support::bug("no attribute is so wide");
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

Bool front_facing(Kernel& k, Int triangle) {
  const Int record = triangle * Int(triangle_word::stride);
  const Int flags = k.load_int(FrameBuffer::triangles, record + Int(triangle_word::object));
  return (flags & Int(triangle_flag::back)) == Int(0);
}

namespace {

/// Where a corner of the triangle lies, from the position of the camera.
Vec3 corner_position(Kernel& k, Int record, int corner) {
  const Int view = k.constant(0);
  const auto word = [&](int at) { return k.load_int(FrameBuffer::triangles, record + Int(at)); };
  /// From -1 at the left or upper edge of the image to 1 at the other.
  const auto from_middle = [&](int axis) {
    const int size = axis == 0 ? image_word::width : image_word::height;
    const Float pixels = to_float(k.load_int(FrameBuffer::layer_records, view + Int(size)));
    constexpr float half_units = 128.0f;  // a pixel is 256
    const Float place = to_float(word(triangle_word::position + 2 * corner + axis)) / Float(half_units);
    return (place - pixels) / pixels;
  };
  const Vec3 right = functions::splat<3>(from_middle(0)), down = functions::splat<3>(from_middle(1));
  const auto over_screen = [&](int at) {
    const auto vector = [&](int i) { return k.load3(FrameBuffer::view, view, at + 3 * i); };
    return (vector(0) + vector(1) * right) + vector(2) * down;
  };
  const Float depth = from_bits_normal(word(triangle_word::depth + corner));
  const auto by_depth = [&](int at) {
    return k.load(FrameBuffer::view, view, at) + depth * k.load(FrameBuffer::view, view, at + 1);
  };
  const Float distance = by_depth(view_word::depth_numerator) / by_depth(view_word::depth_denominator);
  return over_screen(view_word::ray_origin) + over_screen(view_word::view_ray) * functions::splat<3>(distance);
}

}  // namespace

Vec3 shown_position(Kernel& k, Int x, Int y, Int triangle) {
  const Vec3 edges(k.b, k.call("edges_at", {x.id(k.b), y.id(k.b), triangle.id(k.b)})[0]);
  const Int record = triangle * Int(triangle_word::stride);
  const auto inverse_w = [&](int i) {
    return from_bits_normal(k.load_int(FrameBuffer::triangles, record + Int(triangle_word::inverse_w + i)));
  };
  const Vec3 weights = functions::attribute_weights<Float>(edges, inverse_w(0), inverse_w(1), inverse_w(2));
  const auto corner = [&](int i) { return k.named("corner" + std::to_string(i), corner_position(k, record, i)); };
  const Vec3 from_camera = functions::interpolate<Float>(weights, corner(0), corner(1), corner(2));
  return k.named("shown_position", k.load3(FrameBuffer::view, k.constant(0), view_word::camera_position) + from_camera);
}

Seen seen_at_pixel(Kernel& k, Int x, Int y, Int triangle) {
  return {[&k, triangle] { return front_facing(k, triangle); },
          [&k, x, y, triangle] { return shown_position(k, x, y, triangle); }};
}

ir::ValueId SurfacePoint::once(ir::ValueId& value, int width, int word) {
  if (value == ir::none) value = attributes_(width, word);
  return value;
}

Vec3 SurfacePoint::column(SpaceMatrix matrix, uint32_t column_number) {
  const int number = static_cast<int>(column_number);
  const Int view = k_.constant(0);
  switch (matrix) {
    case SpaceMatrix::world_from_object:
      return k_.load3(FrameBuffer::objects, object_, object_word::model + 3 * number);
    case SpaceMatrix::object_from_world:
      return k_.load3(FrameBuffer::objects, object_, object_word::inverse + 3 * number);
    case SpaceMatrix::view_from_world:
      return k_.load3(FrameBuffer::view, view, view_word::view + 3 * number);
    case SpaceMatrix::world_from_view:
      return k_.load3(FrameBuffer::view, view, view_word::inverse_view + 3 * number);
  }
  support::bug("no such matrix");
}

Vec3 SurfacePoint::local_corner_normal(int number) {
  const Vec3 packed(k_.b, once(local_corner_normals_, 3, vertex_word::corner_normals));
  return functions::octahedral_decode(packed[number]);
}

std::array<Vec3, 3> SurfacePoint::linear(SpaceMatrix matrix) {
  return {column(matrix, 0), column(matrix, 1), column(matrix, 2)};
}

ir::ValueId SurfacePoint::value(interface::SurfaceValue value) {
  switch (value.attribute) {
    case Surface::position: return position_in(value.space).value;
    case Surface::previous_position: return previous_position().value;
    case Surface::normal: return normal_in(value.space, local_normal()).value;
    case Surface::texcoord: return attributes_(2, vertex_word::texcoord);
    case Surface::texcoord1: return attributes_(2, vertex_word::texcoord1);
    case Surface::view_direction: return view_direction_in(value.space).value;
    case Surface::tangent: return tangent_in(value.space, tangent()).value;
    case Surface::bitangent: return tangent_in(value.space, bitangent()).value;
    case Surface::color: return attributes_(4, vertex_word::color);
    case Surface::outline_normal: return normal_in(value.space, local_outline_normal()).value;
    case Surface::pixel_size: return pixel_size().value;
    case Surface::corner_normal1: return normal_in(value.space, local_corner_normal(0)).value;
    case Surface::corner_normal2: return normal_in(value.space, local_corner_normal(1)).value;
    case Surface::corner_normal3: return normal_in(value.space, local_corner_normal(2)).value;
    case Surface::front_facing:
      support::assert_that(seen_.front_facing != nullptr, "a vertex has no side");
      return seen_.front_facing().value;
    case Surface::shown_position:
      support::assert_that(seen_.position != nullptr, "a vertex is not seen");
      return seen_.position().value;
  }
  support::bug("no such attribute");
}

Vec3 SurfacePoint::position_in(Space space) {
  if (space == Space::object) return local_position();
  return space == Space::view ? to_view(position()) : position();
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

Vec3 SurfacePoint::previous_position() {
  if (previous_ < 0) return position();
  const auto column = [&](int i) { return k_.load3(FrameBuffer::objects, object_, previous_ + 3 * i); };
  return weighted<Vec3>({column(0), column(1), column(2)}, local_position()) + column(3);
}

Vec3 SurfacePoint::to_view(Vec3 point) {
  const Vec3 origin = column(SpaceMatrix::view_from_world, 3);
  return weighted(linear(SpaceMatrix::view_from_world), point) + origin;
}

Float SurfacePoint::pixel_size() {
  const Int view = k_.constant(0);
  const Float constant = k_.load(FrameBuffer::view, view, view_word::pixel_size);
  const Float growth = k_.load(FrameBuffer::view, view, view_word::pixel_size + 1);
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
  const Vec4 eye = k_.load4(FrameBuffer::view, k_.constant(0), view_word::eye);
  return Vec3(eye[0], eye[1], eye[2]) - position() * functions::splat<3>(eye[3]);
}

Vec3 SurfacePoint::world_to_view(Vec3 direction) {
  return weighted(linear(SpaceMatrix::view_from_world), direction);
}

// Normals go by the cofactors of the matrix, which is its inverse transposed up to a factor.
Vec3 SurfacePoint::normal_in(Space space, Vec3 local) {
  if (space == Space::object) return normalize(local);
  const auto cofactors = [&](int i) {
    return k_.load3(FrameBuffer::objects, object_, object_word::normal + 3 * i);
  };
  const Vec3 world = normalize(weighted<Vec3>({cofactors(0), cofactors(1), cofactors(2)}, local));
  return space == Space::view ? world_to_view(world) : world;
}

Vec3 SurfacePoint::tangent_in(Space space, Vec3 local) {
  if (space == Space::object) return normalize(local);
  const Vec3 world = normalize(weighted(linear(SpaceMatrix::world_from_object), local));
  return space == Space::view ? world_to_view(world) : world;
}

Vec3 SurfacePoint::view_direction_in(Space space) {
  if (space == Space::object)
    return normalize(weighted(linear(SpaceMatrix::object_from_world), towards_eye()));
  const Vec3 world = normalize(towards_eye());
  return space == Space::view ? world_to_view(world) : world;
}

}  // namespace isoshade::lower
