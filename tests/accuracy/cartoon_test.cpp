// SPDX-License-Identifier: Apache-2.0
// What the cartoon effect promises to the eye, counted in pixels.
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

namespace fs = std::filesystem;

constexpr int size = 256;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

/// A black ball with one white highlight, by a cartoon effect whose highlights are cut out by this function.
backends::Image ball_with_highlights_by(const std::string& function) {
  std::string pattern = (fs::temp_directory_path() / "isoshade-cartoon-XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  std::string effect = text_of(ISOSHADE_GRAPHS "/effects/cartoon.json");
  while (effect.find("\"toon/highlight\"") != std::string::npos)
    effect = replaced(effect, "\"toon/highlight\"", "\"highlight.json\"");
  while (effect.find("\"../textures/") != std::string::npos) {
    const size_t at = effect.find("\"../textures/") + 1;
    effect.erase(at, effect.find('"', at) - at);
  }
  std::ofstream(folder / "cartoon.json") << effect;
  std::ofstream(folder / "highlight.json") << function;
  const std::string scene = (folder / "scene.json").string();
  std::ofstream(scene)
      << R"({"isoshade": 1, "scene": "ball", "camera": {"position": [0, 0, 4], "target": [0, 0, 0]},
    "lights": {"sun": {"type": "directional", "direction": [0.4, -0.5, -0.8]}},
    "objects": {"ball": {"mesh": {"type": "sphere", "radius": 1, "segments": 128, "rings": 64}, "effect": "cartoon.json",
      "parameters": {"color": [0, 0, 0], "ambient": [0, 0, 0], "outline": 0, "specular": [1, 1, 1],
                     "specular_scale": 0.1, "specular2": [0, 0, 0]}}}})";
  const backends::Image image = draw(plan(scene, size, size), *cpu_backend());
  fs::remove_all(folder);
  return image;
}

/// Neighbouring pixels that differ by more than half of the highlight.
int jumps(const backends::Image& image) {
  const auto red = [&](int x, int y) { return image.rgba[static_cast<size_t>(4 * (y * size + x))]; };
  int count = 0;
  for (int y = 0; y + 1 < size; ++y)
    for (int x = 0; x + 1 < size; ++x)
      count += (std::abs(red(x + 1, y) - red(x, y)) > 0.5f) + (std::abs(red(x, y + 1) - red(x, y)) > 0.5f);
  return count;
}

TEST(Cartoon, HighlightEdgesAreAntialiased) {
  const std::string smooth = text_of(ISOSHADE_GRAPHS "/library/toon/highlight.json");
  const std::string hard = replaced(smooth, "smoothstep(-w, w, inwards)", "step(0 * w, inwards)");
  const int soft_jumps = jumps(ball_with_highlights_by(smooth));
  const int hard_jumps = jumps(ball_with_highlights_by(hard));
  RecordProperty("soft_jumps", soft_jumps);
  RecordProperty("hard_jumps", hard_jumps);
  EXPECT_GT(hard_jumps, 50) << "the highlight has a border";
  EXPECT_GE(hard_jumps, 5 * soft_jumps);
}

}  // namespace
}  // namespace isoshade::equivalence
