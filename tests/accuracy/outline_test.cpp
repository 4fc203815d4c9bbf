// SPDX-License-Identifier: Apache-2.0
// What outlines look like: whole along smoothed normals, as wide as they should be, and not drawn where they are 0.
#include <algorithm>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

enum class Seen : uint8_t { background, outline, surface };

/// What each pixel of an image shows.
struct Picture {
  int width = 0, height = 0;
  std::vector<Seen> pixels;

  Seen at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return Seen::background;
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  int count(Seen what) const { return static_cast<int>(std::ranges::count(pixels, what)); }

  /// The columns from `first` on, `columns` of them.
  Picture cut(int first, int columns) const {
    Picture part{columns, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < columns; ++x) part.pixels.push_back(at(first + x, y));
    return part;
  }
};

/// The lights of all scenes here leave no surface black, and all outlines are of one colour.
constexpr float outline_color[] = {0.035f, 0.02f, 0.025f};

Picture picture(const render::Plan& made) {
  static const auto cpu = cpu_backend();
  const backends::Image image = draw(made, *cpu);
  Picture picture{image.width, image.height, {}};
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const bool outline = std::equal(outline_color, outline_color + 3, &image.rgba[4 * i]);
    picture.pixels.push_back(image.depth[i] == 0 ? Seen::background
                             : outline           ? Seen::outline
                                                 : Seen::surface);
  }
  return picture;
}

/// A scene of one object with the outline effect; `camera` and `object` are members of these, `more` of the scene.
render::Plan scene_of(const std::string& camera, const std::string& mesh, const std::string& object,
                      const std::string& parameters, const std::string& more = R"("time": 0)") {
  const std::string text = R"({"isoshade": 1, "scene": "s", "size": [320, 240], )" + more +
                           R"(, "camera": {)" + camera + R"(}, "objects": {"o": {"mesh": )" + mesh +
                           R"(, "effect": "../effects/outline.json", )" + object +
                           R"("parameters": {"outline_color": [0.035, 0.02, 0.025], )" + parameters + "}}}}";
  return plan(load(std::make_shared<support::SourceFile>(scene_path("of_a_test"), text)));
}

/// How many parts of a kind there are; pixels hang together at their sides and corners.
int parts(const Picture& picture, Seen what) {
  std::vector<bool> visited(picture.pixels.size());
  int found = 0;
  for (int start = 0; start < picture.width * picture.height; ++start) {
    if (visited[static_cast<size_t>(start)] || picture.pixels[static_cast<size_t>(start)] != what) continue;
    ++found;
    std::vector<int> waiting{start};
    visited[static_cast<size_t>(start)] = true;
    while (!waiting.empty()) {
      const int x = waiting.back() % picture.width, y = waiting.back() / picture.width;
      waiting.pop_back();
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (picture.at(x + dx, y + dy) != what) continue;
          const int next = (y + dy) * picture.width + x + dx;
          if (next < 0 || visited[static_cast<size_t>(next)]) continue;
          visited[static_cast<size_t>(next)] = true;
          waiting.push_back(next);
        }
    }
  }
  return found;
}

/// Pixels of the surface beside the background.
int gaps(const Picture& picture) {
  int found = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      if (picture.at(x, y) != Seen::surface) continue;
      const auto open = [&](int dx, int dy) { return picture.at(x + dx, y + dy) == Seen::background; };
      if (open(1, 0) || open(-1, 0) || open(0, 1) || open(0, -1)) ++found;
    }
  return found;
}

/// The widths of the ring on both sides of the surface, in the row or column through the middle.
std::pair<int, int> widths(const Picture& picture, bool across) {
  std::vector<Seen> line;
  for (int i = 0; i < (across ? picture.width : picture.height); ++i)
    line.push_back(across ? picture.at(i, picture.height / 2) : picture.at(picture.width / 2, i));
  const auto first = std::ranges::find(line, Seen::surface);
  const auto count = [](auto begin, auto end) {
    return static_cast<int>(std::count(begin, end, Seen::outline));
  };
  return {count(line.begin(), first), count(first, line.end())};
}

TEST(Outline, CubeOutlineIsClosedWithSmoothNormalsAndBrokenWithFaceNormals) {
  for (const int width : {960, 333}) {
    const Picture both = picture(plan(scene_path("outline_cube"), width, width / 2));
    const Picture smooth = both.cut(0, width / 2), shading = both.cut(width / 2, width / 2);
    EXPECT_EQ(parts(smooth, Seen::outline), 1) << width;
    EXPECT_EQ(gaps(smooth), 0) << width;
    EXPECT_EQ(parts(smooth, Seen::surface), 1) << width;
    EXPECT_GE(parts(shading, Seen::outline), 3) << width;
    EXPECT_GT(gaps(shading), 5) << width;
  }
}

TEST(Outline, ZeroWidthIsNotDrawn) {
  const std::string camera = R"("position": [0, 0, 5], "target": [0, 0, 0], "fov": 40)";
  const render::Plan with = scene_of(camera, "\"box\"", "", "\"outline\": 0.05");
  const render::Plan without = scene_of(camera, "\"box\"", "", "\"outline\": 0");
  EXPECT_EQ(with.stats.draws, 2);
  EXPECT_EQ(without.stats.draws, 1);
  EXPECT_NE(render::text(without.stats).find("skipped:  outline of o: outline is 0\n"), std::string::npos)
      << render::text(without.stats);
  EXPECT_GT(picture(with).count(Seen::outline), 100);
  EXPECT_EQ(picture(without).count(Seen::outline), 0);
}

TEST(Outline, ScreenWidthIsIndependentOfDistance) {
  const std::string parameters = R"("outline": 6, "outline_width_mode": "screen")";
  const std::string mesh = R"({"type": "icosphere", "radius": 1, "subdivisions": 6})";
  for (const char* camera :
       {R"("position": [0, 0, 4], "target": [0, 0, 0], "fov": 60)",
        R"("position": [0, 0, 16], "target": [0, 0, 0], "fov": 60)",
        R"("type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 4, "far": 20)"}) {
    const Picture seen = picture(scene_of(camera, mesh, "", parameters));
    for (const bool across : {true, false}) {
      const auto [before, after] = widths(seen, across);
      EXPECT_NEAR(before, 6, 1) << camera;
      EXPECT_NEAR(after, 6, 1) << camera;
    }
  }
  const char* beside_the_axis = R"("position": [0, 0, 5], "target": [0.9, 0.6, 0], "fov": 60)";
  const Picture seen = picture(scene_of(beside_the_axis, mesh, "", parameters));
  EXPECT_EQ(gaps(seen), 0);
  EXPECT_EQ(parts(seen, Seen::outline), 1);
}

TEST(Outline, ScreenWidthIsUniformAroundMeshesWithHardEdges) {
  const std::string parameters = R"("outline": 6, "outline_width_mode": "screen")";
  const std::string camera =
      R"("type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 6, "far": 100)";
  const std::string perspective = R"("position": [0, 0, 12], "target": [0, 0, 0], "fov": 30)";
  const char* box = R"({"type": "box", "size": [2, 2, 2]})";
  const char* places[] = {R"("scale": [1, 1, 1])",
                          R"("scale": [0.25, 1.25, 0.25])",
                          R"("scale": [1.25, 0.1, 2])",
                          R"("scale": [-0.25, 1.25, 0.25])",
                          R"("rotate": [0, 45, 0])",
                          R"("rotate": [0, 30, 0], "scale": [0.25, 1.25, 1])",
                          R"("rotate": [90, 0, 0], "scale": [1, 0.3, 1])"};
  for (const std::string& seen_by : {camera, perspective}) {
    for (const char* mesh : {box, R"({"type": "cylinder", "radius": 1, "height": 2})"}) {
      for (const std::string place : places) {
        const Picture seen = picture(scene_of(seen_by, mesh, "\"transform\": {" + place + "}, ", parameters));
        for (const bool across : {true, false}) {
          const auto [before, after] = widths(seen, across);
          EXPECT_NEAR(before, 6, 1) << mesh << place << across << seen_by;
          EXPECT_NEAR(after, 6, 1) << mesh << place << across << seen_by;
        }
        EXPECT_EQ(gaps(seen), 0) << mesh << place << seen_by;
        EXPECT_EQ(parts(seen, Seen::outline), 1) << mesh << place << seen_by;
      }
    }
  }
}

TEST(Outline, ScreenWidthIsIndependentOfSampleCount) {
  const std::string mesh = R"({"type": "icosphere", "radius": 1, "subdivisions": 6})";
  const std::string camera = R"("position": [0, 0, 4], "target": [0, 0, 0], "fov": 60)";
  for (const int samples : {4, 16}) {
    const Picture seen = picture(scene_of(camera, mesh, "", R"("outline": 6, "outline_width_mode": "screen")",
                                          R"("samples": )" + std::to_string(samples)));
    for (const bool across : {true, false}) {
      // Both times 6 pixels, of which the first and the last may be mixed with what lies beside.
      const auto [before, after] = widths(seen, across);
      EXPECT_NEAR(before + after, 10, 2) << samples;
    }
  }
}

TEST(Outline, WorldWidthShrinksWithDistance) {
  const std::string mesh = R"({"type": "icosphere", "radius": 1, "subdivisions": 5})";
  int last = 1000;
  for (const char* distance : {"4", "8", "16"}) {
    const std::string camera =
        R"("position": [0, 0, )" + std::string(distance) + R"(], "target": [0, 0, 0], "fov": 40)";
    const int width = widths(picture(scene_of(camera, mesh, "", "\"outline\": 0.3")), true).first;
    EXPECT_LT(width, last);
    EXPECT_GT(width, 0);
    last = width;
  }
}

TEST(Outline, WorldWidthIsEqualOnBothSidesOffCentre) {
  const std::string camera = R"("position": [0, 0, 9], "target": [0, 0, 0], "fov": 40)";
  const std::string place = R"("transform": {"translate": [-2.5, 0, 0]}, )";
  const Picture seen =
      picture(scene_of(camera, R"({"type": "icosphere", "subdivisions": 6})", place, "\"outline\": 0.3"));
  const auto [outer, inner] = widths(seen, true);
  EXPECT_GT(outer, 5);
  EXPECT_NEAR(outer, inner, 1);  // that of graphs/source_forms/hull_position.json is half as wide there
}

TEST(Outline, MirroringASymmetricMeshKeepsItsOutline) {
  const std::string camera = R"("position": [1, 2, 5], "target": [0, 0, 0], "fov": 40)";
  const std::string place = R"("transform": {"rotate": [0, 20, 10], "scale": )";
  for (const char* normals : {"smooth", "shading"}) {
    const std::string parameters = "\"outline\": 0.1, \"outline_normals\": \"" + std::string(normals) + "\"";
    // A box is its own mirror image.
    const Picture plain = picture(scene_of(camera, "\"box\"", place + "[1, 1.2, 0.8]}, ", parameters));
    const Picture mirrored = picture(scene_of(camera, "\"box\"", place + "[-1, 1.2, 0.8]}, ", parameters));
    int differing = 0;
    for (size_t i = 0; i < plain.pixels.size(); ++i)
      differing += plain.pixels[i] != mirrored.pixels[i] ? 1 : 0;
    EXPECT_LE(differing, 8) << normals;
    EXPECT_GT(mirrored.count(Seen::surface), 1000) << normals;
    EXPECT_GT(mirrored.count(Seen::outline), 200) << normals;
  }
}

TEST(Outline, HullsWriteDepth) {
  const auto cpu = cpu_backend();
  const std::string camera = R"("position": [0, 0, 4], "target": [0, 0, 0], "fov": 40)";
  const render::Plan made = scene_of(camera, "\"sphere\"", "", "\"outline\": 0.3");
  const backends::Image image = draw(made, *cpu);
  const Picture seen = picture(made);
  for (size_t i = 0; i < seen.pixels.size(); ++i)
    if (seen.pixels[i] == Seen::outline) { ASSERT_GT(image.depth[i], 0.0f); }
  EXPECT_GT(seen.count(Seen::outline), 500);
}

}  // namespace
}  // namespace isoshade::equivalence
