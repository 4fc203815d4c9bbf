// SPDX-License-Identifier: Apache-2.0
// render --frames: which files there are, and what they show.
#include <gtest/gtest.h>

#include "tests/unit/command.h"

namespace isoshade {
namespace {

using namespace testing;

class Frames : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    file("flat.json", R"({"isoshade": 1, "effect": "flat", "passes": [{"name": "base", "color": [1, 0.5, 0.25]}]})");
    write_scene(R"("objects.ball.transform.translate": {"keys": [[0, [-1, 0, 0]], [1, [1, 0, 0]]]})");
  }
  void write_scene(const std::string& animations) const {
    file("scene.json", R"({"isoshade": 1, "scene": "moving", "size": [24, 16],
      "camera": {"position": [0, 0.5, 5], "target": [0, 0, 0]},
      "objects": {"ball": {"mesh": "sphere", "effect": "flat.json"}}, "animate": {)" + animations + "}}");
  }
  Outcome render(const std::string& options) const {
    return run("render " + (folder_ / "scene.json").string() + " --backend interpreter " + options);
  }
  std::string out(const std::string& name) const { return "-o '" + (folder_ / name).string() + "'"; }
  bool exists(const std::string& name) const { return fs::exists(folder_ / name); }
};

TEST_F(Frames, AreTheSceneAtTheirTimesUnderTheirNumbers) {
  const Outcome outcome = render("--frames 0:1:3 " + out("f_%03d.png"));
  ASSERT_EQ(outcome.exit, 0) << outcome.text;
  EXPECT_TRUE(exists("f_000.png") && exists("f_001.png") && exists("f_002.png"));
  EXPECT_FALSE(exists("f_003.png"));
  ASSERT_EQ(render("--time 0.5 " + out("half.png")).exit, 0);
  EXPECT_EQ(read(folder_ / "f_001.png"), read(folder_ / "half.png"));
  EXPECT_NE(read(folder_ / "f_000.png"), read(folder_ / "f_002.png"));
}

TEST_F(Frames, FormOneFileThatIsShownAgainAndAgain) {
  ASSERT_EQ(render("--frames 0:1:3 " + out("a.apng")).exit, 0);
  const std::string apng = read(folder_ / "a.apng");
  EXPECT_NE(apng.find(std::string("acTL\0\0\0\3\0\0\0\0", 12)), std::string::npos);
  ASSERT_EQ(render("--frames 0:1:3 " + out("a.gif")).exit, 0);
  EXPECT_EQ(read(folder_ / "a.gif").substr(0, 6), "GIF89a");
}

TEST_F(Frames, GoToAPipeOneAfterTheOther) {
  ASSERT_EQ(render("--frames 0:1:3 --format ppm -o - > " + (folder_ / "all.ppm").string()).exit, 0);
  ASSERT_EQ(render("--frames 0:1:3 " + out("f_%d.ppm")).exit, 0);
  EXPECT_EQ(read(folder_ / "all.ppm"), read(folder_ / "f_0.ppm") + read(folder_ / "f_1.ppm") + read(folder_ / "f_2.ppm"));
  EXPECT_EQ(read(folder_ / "f_0.ppm").size(), 13u + 3 * 24 * 16);
}

TEST_F(Frames, MayBeCompressedAsSingleImagesMay) {
  ASSERT_EQ(render("--frames 0:1:2 --compression none " + out("f_%d.exr")).exit, 0);
  ASSERT_EQ(render("--frames 0:1:2 " + out("z_%d.exr")).exit, 0);
  EXPECT_GT(read(folder_ / "f_1.exr").size(), 24u * 16 * 20);
  EXPECT_LT(read(folder_ / "z_1.exr").size(), 24u * 16 * 20);
  const Outcome outcome = render("--frames 0:1:2 --quality 10 " + out("f.gif"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("one file of all frames"), std::string::npos) << outcome.text;
}

TEST_F(Frames, TurnTheCameraOnceAboutItsTarget) {
  write_scene("");
  ASSERT_EQ(render("--frames 0:0:4 --turntable " + out("t%d.exr")).exit, 0);
  ASSERT_EQ(render(out("still.exr")).exit, 0);
  // A ball at the target looks the same from all sides, up to the triangles that it consists of; the first frame is still.
  EXPECT_EQ(read(folder_ / "t0.exr"), read(folder_ / "still.exr"));
  write_scene(R"("objects.ball.transform.translate": {"keys": [[0, [1, 0, 0]]]})");
  ASSERT_EQ(render("--frames 0:0:4 --turntable " + out("u%d.exr")).exit, 0);
  ASSERT_EQ(render("--set camera.position=5,0.5,0 " + out("side.exr")).exit, 0);
  EXPECT_EQ(read(folder_ / "u1.exr"), read(folder_ / "side.exr"));
}

TEST_F(Frames, NeedANameWithOneNumber) {
  for (const char* name : {"f.png", "f_%d_%d.png", "f_%s.png", "f_%n.png", "f_%1$d.png", "f_%5000d.png", "f_%ld.png", "f%", "%%d.png"}) {
    const Outcome outcome = render("--frames 0:1:2 " + out(name));
    EXPECT_EQ(outcome.exit, 2) << name;
    EXPECT_NE(outcome.text.find("does not tell the names of the frames"), std::string::npos) << outcome.text;
  }
  EXPECT_EQ(render("--frames 0:1:2 " + out("f_%d.bmp")).exit, 2);
  ASSERT_EQ(render("--frames 0:1:2 " + out("100%%_%2d.png")).exit, 0);
  EXPECT_TRUE(exists("100%_ 1.png"));
}

TEST_F(Frames, UsageErrorsAreReported) {
  for (const char* options : {"--frames 1:0:2", "--frames 0:1", "--frames 0:1:0", "--frames 0:1:x", "--frames 0:1:1000000",
                              "--frames a:1:2", "--frames 0", "--frames -3", "--frames 2.5", "--frames 0:1:2 --time 1",
                              "--turntable"})
    EXPECT_EQ(render(std::string(options) + " " + out("f_%d.png")).exit, 2) << options;
}

TEST_F(Frames, ARunThatFailsLeavesWholeFilesAlone) {
  // The ball has no size in the middle.
  write_scene(R"("objects.ball.transform.scale": {"keys": [[0, -1], [1, 1]]})");
  const Outcome outcome = render("--frames 0:1:3 " + out("f_%d.png"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("zero or nearly so"), std::string::npos) << outcome.text;
  EXPECT_EQ(read(folder_ / "f_0.png").substr(1, 3), "PNG");
  EXPECT_FALSE(exists("f_1.png") || exists("f_2.png"));
  EXPECT_EQ(render("--frames 0:1:3 " + out("f.gif")).exit, 2);
  EXPECT_FALSE(exists("f.gif"));
}

TEST_F(Frames, WithoutAnAnimationAreReadOnceAndAlike) {
  const std::string render_borders = "render " + graphs + "/scenes/borders.json --size 24x16 --backend interpreter ";
  ASSERT_EQ(run(render_borders + "--frames 3 " + out("s_%d.exr")).exit, 0);
  ASSERT_EQ(run(render_borders + out("still.exr")).exit, 0);
  for (const char* name : {"s_0.exr", "s_1.exr", "s_2.exr"}) EXPECT_EQ(read(folder_ / name), read(folder_ / "still.exr"));
}

TEST_F(Frames, AreOnlyMeasuredWithoutAnOutput) {
  const Outcome outcome = render("--frames 0:1:4 --turntable --stats");
  ASSERT_EQ(outcome.exit, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("times of 4 frames of 24 x 16"), std::string::npos) << outcome.text;
  for (const char* step : {"load ", "plan ", "build ", "vertices ", "clip ", "draw ", "posts ", "write ", "frame "})
    EXPECT_NE(outcome.text.find(std::string("\n") + step), std::string::npos) << step << outcome.text;
  // What was drawn is reported once, of the first frame.
  EXPECT_EQ(outcome.text.find("scene:"), outcome.text.rfind("scene:")) << outcome.text;
  EXPECT_EQ(render("--frames 2").exit, 2);
  EXPECT_EQ(render("--stats").exit, 2);
  EXPECT_EQ(render("--stats-json x.json " + out("f.png")).exit, 2);
}

TEST_F(Frames, WriteTheirTimesAsJson) {
  const std::string path = (folder_ / "times.json").string();
  ASSERT_EQ(render("--frames 3 --stats-json " + path).exit, 0);
  EXPECT_NE(read(path).find("\"isoshade_frame_times\": 1"), std::string::npos) << read(path);
  const Outcome outcome = render("--frames 3 --stats-json " + (folder_ / "scene.json").string());
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("would destroy an input"), std::string::npos) << outcome.text;
}

TEST_F(Frames, NeverOverwriteAnInput) {
  const Outcome outcome = run_command("cd " + folder_.string() + " && cp scene.json s_0.png && " + ISOSHADE_COMMAND +
                                      " render s_0.png --backend interpreter --frames 0:1:2 -o s_%d.png");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("would destroy an input"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace isoshade
