// SPDX-License-Identifier: Apache-2.0
// Two effects in one program: shades 256 x 256 surfaces with each, and compares every bit with the runtime's pictures.
// The surfaces are pictures too, of effects that show an attribute.
#include "cook_torrance.h"
#include "outline.h"

#include <cstdio>
#include <cstring>

#include <isoshade/runtime.h>

using isoshade::lanes::vec3;
using isoshade::lanes::vec4;
using namespace isoshade::shaders;

constexpr float intensity = 2;

struct Host {
  int light_count() const { return 1; }
  isoshade::Light<float> light(int, vec3<float>) const { return {{0, 0, 1}, vec3<float>(intensity)}; }
  bool has_environment() const { return false; }
  int pass_index() const { return 0; }
  int pass_count() const { return 1; }
  vec3<float> environment(vec3<float>, float) const { return vec3<float>(0); }
  vec3<float> irradiance(vec3<float>) const { return vec3<float>(0); }
};

const isoshade::Backend backend = [] {
  isoshade::Backend opened;
  if (const isoshade::Outcome outcome = opened.open(); !outcome) std::fputs(outcome.text.c_str(), stderr);
  return opened;
}();

isoshade::Image picture_with(const std::string& effect, const isoshade::RenderOptions& options) {
  const isoshade::Document scene{"table.json", R"({"isoshade": 1, "scene": "table", "size": [256, 256],
    "camera": {"type": "perspective", "position": [0.2, 0.3, 1.6], "target": [0, 0, 0], "fov": 40},
    "lights": {"lamp": {"type": "directional", "direction": [0, 0, -1], "intensity": 2}},
    "objects": {"ball": {"mesh": {"type": "sphere"}, "effect": ")" + effect + "\"}}}"};
  isoshade::Rendering rendering = backend.render(scene, options);
  std::fputs(rendering.text.c_str(), stderr);
  return std::move(rendering.image);
}

isoshade::Image attribute(const std::string& name) {
  const isoshade::Document effect{"attribute.json", R"({"isoshade": 1, "effect": "attribute",
    "nodes": {"a": {"type": ")" + name + R"("},
    "color": {"type": "convert", "in": "a", "to": "color3"}}, "passes": [{"name": "base", "color": "color"}]})"};
  return picture_with(effect.path, {.sources = {.documents = {effect}}});
}

/// Shades each surface; returns how many differ from the picture of the same effect. The ball fills it.
template <class Shade>
int differing(const isoshade::Image& picture, const char* name, Shade shade) {
  const isoshade::lanes::FpGuard guard;
  int seen = 0, differ = 0;
  for (size_t i = 0; i < picture.depth.size(); ++i) {
    if (picture.depth[i] == 0) continue;
    const vec4<float> color = shade(i);
    ++seen;
    differ += std::memcmp(&color, &picture.rgba[4 * i], sizeof color) != 0;
  }
  std::printf("%s: %d of %d surfaces differ\n", name, differ, seen);
  return seen == 256 * 256 ? differ : -1;
}

int main(int, char** argv) {
  const std::string documents = argv[1];
  const isoshade::Image position = attribute("position"), normal = attribute("normal"), view = attribute("viewdirection");
  const auto at = [](const isoshade::Image& image, size_t i) {
    return vec3<float>(image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]);
  };
  const cook_torrance::Parameters metal{{0.8f, 0.8f, 0.8f}, 0, 0.3f, 1, {0.72f, 0.78f, 0.86f}, {0.16f, 0.3f, 0.62f}, {0.13f, 0.11f, 0.09f}};
  const outline::Parameters matte{{0.8f, 0.8f, 0.8f}, {0.3f, 0.3f, 0.3f}, 0, {0, 0, 0}, 0, 0};
  const isoshade::RenderOptions outside{.sources = {.allow_outside = true}};
  const isoshade::RenderOptions no_outline{.sources = {.allow_outside = true}, .settings = {"ball.outline=0"}};
  const int first = differing(picture_with(documents + "/materials/cook_torrance.json", outside), "cook_torrance", [&](size_t i) {
    return cook_torrance::shade(Host(), cook_torrance::Surface<float>{at(position, i), at(normal, i), at(view, i)}, metal);
  });
  const int second = differing(picture_with(documents + "/effects/outline.json", no_outline), "outline", [&](size_t i) {
    return outline::base_shade(Host(), outline::Surface<float>{at(position, i), at(normal, i)}, matte);
  });
  return first == 0 && second == 0 ? 0 : 1;
}
