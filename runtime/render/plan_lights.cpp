// SPDX-License-Identifier: Apache-2.0
// The records of the lights, and the views of their shadow maps.
#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/lower/shadow.h"
#include "compiler/support/visible.h"
#include "runtime/render/planner.h"
#include "runtime/render/visibility.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"

namespace isoshade::render {

using support::quote;

/// Finds what the picture shows of the hulls.
void Planner::look_at_hulls(const scene::View& picture) {
  const auto look = [&](size_t i) {
    Hull& hull = placed_.hulls[i];
    const StoredMesh& mesh = plan_.meshes[mesh_of_object_[placed_.copies[i].object]];
    const bool is_seen = hull.moves || !outside_view(mesh.low, mesh.high,
                                                     scene::multiply(picture.projection, placed_.copies[i].model),
                                                     scene::max_size, scene::max_size);
    hull.shows = hull.may_show && is_seen;
    hull.darkens = hull.may_darken && is_seen;
  };
  struct Nothing {};
  in_parts<Nothing>(placed_.hulls.size(), [&](size_t i, Nothing&) { look(i); });
}

void Planner::note_largest_shadow(const scene::Light& light, size_t maps) {
  if (maps == 0) return;
  const auto side = static_cast<uint64_t>(light.shadow->size);
  const uint64_t texels = maps * side * side;
  shadow_texels_ += texels;
  if (texels <= most_shadow_texels_) return;
  most_shadow_texels_ = texels;
  const std::string size = std::to_string(side);
  plan_.frame.largest_shadow = {"the shadow of light " + quote(light.name) + ", " + std::to_string(maps) +
                                    (maps == 1 ? " map of " : " maps of ") + size + " x " + size + " pixels",
                                light.shadow_where};
}

void Planner::add_lights(const scene::View& picture) {
  namespace word = lower::light_word;
  look_at_hulls(picture);
  backends::Frame& frame = plan_.frame;
  for (const scene::Light& light : scene_->lights) {
    auto record = scene::light_record(light);
    const bool is_black = light.intensity == 0 || light.color == glm::vec3(0);
    const bool is_left_out = is_black && skips(interface::Skip::shadows);
    std::vector<ShadowMap> maps;
    if (light.shadow && !is_left_out) {
      ShadowMaps made = shadow_maps(light, record, placed_.hulls, picture, workers_);
      if (made.may_darken || !skips(interface::Skip::shadows)) maps = std::move(made.maps);
    }
    if (light.shadow && maps.empty()) {
      const int64_t side = light.shadow->size;
      plan_.stats.skips.push_back(
          {.skip = interface::Skip::shadows,
           .what = "shadow of " + light.name,
           .reason = is_left_out ? "the light is black" : "it darkens nothing that is seen",
           .of = light.name,
           .bytes = static_cast<int64_t>(shadow_map_count(light) * sizeof(float)) * side * side});
    }
    note_largest_shadow(light, maps.size());
    if (!maps.empty()) {
      const size_t place = frame.views.size() + (has_opaque_view_ ? 1 : 0);
      record[word::shadow] = static_cast<float>(1 + place * lower::shadow_map_records);
      record[word::shadow_maps] = static_cast<float>(maps.size());
      record[word::softness] = scene::canonical(light.shadow->softness);
    }
    for (const ShadowMap& map : maps) {
      const int size = light.shadow->size;
      add_view(map.camera, map.view, size, size, {"the shadow of light " + quote(light.name), size, size, false});
      frame.views.back().depth_bias = map.bias;
      widen_rays(frame.views.back().words, map.margin);
    }
    frame.lights.insert(frame.lights.end(), record.begin(), record.end());
  }
}

}  // namespace isoshade::render
