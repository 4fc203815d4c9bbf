// SPDX-License-Identifier: Apache-2.0
// The chain of posts: what runs, over which images, and how many are kept.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "backends/interpreter/backend.h"
#include "runtime/render/layout.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

/// Scenes of nothing but a background of 0.5 0.25 0.125, beside posts that add and scale.
class PostsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_posts" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("gain.json", R"({"isoshade": 1, "post": "gain", "enabled": "gain",
      "parameters": {"gain": {"type": "float", "value": 2, "max": 100}},
      "nodes": {"c": {"type": "scenecolor"},
                "color": {"type": "expression", "code": "c + c * gain", "c": "c", "gain": "gain"}},
      "outputs": {"color": "color"}})");
    write("sum.json", R"({"isoshade": 1, "post": "sum", "images": ["other"],
      "nodes": {"c": {"type": "scenecolor"}, "o": {"type": "scenecolor", "image": "other"},
                "color": {"type": "add", "in1": "c", "in2": "o"}},
      "outputs": {"color": "color"}})");
    write("fill.json", R"({"isoshade": 1, "post": "fill",
      "nodes": {"color": {"type": "constant", "value": [0.75, 0.75, 0.75, 1], "to": "color4"}},
      "outputs": {"color": "color"}})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::optional<render::Plan> plan(const std::string& posts) {
    diagnostics_ = support::Diagnostics();
    const auto document = testing::document_of(
        testing::scene_text(R"("size": [5, 3], "background": [0.5, 0.25, 0.125, 1], "posts": [)" + posts +
                            "]"),
        diagnostics_, (folder_ / "scene.json").string());
    scene_ = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    if (!scene_) return std::nullopt;
    options_.compiler.library = &library_;
    options_.compiler.skips.set(interface::Skip::parameters, false);  // the tests count what is skipped
    return render::plan_frame(*scene_, options_, diagnostics_);
  }

  /// The red of the first pixel.
  float red_of(const render::Plan& plan) {
    backends::Image image;
    stats_ = render::DrawStats();
    EXPECT_TRUE(render::render(plan, *interpreter::create(), image, stats_, diagnostics_))
        << diagnostics_.text();
    EXPECT_EQ(image.width, 5);
    EXPECT_EQ(image.height, 3);
    EXPECT_EQ(image.rgba.size(), 60u);
    EXPECT_EQ(image.depth, std::vector<float>(15));
    return image.rgba[0];
  }
  float red(const std::string& posts) {
    const auto made = plan(posts);
    EXPECT_TRUE(made) << diagnostics_.text();
    return made ? red_of(*made) : -1;
  }

  bool fails_with(const std::string& posts, const std::string& part) {
    return !plan(posts) && diagnostics_.text().find(part) != std::string::npos;
  }

  static std::string post(const std::string& name, const std::string& document,
                          const std::string& more = "") {
    return R"({"name": ")" + name + R"(", "effect": ")" + document + R"(.json")" +
           (more.empty() ? "" : ", " + more) + "}";
  }

  fs::path folder_;
  check::Library library_;
  render::PlanOptions options_;
  support::Diagnostics diagnostics_;
  std::optional<scene::Scene> scene_;
  render::DrawStats stats_;
};

TEST_F(PostsTest, EachReadsTheImageOfThePostBefore) {
  EXPECT_EQ(red(""), 0.5f);
  EXPECT_EQ(stats_.kept_images, 0);
  EXPECT_EQ(red(post("a", "gain")), 1.5f);
  EXPECT_EQ(red(post("a", "gain") + "," + post("b", "gain", R"("parameters": {"gain": 1})")), 3.0f);
}

TEST_F(PostsTest, InputsNameImagesOfEarlierPosts) {
  const std::string two = post("a", "gain") + "," + post("b", "gain") + ",";
  EXPECT_EQ(red(two + post("c", "sum", R"("inputs": {"other": "a"})")), 4.5f + 1.5f);
  EXPECT_EQ(red(two + post("c", "sum", R"("inputs": {"other": "scene"})")), 4.5f + 0.5f);
  EXPECT_EQ(red(two + post("c", "sum", R"("inputs": {"color": "scene", "other": "a"})")), 0.5f + 1.5f);
  EXPECT_EQ(red(two + post("c", "sum", R"("inputs": {"other": "b"})")), 9.0f);
}

TEST_F(PostsTest, KeepsOnlyImagesThatAreReadLater) {
  std::string chain = post("p0", "gain");
  for (int i = 1; i < 8; ++i)
    chain += "," + post("p" + std::to_string(i), "gain", R"("parameters": {"gain": 1})");
  EXPECT_EQ(red(chain), 1.5f * 128);
  EXPECT_EQ(stats_.kept_images, 1);  // each runs over it in place
  // The first is read again at the end.
  EXPECT_EQ(red(chain + "," + post("last", "sum", R"("inputs": {"other": "p0"})")), 1.5f * 128 + 1.5f);
  EXPECT_EQ(stats_.kept_images, 3);
  EXPECT_EQ(red(chain + "," + post("last", "sum", R"("inputs": {"color": "scene", "other": "p0"})")), 2.0f);
  EXPECT_EQ(stats_.kept_images, 3);
  EXPECT_EQ(red(chain + "," + post("middle", "sum", R"("inputs": {"color": "scene", "other": "p0"})") + "," +
                post("last", "sum", R"("inputs": {"other": "p7"})")),
            2.0f + 1.5f * 128);
  EXPECT_EQ(stats_.kept_images, 4);
}

TEST_F(PostsTest, ImagesThatNothingReadsAnyMoreGiveUpTheirPlace) {
  std::string chain = post("p0", "gain");
  for (int i = 1; i < 32; ++i) {
    // Half as large, so that each needs an image of its own.
    const std::string size = i % 2 == 1 ? R"("size": 0.5)" : R"("size": 1)";
    chain += "," + post("p" + std::to_string(i), "gain", size);
  }
  chain += "," + post("last", "gain");
  options_.width = options_.height = 512;
  const auto made = plan(chain);
  ASSERT_TRUE(made) << diagnostics_.text();
  const render::FrameLayout layout(*made);
  EXPECT_GE(layout.groups.size(), 30u);
  constexpr size_t pixels = size_t{512} * 512, camera = 1024;
  EXPECT_LE(layout.floats, pixels * (1 + 4 + 4) + camera);  // a depth, and two images
}

TEST_F(PostsTest, RunWithWhatIsBeforeThemWhereTheyReadTheirOwnPixel) {
  const auto groups = [&](const std::string& posts) {
    const auto made = plan(posts);
    EXPECT_TRUE(made) << diagnostics_.text();
    const render::FrameLayout layout(*made);
    return std::pair(layout.drawn_steps, layout.groups.size());
  };
  const std::string two = post("a", "gain") + "," + post("b", "gain");
  EXPECT_EQ(groups(two), std::pair(size_t{2}, size_t{0}));
  EXPECT_EQ(groups(two + "," + post("c", "sum", R"("inputs": {"other": "b"})")), std::pair(size_t{2}, size_t{1}));
  // What is read later has a place of its own.
  EXPECT_EQ(groups(two + "," + post("c", "sum", R"("inputs": {"other": "scene"})")), std::pair(size_t{0}, size_t{2}));
  EXPECT_EQ(groups(post("c", "sum", R"("inputs": {"other": "scene"})") + "," + two), std::pair(size_t{0}, size_t{1}));
  EXPECT_EQ(groups(two + "," + post("c", "gain", R"("size": 0.5)") + "," + post("d", "gain")),
            std::pair(size_t{2}, size_t{2}));
}

TEST_F(PostsTest, PostsThatAreSwitchedOffPassOnTheirInput) {
  const std::string off = R"("parameters": {"gain": 0})";
  const auto made = plan(post("a", "gain") + "," + post("b", "gain", off));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->posts.steps.size(), 1u);
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].what, "post b");
  EXPECT_EQ(made->stats.skips[0].reason, "gain is 0");
  EXPECT_EQ(red_of(*made), 1.5f);
  // What would read its image reads that one.
  EXPECT_EQ(red(post("a", "gain", off) + "," + post("b", "gain") + "," +
                post("c", "sum", R"("inputs": {"other": "a"})")),
            2.0f);
  EXPECT_EQ(red(post("a", "gain") + "," + post("b", "gain", off + R"(, "inputs": {"color": "scene"})")),
            0.5f);
}

TEST_F(PostsTest, PostsWithUnusedImagesAreSkipped) {
  const auto made = plan(post("a", "gain") + "," + post("b", "fill") + "," + post("c", "gain"));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->posts.steps.size(), 2u);
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].what, "post a");
  EXPECT_EQ(made->stats.skips[0].reason, "nothing reads its image");
  EXPECT_EQ(red_of(*made), 2.25f);
}

TEST_F(PostsTest, SkippingChangesNoBit) {
  const std::string chain = post("a", "gain", R"("parameters": {"gain": 0})") + "," + post("b", "gain") +
                            "," + post("unread", "fill") + "," +
                            post("c", "gain", R"("inputs": {"color": "b"})");
  const float skipped = red(chain);
  options_.compiler.skips = interface::Skips::none();
  const auto made = plan(chain);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->posts.steps.size(), 4u);
  EXPECT_TRUE(made->stats.skips.empty());
  EXPECT_EQ(red_of(*made), skipped);
}

TEST_F(PostsTest, SizesAreFractionsRoundedUp) {
  const auto made = plan(post("a", "gain", R"("size": 0.5)") + "," + post("b", "gain", R"("size": 0.01)") +
                         "," + post("c", "gain"));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->posts.steps[0].width, 3);
  EXPECT_EQ(made->posts.steps[0].height, 2);
  EXPECT_EQ(made->posts.steps[1].width, 1);
  EXPECT_EQ(made->posts.steps[1].height, 1);
  EXPECT_EQ(made->posts.steps[2].width, 5);
  EXPECT_EQ(red_of(*made), 0.5f * 27);
}

TEST_F(PostsTest, KeptImagesAreLimited) {
  options_.width = options_.height = scene::max_size;
  const auto reading = [&](int count) {
    std::string chain = post("p0", "gain"), sums;
    for (int i = 1; i < count; ++i) {
      chain += "," + post("p" + std::to_string(i), "gain");
      sums += "," + post("s" + std::to_string(i), "sum",
                         R"("inputs": {"other": "p)" + std::to_string(i - 1) + "\"}");
    }
    return chain + sums;
  };
  EXPECT_TRUE(plan(reading(3))) << diagnostics_.text();
  EXPECT_TRUE(fails_with(reading(5), "error[too-large]: the images of the posts have more than"));
}

TEST_F(PostsTest, TheLastPostMakesTheWholeImage) {
  EXPECT_TRUE(fails_with(post("a", "gain", R"("size": 0.5)"),
                         "error[out-of-range]: post \"a\" makes the scene's image"));
  EXPECT_TRUE(fails_with(
      post("a", "gain", R"("size": 0.5)") + "," + post("b", "gain", R"("parameters": {"gain": 0})"),
      "error[out-of-range]: post \"a\" makes the scene's image"));
}

TEST_F(PostsTest, ReportsUnknownImagesAndParameters) {
  EXPECT_TRUE(
      fails_with(post("a", "sum"), "error[unknown-image]: post \"a\" has no input for the image \"other\""));
  EXPECT_TRUE(fails_with(post("a", "sum", R"("inputs": {"othr": "scene", "other": "scene"})"),
                         "error[unknown-image]: the document of post \"a\" has no image \"othr\""));
  EXPECT_TRUE(fails_with(post("a", "gain", R"("parameters": {"gian": 1})"), "error[unknown-parameter]"));
  EXPECT_TRUE(fails_with(post("a", "gain", R"("parameters": {"gain": 101})"), "error[out-of-range]"));
  EXPECT_TRUE(fails_with(post("a", "missing"), "error[missing-file]"));
}

}  // namespace
}  // namespace isoshade
