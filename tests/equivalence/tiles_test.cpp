// SPDX-License-Identifier: Apache-2.0
// Skip::tiles changes no bit, is taken where a tile is empty or a block of pixels shows one object, and only there.
#include "compiler/interface/skips.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

using interface::Skip;

struct Drawn {
  backends::Image image;
  render::DrawStats stats;
};

/// What a renderer makes of a plan, with or without the skip.
Drawn draw(render::Plan& plan, render::Renderer& renderer, bool skip) {
  plan.skips.set(Skip::tiles, skip);
  plan.skips.set(Skip::frames, false);  // a frame that is kept draws no tiles
  support::Diagnostics diagnostics;
  Drawn drawn;
  if (!renderer.draw(plan, drawn.stats, diagnostics)) ADD_FAILURE() << diagnostics.text();
  const scene::ImageView view = renderer.image();
  drawn.image = {view.width, view.height, {view.rgba.begin(), view.rgba.end()}, {view.depth.begin(), view.depth.end()}};
  return drawn;
}

/// Of 1 lane, of 8, of the widest, and with the interpreter in place of compiled code.
std::vector<std::pair<std::string, std::unique_ptr<backends::Backend>>> cpu_backends() {
  std::vector<std::pair<std::string, std::unique_ptr<backends::Backend>>> all;
  for (const char* lanes : {"1", "8", ""}) all.emplace_back("lanes " + std::string(lanes), cpu_backend(lanes));
  support::Diagnostics diagnostics;
  cpu::CpuOptions options;
  options.execution = cpu::Execution::interpreted;
  all.emplace_back("interpreted", cpu::create(options, diagnostics));
  return all;
}

class Tiles : public SceneFolder {
 protected:
  void SetUp() override {
    const auto pass = [](const std::string& color, const std::string& more = "") {
      return R"("passes": [{"name": "base", "color": ")" + color + "\"" + more + "}]}";
    };
    folder_.write("lit.json", R"json({"isoshade": 1, "effect": "lit", "nodes": {"n": {"type": "normal"},
      "c": {"type": "expression", "code": "color4(n.x * 0.5 + 0.5, n.y * 0.5 + 0.5, n.z * 0.5 + 0.5, 1)", "n": "n"}},)json" +
                                   pass("c"));
    folder_.write("glass.json", R"json({"isoshade": 1, "effect": "glass", "nodes": {"n": {"type": "normal"},
      "c": {"type": "expression", "code": "color4(n.x * n.x, 0.2, 0.3, 0.4)", "n": "n"}},)json" +
                                     pass("c", R"(, "blend": "over")"));
    folder_.write("tone.json", R"json({"isoshade": 1, "post": "tone",
      "parameters": {"gain": {"type": "float", "value": 2, "min": 0, "max": 8}},
      "nodes": {"s": {"type": "scenecolor"}, "d": {"type": "scenedepth"},
        "c": {"type": "expression", "code": "color4(s.rgb * gain / (s.rgb + 1), s.a + d)", "s": "s", "d": "d.out", "gain": "gain"}},
      "outputs": {"color": "c"}})json");
    folder_.write("place.json", R"json({"isoshade": 1, "post": "place",
      "nodes": {"s": {"type": "scenecolor"}, "d": {"type": "scenedepth"}, "r": {"type": "viewray"},
        "c": {"type": "expression", "code": "color4(s.rgb + color3(abs(r) * (d + 0.25)), s.a)", "s": "s", "d": "d.out", "r": "r"}},
      "outputs": {"color": "c"}})json");
    folder_.write("beside.json", R"json({"isoshade": 1, "post": "beside",
      "nodes": {"s": {"type": "scenecolor"}, "o": {"type": "scenecolor", "offsetx": 1},
        "c": {"type": "expression", "code": "s * 0.5 + o * 0.5", "s": "s", "o": "o"}},
      "outputs": {"color": "c"}})json");
    folder_.write("divide.json", R"json({"isoshade": 1, "post": "divide",
      "nodes": {"s": {"type": "scenecolor"}, "d": {"type": "scenedepth"},
        "c": {"type": "expression", "code": "color4(s.rgb / d, s.a)", "s": "s", "d": "d.out"}},
      "outputs": {"color": "c"}})json");
  }

  /// A ball on the left; the right of the picture is empty.
  static std::string ball(const std::string& more = "", const std::string& posts = "") {
    return R"("background": [0.1, 0.2, 0.35, 1], "objects": {
      "ball": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "lit.json",
               "transform": {"translate": [-1.2, 0, 0]}})" +
           more + "}" + (posts.empty() ? "" : ", \"posts\": [" + posts + "]");
  }
  static std::string post(const std::string& name, const std::string& more = "") {
    return R"({"name": ")" + name + R"(", "effect": ")" + name + R"(.json")" + more + "}";
  }
  static constexpr const char* glass = R"(, "glass": {"mesh": "box", "effect": "glass.json",
      "transform": {"translate": [-0.3, 0.2, 1], "rotate": [20, 30, 0]}})";

  /// Expects that all draw the same with the skip, without it, and a second time; returns what was counted with it.
  backends::TileCounts counted(Size size, int samples, const std::string& members) {
    render::Plan reference = plan(size, samples, members, false), all = plan(size, samples, members);
    const backends::Image expected = equivalence::draw(reference, *interpreter_);
    std::optional<backends::TileCounts> found;
    for (const auto& [name, cpu] : cpu_backends()) {
      const std::string what = text(size, samples) + ", " + name;
      render::Renderer renderer(*cpu);
      const Drawn without = draw(all, renderer, false), with = draw(all, renderer, true), again = draw(all, renderer, true);
      expect_identical(expected, without.image, what + ", without");
      expect_identical(expected, with.image, what + ", with");
      expect_identical(expected, again.image, what + ", again");
      const backends::TileCounts &counts = with.stats.tiles, &none = without.stats.tiles;
      EXPECT_EQ(none.empty + none.kept + none.blocks_of_one_object, 0) << what;
      EXPECT_EQ(none.tiles, counts.tiles) << what;
      EXPECT_TRUE(without.stats.skips.empty()) << what;
      EXPECT_EQ(counts.kept, 0) << what;
      EXPECT_EQ(again.stats.tiles.empty, counts.empty) << what;
      EXPECT_TRUE(!found || (found->empty == counts.empty && found->blocks_of_one_object == counts.blocks_of_one_object)) << what;
      found = counts;
      kept_ = again.stats.tiles.kept;
    }
    return *found;
  }

  std::unique_ptr<backends::Backend> interpreter_ = interpreter::create();
  int64_t kept_ = 0;  ///< when the same was drawn again
};

constexpr Size sizes[] = {{203, 135}, {128, 64}, {130, 71}};

TEST_F(Tiles, ThatAreEmptyAreFilledAndBlocksOfOneObjectAreNotSorted) {
  for (const Size size : sizes)
    for (const int samples : {1, 4}) {
      const backends::TileCounts counts = counted(size, samples, ball());
      EXPECT_GT(counts.empty, 0);
      EXPECT_LT(counts.empty, counts.tiles);
      EXPECT_GT(counts.blocks_of_one_object, 0);
      EXPECT_LT(counts.blocks_of_one_object, counts.blocks);
      EXPECT_EQ(kept_, counts.empty);
    }
}

TEST_F(Tiles, UnderWhatIsBlendedAreDrawn) {
  for (const int samples : {1, 4}) {
    const backends::TileCounts counts = counted({203, 135}, samples, ball(glass));
    EXPECT_GT(counts.empty, 0);
    EXPECT_GT(counts.blocks_of_one_object, 0);
    EXPECT_EQ(kept_, counts.empty);
  }
}

TEST_F(Tiles, BehindPostsThatIgnoreThePlaceAreFilled) {
  for (const int samples : {1, 4}) {
    const backends::TileCounts counts = counted({203, 135}, samples, ball("", post("tone")));
    EXPECT_GT(counts.empty, 0);
    EXPECT_EQ(kept_, counts.empty);
  }
}

TEST_F(Tiles, BehindPostsThatTellPixelsApartAreProcessed) {
  for (const int samples : {1, 4}) {
    const backends::TileCounts counts = counted({203, 135}, samples, ball("", post("tone") + "," + post("place")));
    EXPECT_GT(counts.empty, 0);
    EXPECT_EQ(kept_, 0);
  }
}

TEST_F(Tiles, AreNotKeptWherePostsWriteOverThePicture) {
  // The image of the second post takes the place of the picture.
  const backends::TileCounts counts = counted({203, 135}, 1, ball("", post("beside") + "," + R"({"name": "again", "effect": "beside.json"})"));
  EXPECT_GT(counts.empty, 0);
  EXPECT_EQ(kept_, 0);
}

/// Copies of a plane side by side, two pixels wide, over all of the picture.
TEST_F(Tiles, ThatShowManyObjectsAreDrawnAsBefore) {
  const backends::TileCounts counts = counted({64, 64}, 1, R"("camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 64},
    "objects": {"strips": {"mesh": {"type": "plane", "size": [2, 64]}, "effect": "lit.json",
      "transform": {"translate": [-31, 0, 0], "rotate": [90, 0, 0]}, "repeat": [{"count": 32, "step": [2, 0, 0]}]}})");
  EXPECT_EQ(counts.tiles, 1);
  EXPECT_EQ(counts.blocks, 64);
  EXPECT_EQ(counts.empty, 0);
  EXPECT_EQ(counts.blocks_of_one_object, 0);
}

TEST_F(Tiles, OfPixelsThatAreNotFiniteAreFound) {
  // The left tile is covered; the depth of the right one is 0.
  const std::string members = R"("camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 64},
    "background": [0.5, 0.5, 0.5, 1], "objects": {"wall": {"mesh": {"type": "plane", "size": [64, 64]}, "effect": "lit.json",
      "transform": {"translate": [-32, 0, 0], "rotate": [90, 0, 0]}}}, "posts": [)" + post("divide") + "]";
  render::Plan made = plan({128, 64}, 1, members);
  const auto cpu = cpu_backend();
  render::Renderer renderer(*cpu);
  const Drawn without = draw(made, renderer, false), with = draw(made, renderer, true);
  EXPECT_EQ(with.stats.tiles.empty, 1);
  EXPECT_EQ(without.stats.non_finite.result.count, 64 * 64);
  EXPECT_EQ(with.stats.non_finite.result.count, 64 * 64);
  expect_identical(without.image, with.image, "not finite");
}

/// Frames of one renderer: tiles that were empty and are again are kept, unless their color has changed.
class TilesOfFrames : public Tiles {
 protected:
  /// Draws frames one after the other and returns how many tiles of the last one were kept.
  int64_t kept_in(const std::vector<std::string>& frames, int samples = 1) {
    const auto cpu = cpu_backend();
    render::Renderer renderer(*cpu);
    int64_t kept = 0;
    for (size_t i = 0; i < frames.size(); ++i) {
      render::Plan frame = plan({203, 135}, samples, frames[i]);
      const Drawn drawn = draw(frame, renderer, true);
      expect_identical(equivalence::draw(frame, *interpreter_), drawn.image, "frame " + std::to_string(i));
      kept = drawn.stats.tiles.kept;
    }
    return kept;
  }
  static std::string ball_at(const std::string& x, const std::string& background = "[0.1, 0.2, 0.3, 1]", const std::string& posts = "") {
    return R"("background": )" + background + R"(, "objects": {
      "ball": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "lit.json",
               "transform": {"translate": [)" + x + R"(, 0, 0]}}})" +
           (posts.empty() ? "" : ", \"posts\": [" + posts + "]");
  }
};

TEST_F(TilesOfFrames, KeepWhatStaysEmpty) {
  for (const int samples : {1, 4}) {
    EXPECT_GT(kept_in({ball_at("-1.5"), ball_at("-1.4")}, samples), 0);
    // Where the ball was and will be nothing is kept.
    EXPECT_GT(kept_in({ball_at("-1.5"), ball_at("1.5"), ball_at("-1.5")}, samples), 0);
  }
}

TEST_F(TilesOfFrames, AreFilledAgainInAnotherColor) {
  EXPECT_EQ(kept_in({ball_at("-1.5"), ball_at("-1.5", "[0.1, 0.2, 0.30001, 1]")}), 0);
  const auto toned = [](const std::string& gain) {
    return ball_at("-1.5", "[0.1, 0.2, 0.3, 1]", post("tone", R"(, "parameters": {"gain": )" + gain + "}"));
  };
  EXPECT_GT(kept_in({toned("1"), toned("1")}), 0);
  EXPECT_EQ(kept_in({toned("1"), toned("1.5")}), 0);
}

TEST_F(TilesOfFrames, AreFilledAgainAfterOtherFrames) {
  const std::string plain = ball_at("-1.5"), posts = ball_at("-1.5", "[0.1, 0.2, 0.3, 1]", post("beside") + "," + R"({"name": "again", "effect": "beside.json"})");
  EXPECT_EQ(kept_in({plain, posts, plain}), 0);
  const auto cpu = cpu_backend();
  render::Renderer renderer(*cpu);
  render::Plan frame = plan({203, 135}, 1, plain);
  draw(frame, renderer, true);
  draw(frame, renderer, false);
  EXPECT_EQ(draw(frame, renderer, true).stats.tiles.kept, 0);
  // The same image, of which a tile of samples takes another part.
  render::Plan sampled = plan({203, 135}, 4, ball_at("1.5"));
  const Drawn drawn = draw(sampled, renderer, true);
  EXPECT_EQ(drawn.stats.tiles.kept, 0);
  expect_identical(equivalence::draw(sampled, *interpreter_), drawn.image, "4 samples after 1");
}

}  // namespace
}  // namespace isoshade::equivalence
