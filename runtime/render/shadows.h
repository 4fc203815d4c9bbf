// SPDX-License-Identifier: Apache-2.0
// Where the shadow maps of a light look, and how large what they show is.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "runtime/raster/clip.h"
#include "runtime/render/light_reach.h"
#include "runtime/scene/placement.h"
#include "runtime/scene/scene.h"
#include "runtime/threads/workers.h"

namespace isoshade::render {

/// A box around a copy of an object, in world space.
struct Hull {
  std::array<glm::vec3, 8> corners;  ///< bit i of the index: the high end along axis i of object space
  ReachBox box;                      ///< around its vertices, unless they are moved
  bool casts = false;                ///< a shadow
  bool casts_anywhere = false;       ///< a pass that casts moves vertices, maybe out of the box
  bool may_show = false;             ///< it receives shadows
  bool may_darken = false;           ///< it receives shadows, and has a pass whose color depends on them
  bool moves = false;                ///< a pass moves vertices, maybe out of the box
  bool shows = false;                ///< it receives shadows, and the camera may see it
  bool darkens = false;              ///< it shows shadows, and has a pass whose color depends on them
};
/// The corners low ... high of a box in object space. `margin`: of what its passes may move vertices beyond it, as a part
/// of its diagonal.
std::array<glm::vec3, 8> corners_of(const glm::vec3& low, const glm::vec3& high, float margin, const glm::mat4& model);

struct ShadowMap {
  scene::Camera camera;
  scene::View view;
  raster::DepthBias bias;
  float margin = 1;  ///< how much wider the map is than the picture of the camera
};

/// How many maps a light has.
size_t shadow_map_count(const scene::Light& light);

struct ShadowMaps {
  std::vector<ShadowMap> maps;
  /// Whether drawing them may darken anything that the picture shows: otherwise without them the picture has the same bits.
  bool may_darken = false;
};

/// The maps of a light that has a shadow: one for a directional light, fitted to what the picture shows of the boxes and as
/// deep as what may darken it (of vertices that are moved: up to twice the size of the scene away); one for a spot, around
/// its cone; six for a point light, and for a spot wider than 60 degrees, towards +x -x +y -y +z -z. Every map has a margin
/// for the filter. `record`: of the light. The caller holds a lanes::FpGuard.
ShadowMaps shadow_maps(const scene::Light& light, LightRecord record, std::span<const Hull> hulls,
                       const scene::View& picture, threads::Workers& workers);

}  // namespace isoshade::render
