// SPDX-License-Identifier: Apache-2.0
// Scenes made at random of shipped effects and posts: the same bits with everything skipped that can be, and with
// nothing skipped. With ISOSHADE_FULL set there are many more; ISOSHADE_SEEDS=first,last runs those of a report again.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include "compiler/driver/driver.h"
#include "tests/equivalence/seeds.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

class RandomScene {
 public:
  explicit RandomScene(uint64_t seed) : random_(static_cast<std::mt19937::result_type>(seed)) {}

  std::string text() {
    std::string members = R"("camera": {"position": )" + vector(-6, 6, 1, 7, 5, 11) + R"(, "target": )" +
                          vector(-1, 1, -1, 1, -1, 1) + R"(, "fov": )" + number(25, 70) + "},\n";
    members += R"("background": [0.1, 0.2, 0.3, )" + std::string(below(2) == 0 ? "1" : "0") + "], \"samples\": " +
               (below(4) == 0 ? "4" : "1") + ",\n";
    if (below(4) == 0) members += R"("environment": {"sky": {"zenith": )" + vector(0, 1, 0, 1, 0, 1) + R"(, "ground": )" + vector(0, 1, 0, 1, 0, 1) + "}},\n";
    members += "\"lights\": {" +
               list(1 + below(12), [&](int i) { return light(i); }) + "},\n";
    members += "\"objects\": {" + list(1 + below(5), [&](int i) { return object(i); }) + "}";
    if (below(2) == 0) members += ",\n\"posts\": [" + list(1 + below(2), [&](int) { return post(); }) + "]";
    return isoshade::testing::scene_text(members);
  }

 private:
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) * 0x1p-32;
  }
  std::string number(double low, double high) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", between(low, high));
    return text;
  }
  std::string vector(double x0, double x1, double y0, double y1, double z0, double z1) {
    const std::string x = number(x0, x1), y = number(y0, y1), z = number(z0, z1);
    return "[" + x + ", " + y + ", " + z + "]";
  }
  template <class Make>
  static std::string list(int count, const Make& make) {
    std::string text;
    for (int i = 0; i < count; ++i) text += (i > 0 ? ",\n" : "") + make(i);
    return text;
  }

  std::string light(int i) {
    std::string text = "\"light" + std::to_string(i) + "\": {\"type\": ";
    const int kind = below(3);
    text += kind == 0 ? "\"directional\"" : kind == 1 ? "\"point\"" : "\"spot\"";
    if (kind != 1) text += ", \"direction\": " + vector(-1, 1, -1, -0.1, -1, 1);
    if (kind != 0) text += ", \"position\": " + vector(-6, 6, -1, 5, -4, 4);
    if (kind != 0 && below(4) > 0) text += ", \"range\": " + number(0.5, 6);
    if (kind == 2) text += ", \"inner_angle\": " + number(0, 20) + ", \"outer_angle\": " + number(21, 60);
    text += ", \"color\": " + (below(8) == 0 ? "[0, 0, 0]" : vector(0, 1, 0, 1, 0, 1));
    text += ", \"intensity\": " + (below(8) == 0 ? "0" : number(0.1, kind == 0 ? 1 : 12));
    if (below(4) == 0) text += ", \"shadow\": {\"size\": 32, \"softness\": " + number(0, 3) + "}";
    return text + "}";
  }

  std::string object(int i) {
    static constexpr const char* meshes[] = {R"({"type": "sphere", "segments": 16, "rings": 8})", R"("box")",
                                             R"({"type": "plane", "size": [9, 6], "segments": 3})",
                                             R"({"type": "torus", "radius": 0.8, "tube": 0.3})"};
    static constexpr const char* effects[] = {
        "../materials/cook_torrance.json", "../effects/cartoon.json",
        "../materials/gltf_pbr.json",      "../effects/flat.json",
        "../effects/force_field.json",     "../effects/smoke.json",
        "../effects/cross_hatching.json",  "../effects/tinted_glass.json",
        "../effects/dissolve.json",        "../effects/outline.json",
        "../effects/trellis.json",         "../effects/leaves.json",
        "../effects/refraction.json",      "../effects/fur.json",
        "../effects/overlay.json",         "../effects/stylised_highlight.json",
        "../effects/planted.json",         "../materials/moved_vertices.json",
        "../materials/textured.json",      "../materials/derivatives.json",
        "../materials/gltf_pbr.json"};  // twice: it has many images
    const std::string effect = effects[below(std::size(effects))];
    std::string text = "\"object" + std::to_string(i) + "\": {\"mesh\": " + meshes[below(std::size(meshes))];
    text += ", \"effect\": \"" + effect + "\", \"transform\": {\"translate\": " + vector(-4, 2, -1, 2, -4, 3);
    text += ", \"rotate\": " + vector(-90, 90, -90, 90, -90, 90) +
            ", \"scale\": " + vector(0.3, 2, 0.3, 2, 0.3, 2) + "}";
    text += ", \"parameters\": {" + parameters(effect) + "}";
    if (below(3) == 0)
      text += ", \"repeat\": [{\"count\": " + std::to_string(2 + below(4)) +
              ", \"step\": " + vector(1, 3, 0, 1, 0, 1) + "}]";
    return text + "}";
  }

  /// About half of the parameters, within their ranges.
  std::string parameters(const std::string& effect) {
    std::string text;
    for (const driver::Field& field : fields_of(effect)) {
      if (below(2) == 0) continue;
      const std::string choice = choice_of(field);
      if (!choice.empty()) text += (text.empty() ? "" : ", ") + ("\"" + field.name + "\": ") + choice;
      const bool is_number = field.type == "float" || field.type == "color3" || field.type == "vector2" ||
                             field.type == "vector3";
      if (!is_number) continue;
      const auto value = [&](size_t i) {
        const double usual = field.value[i];
        const double low = field.min ? double{*field.min} : usual - 1,
                     high = field.max ? double{*field.max} : low + 2 * (usual - low) + 1;
        // The ends are what programs treat apart.
        return below(4) == 0   ? number(low, low)
               : below(6) == 0 ? number(high, high)
                               : number(low, std::min(high, low + 2));
      };
      if (!text.empty()) text += ", ";
      text += "\"" + field.name + "\": ";
      if (field.words == 1) {
        text += value(0);
        continue;
      }
      text += "[" + list(field.words, [&](int c) { return value(static_cast<size_t>(c)); }) + "]";
    }
    return text;
  }

  /// Of what has no numbers: a switch, one of some names, or an image. Otherwise nothing.
  std::string choice_of(const driver::Field& field) {
    static constexpr const char* images[] = {"", "../textures/uv_grid.png", "../textures/leaf.png",
                                             "../textures/toon_ramp.png"};
    if (field.type == "boolean") return below(2) == 0 ? "true" : "false";
    if (!field.names.empty()) return "\"" + field.names[below(field.names.size())] + "\"";
    return field.type == "filename" ? "\"" + std::string(images[below(std::size(images))]) + "\"" : "";
  }

  static const std::vector<driver::Field>& fields_of(const std::string& effect) {
    static std::map<std::string, std::vector<driver::Field>> known;
    const auto [found, is_new] = known.try_emplace(effect);
    if (!is_new) return found->second;
    support::Diagnostics diagnostics;
    check::Library library(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = &library;
    const auto source = graph::read_source(ISOSHADE_GRAPHS "/scenes/" + effect, diagnostics);
    const auto kind = driver::kind_of(source, diagnostics);
    if (kind == graph::DocumentKind::post) {
      if (auto post = driver::check_post(source, options, diagnostics)) found->second = post->parameters.fields;
    } else if (auto made = driver::check_effect(source, options, diagnostics)) {
      found->second = made->parameters.fields;
    }
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
    return found->second;
  }

  std::string post() {
    static constexpr const char* posts[] = {"../effects/distance_fog.json", "../effects/height_fog.json",
                                            "../effects/tonemap_aces.json", "../effects/backdrop.json",
                                            "../effects/paper.json"};
    const int number = posts_++;
    const std::string effect = posts[below(std::size(posts))];
    return "{\"name\": \"post" + std::to_string(number) + "\", \"effect\": \"" + effect + "\", \"parameters\": {" +
           parameters(effect) + "}}";
  }

  std::mt19937 random_;
  int posts_ = 0;
};

TEST(RandomScenes, HaveTheSameBitsWithAndWithoutSkips) {
  const auto [first, last] = seeds(12, 10'000);
  const auto interpreter = interpreter::create();
  const auto cpu = cpu_backend();
  int64_t left_out = 0, images = 0;
  for (uint64_t seed = first; seed < last; ++seed) {
    const std::string text = RandomScene(seed).text();
    const scene::Scene scene =
        load(std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/scenes/random.json", text));
    // Every fourth has several tiles.
    const Size size = seed % 4 == 0 ? Size{139, 75} : Size{31, 23};
    const render::Plan all = plan(scene, size.width, size.height, false), with = plan(scene, size.width, size.height);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << seed << ": " << text;
    left_out += with.stats.left_out_lights;
    images += std::ranges::count(with.stats.in_programs, std::optional(interface::Skip::textures),
                                 &render::Skipped::skip);
    const backends::Image expected = draw(all, *interpreter);
    expect_identical(expected, draw(with, *interpreter), "interpreter, seed " + std::to_string(seed));
    // C++ compilers take most of the time.
    if (last - first <= 100 || seed % 16 == 0)
      expect_identical(expected, draw(with, *cpu), "cpu, seed " + std::to_string(seed));
    ASSERT_FALSE(::testing::Test::HasFailure()) << text;
  }
  if (last - first < 12) return;  // a few scenes need not have all of these
  EXPECT_GT(left_out, 0);
  EXPECT_GT(cpu->tile_counts().blocks_of_one_object, 0);
  EXPECT_GT(cpu->tile_counts().empty, 0);
  EXPECT_GT(images, 0);
}

}  // namespace
}  // namespace isoshade::equivalence
