// SPDX-License-Identifier: Apache-2.0
// The surface point that a pixel shows: what `shade` may ask for, each made once and only if it does.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"

namespace isoshade::lower {

class SurfacePoint {
 public:
  /// Of the pixel (x, y), where it shows the triangle, which is the object's.
  SurfacePoint(Kernel& kernel, Int x, Int y, Int triangle, Int object);

  /// A field of the group "surface".
  ir::ValueId field(std::string_view name);
  /// A field of the group "spaces": a column of a matrix.
  ir::ValueId column(std::string_view name);

 private:
  ir::ValueId attribute(int width, int word);
  /// An attribute of the mesh, made when it is first asked for.
  ir::ValueId once(ir::ValueId& value, int width, int word);
  Vec3 local_position() { return Vec3(k_.b, once(local_position_, 3, vertex_word::position)); }
  Vec3 local_normal() { return Vec3(k_.b, once(local_normal_, 3, vertex_word::normal)); }
  Vec4 local_tangent() { return Vec4(k_.b, once(local_tangent_, 4, vertex_word::tangent)); }

  Vec3 column(SpaceMatrix matrix, int number);
  /// The columns that take vectors.
  std::array<Vec3, 3> linear(SpaceMatrix matrix);

  ir::ValueId value_of(nodes::SurfaceValue value);
  Vec3 position();
  // Of any length, in object space.
  Vec3 tangent();
  Vec3 bitangent();
  Vec3 towards_eye();  ///< in world space
  Vec3 object_direction(nodes::Surface attribute);
  Vec3 world_direction(nodes::Surface attribute);

  Kernel& k_;
  Int object_;
  ir::ValueId weights_ = ir::none;
  std::vector<Int> first_;  ///< of each vertex: the first word of its record
  ir::ValueId local_position_ = ir::none;
  ir::ValueId local_normal_ = ir::none;
  ir::ValueId local_tangent_ = ir::none;
  ir::ValueId position_ = ir::none;
};

}  // namespace isoshade::lower
