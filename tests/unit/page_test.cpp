// SPDX-License-Identifier: Apache-2.0
#include "runtime/page/page.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "backends/interpreter/backend.h"
#include "runtime/page/encode.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string base64_of(std::string_view text) { return page::base64(std::span(text)); }

TEST(PageEncoding, Base64IsThatOfRfc4648) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of(std::string_view("\0\xff\xfe", 3)), "AP/+");
  for (const size_t size : {0, 1, 2, 3, 4, 64}) EXPECT_EQ(base64_of(std::string(size, 'x')).size(), page::base64_size(size));
}

TEST(PageEncoding, JsonInScriptsKeepsItsMeaningAndLosesItsMarkup) {
  const json before{{"</script>", "<!-- & ]]> \" ' </SCRIPT"}};
  const std::string text = page::script_json(before.dump());
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(json::parse(text), before);
}

TEST(PageEncoding, PolicySourceIsTheDigestInBase64) {
  EXPECT_EQ(page::policy_source(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
}

/// Scenes beside an effect of two passes and a post, in a folder of their own.
class PageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_page" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("outlined.json", R"({"isoshade": 1, "effect": "outlined", "doc": "</script><b>bold</b>",
      "parameters": {"tint": {"type": "color3", "value": [0.25, 0.5, 0.75], "doc": "of the surface"},
                     "width": {"type": "float", "value": 0, "min": 0, "max": 1},
                     "mode": {"type": "integer", "value": 1, "enum": ["soft", "hard"]}},
      "nodes": {"p": {"type": "position"}, "n": {"type": "normal"},
                "out": {"type": "multiply", "in1": "n", "in2": "width"},
                "moved": {"type": "add", "in1": "p", "in2": "out"},
                "color": {"type": "multiply", "in1": "tint", "in2": "n.y"}},
      "passes": [{"name": "base", "color": "color"},
                 {"name": "outline", "cull": "front", "enabled": "width", "position": "moved", "color": "tint"}]})");
    write("dim.json", R"({"isoshade": 1, "post": "dim",
      "parameters": {"factor": {"type": "float", "value": 0.5}},
      "nodes": {"c": {"type": "scenecolor"}, "dimmed": {"type": "multiply", "in1": "c", "in2": "factor"}},
      "outputs": {"color": "dimmed"}})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::optional<std::string> make(const std::string& members) {
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, (folder_ / "scene.json").string());
    const auto scene = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    EXPECT_TRUE(scene) << diagnostics_.text();
    if (!scene) return std::nullopt;
    page::PageOptions options;
    options.library = &library_;
    return page::make_page(*scene, options, *interpreter::create(), diagnostics_);
  }

  /// The JSON of the page.
  static json data_of(const std::string& page) {
    const std::string begin = "<script type=\"application/json\" id=\"data\">";
    const size_t first = page.find(begin) + begin.size();
    return json::parse(page.substr(first, page.find("</script>", first) - first));
  }

  fs::path folder_;
  support::Diagnostics diagnostics_;
  check::Library library_;
};

const std::string ball = R"("size": [32, 24], "objects": {"ball": {"mesh": "sphere", "effect": "outlined.json"}})";

TEST_F(PageTest, HasTheControlsOfEveryParameter) {
  const auto page = make(ball);
  ASSERT_TRUE(page) << diagnostics_.text();
  const json owners = data_of(*page).at("owners");
  ASSERT_EQ(owners.size(), 1u);
  EXPECT_EQ(owners[0].at("name"), "ball");
  const json& fields = owners[0].at("fields");
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_EQ(fields[0].at("doc"), "of the surface");
  EXPECT_EQ(fields[1].at("max"), 1);
  EXPECT_EQ(fields[2].at("names"), json({"soft", "hard"}));
  EXPECT_EQ(owners[0].at("values"), json({0.25, 0.5, 0.75, 0, 1}));
}

TEST_F(PageTest, HasPassesThatAreSwitchedOff) {
  const auto page = make(ball);
  ASSERT_TRUE(page) << diagnostics_.text();
  const json draws = data_of(*page).at("draws");
  ASSERT_EQ(draws.size(), 2u);
  EXPECT_EQ(draws[0].at("enabled"), nullptr);
  EXPECT_EQ(draws[1].at("enabled"), 3);
  EXPECT_EQ(draws[1].at("cull"), "front");
}

TEST_F(PageTest, EscapesTheTextsOfDocuments) {
  const auto page = make(ball);
  ASSERT_TRUE(page) << diagnostics_.text();
  EXPECT_EQ(page->find("<b>bold"), std::string::npos);
  EXPECT_EQ(data_of(*page).at("owners")[0].at("doc"), "</script><b>bold</b>");
}

TEST_F(PageTest, AsksForNoNetwork) {
  const auto page = make(ball);
  ASSERT_TRUE(page) << diagnostics_.text();
  EXPECT_NE(page->find("default-src 'none'"), std::string::npos);
  for (const char* text : {"http://", "https://", " src=", "url(", "import ", "@POLICY@", "@DATA@"})
    EXPECT_EQ(page->find(text), std::string::npos) << text;
}

TEST_F(PageTest, HasThePostsAndWhatTheyGoOver) {
  const auto page = make(ball + R"(, "posts": [
    {"name": "first", "effect": "dim.json"},
    {"name": "second", "effect": "dim.json", "inputs": {"color": "scene"}}])");
  ASSERT_TRUE(page) << diagnostics_.text();
  const json data = data_of(*page);
  ASSERT_EQ(data.at("posts").size(), 2u);
  EXPECT_EQ(data.at("posts")[0].at("over"), 0);
  EXPECT_EQ(data.at("posts")[1].at("sources"), json::array({0}));
  EXPECT_EQ(data.at("owners")[2].at("name"), "second");
}

TEST_F(PageTest, HasThePictureOfTheCpu) {
  const auto page = make(ball);
  ASSERT_TRUE(page) << diagnostics_.text();
  const json reference = data_of(*page).at("reference");
  EXPECT_EQ(reference.at("width"), 32);
  EXPECT_EQ(reference.at("height"), 24);
  EXPECT_EQ(reference.at("rgba").get<std::string>().size(), page::base64_size(32 * 24 * 16));
}

TEST_F(PageTest, RejectsScenesThatMakeTooLargeAPage) {
  EXPECT_FALSE(make(R"("objects": {"ball": {"effect": "outlined.json",
    "mesh": {"type": "sphere", "segments": 1024, "rings": 1024}}})"));
  EXPECT_NE(diagnostics_.text().find("error[too-large]: the page of scene"), std::string::npos)
      << diagnostics_.text();
}

TEST_F(PageTest, WarnsOfSamples) {
  ASSERT_TRUE(make(ball + R"(, "samples": 4)")) << diagnostics_.text();
  EXPECT_NE(diagnostics_.text().find("warning[page-limit]"), std::string::npos) << diagnostics_.text();
}

TEST_F(PageTest, WarnsOfEveryShadow) {
  ASSERT_TRUE(make(ball + R"(, "lights": {
    "sun": {"type": "directional", "direction": [0, -1, 0], "shadow": {}},
    "fill": {"type": "directional", "direction": [1, 0, 0]}})"))
      << diagnostics_.text();
  EXPECT_NE(diagnostics_.text().find("warning[page-limit]: the page draws without the shadow of light \"sun\""),
            std::string::npos)
      << diagnostics_.text();
  EXPECT_EQ(diagnostics_.all().size(), 1u);
}

TEST_F(PageTest, SaysThatItHasNoPictureOfWhatIsOpaque) {
  write("glass.json", R"({"isoshade": 1, "effect": "glass", "nodes": {"behind": {"type": "scenecolor"}},
    "passes": [{"name": "p", "blend": "over", "color": "behind"}]})");
  EXPECT_FALSE(make(R"("objects": {"pane": {"mesh": "plane", "effect": "glass.json"}})"));
  const std::string text = diagnostics_.text();
  EXPECT_NE(text.find("a page has no picture of what is opaque, which the effect of object \"pane\" reads"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("forward"), std::string::npos) << text;
}

}  // namespace
}  // namespace isoshade
