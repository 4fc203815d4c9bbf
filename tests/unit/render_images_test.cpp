// SPDX-License-Identifier: Apache-2.0
// Images that no program of a scene reads: what is still asked of their files, and what is said of them.
#include "compiler/lower/frame_layout.h"
#include "tests/unit/texture_scenes.h"

namespace isoshade {
namespace {

namespace word = lower::texture_word;

/// An effect with an image that a strength switches off, in scenes where it is 0.
class SwitchedOff : public Textures {
 protected:
  void SetUp() override {
    Textures::SetUp();
    folder_.write("marked.json", R"({"isoshade": 1, "effect": "marked", "parameters": {
      "map": {"type": "filename", "value": "a.png"}, "mark": {"type": "filename", "value": "a.exr"},
      "strength": {"type": "float", "value": 0}},
      "nodes": {"picture": {"type": "image", "file": {"link": "map"}},
        "marks": {"type": "image", "file": {"link": "mark"}, "filtertype": "trilinear"},
        "both": {"type": "mix", "bg": "picture", "fg": "marks", "mix": "strength"},
        "color": {"type": "ifgreater", "value1": "strength", "value2": 0, "in1": "both", "in2": "picture"}},
      "passes": [{"name": "base", "color": "color"}]})");
    const std::string exr = scene::exr({4, 4, std::vector<float>(64, 0.5f), std::vector<float>(16)});
    folder_.write("a.exr", exr);
    folder_.write("bad.exr", exr.substr(0, exr.size() - 40));
    folder_.write("no.png", "text");
    folder_.write("half.png", scene::png(2, 2, std::vector<uint8_t>(16)).substr(0, 50));
    folder_.write("levels.json",
                  R"({"isoshade": 1, "image": "i", "layers": [{"levels": ["a.png", "half.png"]}]})");
  }
  /// The first error with all skips, or without this one.
  std::string error(const std::string& parameters, bool skip) {
    options_.compiler.skips.set(interface::Skip::textures, skip);
    return plan(square("marked", parameters)) ? ""
                                              : diagnostics_.text().substr(0, diagnostics_.text().find('\n'));
  }
};

TEST_F(SwitchedOff, ImagesAreReportedWithTheirBytes) {
  const auto made = plan(square("marked"));
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.textures, 1);
  EXPECT_EQ(made->stats.texels, 16);
  EXPECT_EQ(made->frame.texel_bytes.size(), size_t{1 + 16});
  EXPECT_EQ(made->frame.texels.size(), size_t{2} * lower::byte_table::size);
  EXPECT_EQ(made->frame.textures.size(), size_t{word::stride});
  const std::string text = render::text(made->stats);
  EXPECT_NE(text.find("skipped:  texels of \"" + path("a.exr") +
                      "\" (mark of marked): no program reads them (saves " +
                      std::to_string(16 * (16 + 4 + 1)) + " bytes)\n"),
            std::string::npos)
      << text;
}

TEST_F(SwitchedOff, ImagesMayBeDamagedInside) {
  for (const char* file : {"bad.png", "bad.exr"}) {
    const std::string parameters = R"("mark": ")" + std::string(file) + "\"";
    EXPECT_EQ(error(parameters, true), "");
    EXPECT_NE(error(parameters, false).find("error[bad-image]"), std::string::npos)
        << error(parameters, false);
    EXPECT_EQ(error(parameters + R"(, "strength": 0.5)", true), error(parameters, false));
  }
  // A level of an image without levels.
  EXPECT_EQ(error(R"("map": "levels.json")", true), "");
  EXPECT_NE(error(R"("map": "levels.json")", false).find("error[bad-image]"), std::string::npos);
}

TEST_F(SwitchedOff, ImagesMustBeImagesThatTheSceneMayRead) {
  for (const auto& [file, message] :
       {std::pair("none.png", "error[missing-file]"), std::pair("no.png", "error[bad-image]"),
        std::pair("../a.png", "error[outside-reference]")}) {
    const std::string parameters = R"("mark": ")" + std::string(file) + "\"", found = error(parameters, true);
    EXPECT_NE(found.find("scene.json:"), std::string::npos) << found;
    EXPECT_NE(found.find(message), std::string::npos) << found;
    EXPECT_EQ(found, error(parameters, false));
  }
}

}  // namespace
}  // namespace isoshade
