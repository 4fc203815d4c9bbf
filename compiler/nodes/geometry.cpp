// SPDX-License-Identifier: Apache-2.0
// The surface point that is shaded. Only in effects: a function takes what it needs as inputs.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {

std::vector<Row> geometry_rows() {
  const Port space{"space", Choice, "the coordinate space", "world", {"world"}};
  return {
      {"position", "Where the point is.", {space}, Vector3, Surface::position},
      {"normal", "The unit normal of the surface.", {space}, Vector3, Surface::normal},
      {"viewdirection",
       "The unit vector from the point towards the viewer.",
       {space},
       Vector3,
       Surface::view_direction},
      {"texcoord", "The texture coordinates of the point.", {}, Vector2, Surface::texcoord},
  };
}

}  // namespace isoshade::nodes
