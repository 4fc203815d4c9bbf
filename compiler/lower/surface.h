// SPDX-License-Identifier: Apache-2.0
// A point of the surface: what `shade` and `move_vertex` may ask for, each made once and only if they do.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"

namespace isoshade::lower {

/// Where a point has its attributes from: gives `width` words of the mesh there, from `word` of a vertex record on.
using Attributes = std::function<ir::ValueId(int width, int word)>;
/// Of the pixel (x, y), where it shows the triangle.
Attributes attributes_of_pixel(Kernel& kernel, Int x, Int y, Int triangle);
/// Of the vertex with this number.
Attributes attributes_of_vertex(Kernel& kernel, Int vertex);

/// Whether the front of the triangle is seen.
Bool front_facing(Kernel& kernel, Int triangle);
/// Where what is seen at the pixel lies in world space, by the triangle's corners on the pixel grid.
Vec3 shown_position(Kernel& kernel, Int x, Int y, Int triangle);

/// Where a point has what only pixels have; a vertex has neither.
struct Seen {
  std::function<Bool()> front_facing;
  std::function<Vec3()> position;
};
/// Of the pixel (x, y), where it shows the triangle.
Seen seen_at_pixel(Kernel& kernel, Int x, Int y, Int triangle);

class SurfacePoint {
 public:
  /// Of the object whose record begins at `object`. `previous`: RecordLayout::previous, or -1 where nothing is known of the
  /// frame before: then nothing has moved.
  SurfacePoint(Kernel& kernel, Int object, Attributes attributes, Seen seen = {}, int previous = -1)
      : k_(kernel), object_(object), attributes_(std::move(attributes)), seen_(std::move(seen)), previous_(previous) {}

  ir::ValueId value(interface::SurfaceValue value);
  Vec3 column(interface::SpaceMatrix matrix, uint32_t number);
  /// A point of world space in view space.
  Vec3 to_view(Vec3 point);

 private:
  /// An attribute of the mesh, made when it is first asked for.
  ir::ValueId once(ir::ValueId& value, int width, int word);
  Vec3 local_position() { return Vec3(k_.b, once(local_position_, 3, vertex_word::position)); }
  Vec3 local_normal() { return Vec3(k_.b, once(local_normal_, 3, vertex_word::normal)); }
  Vec3 local_outline_normal() {
    return Vec3(k_.b, once(local_outline_normal_, 3, vertex_word::outline_normal));
  }
  Vec3 local_corner_normal(int number);
  Vec4 local_tangent() { return Vec4(k_.b, once(local_tangent_, 4, vertex_word::tangent)); }

  /// The columns that take vectors.
  std::array<Vec3, 3> linear(interface::SpaceMatrix matrix);

  Vec3 position();
  Vec3 previous_position();
  Vec3 position_in(interface::Space space);
  Float pixel_size();
  // Of any length, in object space.
  Vec3 tangent();
  Vec3 bitangent();
  Vec3 towards_eye();  ///< of any length, in world space
  // Unit vectors in a space, of vectors in object space.
  Vec3 normal_in(interface::Space space, Vec3 local);
  Vec3 tangent_in(interface::Space space, Vec3 local);
  Vec3 view_direction_in(interface::Space space);
  Vec3 world_to_view(Vec3 direction);

  Kernel& k_;
  Int object_;
  Attributes attributes_;
  Seen seen_;
  int previous_;
  ir::ValueId local_position_ = ir::none;
  ir::ValueId local_normal_ = ir::none;
  ir::ValueId local_outline_normal_ = ir::none;
  ir::ValueId local_corner_normals_ = ir::none;
  ir::ValueId local_tangent_ = ir::none;
  ir::ValueId position_ = ir::none;
};

}  // namespace isoshade::lower
