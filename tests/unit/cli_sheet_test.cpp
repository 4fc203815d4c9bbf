// SPDX-License-Identifier: Apache-2.0
// isoshade sheet.
#include <cstdint>
#include <vector>

#include "runtime/scene/image_file.h"
#include "tests/unit/command.h"

namespace isoshade {
namespace {

using namespace testing;

constexpr int gap = 10, text_height = 14;  // in pixels

class Sheet : public Cli {
 protected:
  static scene::FileImage decoded(const std::string& path) {
    auto image = scene::decode_image(read(path)).found;
    EXPECT_TRUE(image && image->has_bytes()) << path;
    return image.value_or(scene::FileImage());
  }
  /// Whether the sheet shows this picture with its upper left corner here.
  static bool shows(const scene::FileImage& sheet, int left, int top, const scene::FileImage& picture) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        if (sheet.bytes[static_cast<size_t>((top + y) * sheet.width + left + x)] !=
            picture.bytes[static_cast<size_t>(y * picture.width + x)])
          return false;
    return true;
  }
};

TEST_F(Sheet, ShowsEachPictureThatRenderDrawsWithTheSameSettings) {
  const std::string tub = graphs + "/scenes/outline_cube.json", size = " --size 40x30";
  const Outcome outcome = run("sheet " + tub + size + " --vary camera.fov=20:40:3 --vary 'background=1,0,0,1;0,0,1,1' -o " +
                              file("sheet.png"));
  ASSERT_EQ(outcome.exit, 0) << outcome.text;
  const scene::FileImage sheet = decoded(file("sheet.png"));
  const int left = sheet.width - 3 * (40 + gap), top = 3 * gap + 2 * text_height;
  ASSERT_GT(left, gap);
  ASSERT_EQ(sheet.height, top + 2 * (30 + gap));
  int row = 0;
  for (const char* background : {"1,0,0,1", "0,0,1,1"}) {
    int column = 0;
    for (const char* fov : {"20", "30", "40"}) {
      const Outcome drawn = run("render " + tub + size + " --set camera.fov=" + fov + " --set background=" + background +
                                " -o " + file("one.png"));
      ASSERT_EQ(drawn.exit, 0) << drawn.text;
      EXPECT_TRUE(shows(sheet, left + column * (40 + gap), top + row * (30 + gap), decoded(file("one.png"))))
          << background << " " << fov;
      ++column;
    }
    ++row;
  }
  // Captions are dark on white paper.
  size_t ink = 0;
  for (int y = 0; y < top; ++y)
    for (int x = 0; x < sheet.width; ++x) ink += sheet.bytes[static_cast<size_t>(y * sheet.width + x)] == 0xff202020u;
  EXPECT_GT(ink, 500u);
}

TEST_F(Sheet, OfOneParameterIsARow) {
  const Outcome outcome = run("sheet " + testing::scene + " --size 16x9 --vary 'time=0;1.5' -o " + file("sheet.png"));
  ASSERT_EQ(outcome.exit, 0) << outcome.text;
  const scene::FileImage sheet = decoded(file("sheet.png"));
  EXPECT_EQ(sheet.width, gap + 2 * (16 + gap));
  EXPECT_EQ(sheet.height, 3 * gap + 2 * text_height + 9 + gap);
}

TEST_F(Sheet, IsWrittenInAnyFormatOfBytes) {
  const std::string command = "sheet " + testing::scene + " --size 16x9 --backend interpreter --vary 'time=0;1.5' ";
  ASSERT_EQ(run(command + "-o " + file("sheet.png")).exit, 0);
  ASSERT_EQ(run(command + "--format ppm -o - > " + file("sheet.ppm")).exit, 0);
  EXPECT_EQ(decoded(file("sheet.ppm")).bytes, decoded(file("sheet.png")).bytes);
  ASSERT_EQ(run(command + "--quality 80 -o " + file("sheet.jpg")).exit, 0);
  EXPECT_EQ(decoded(file("sheet.jpg")).width, decoded(file("sheet.png")).width);
}

TEST_F(Sheet, ExplainsWhatItCannotDo) {
  const auto message = [&](const std::string& arguments, const std::string& output = "sheet.png") {
    const Outcome outcome = run("sheet " + testing::scene + " " + arguments + " -o " + file(output));
    EXPECT_EQ(outcome.exit, 2) << arguments;
    EXPECT_FALSE(fs::exists(folder_ / output)) << arguments;
    return outcome.text;
  };
  for (const char* wrong : {"time", "=0:1:2", "time=", "time=0:1", "time=0:1:0", "time=0:1:65", "time=0:1:2:3", "time=a:1:2",
                            "time=0,1:1:2", "time=1;;2"})
    EXPECT_NE(message("--vary '" + std::string(wrong) + "'").find("NAME=FROM:TO:COUNT"), std::string::npos) << wrong;
  EXPECT_NE(message("").find("--vary is required"), std::string::npos);
  EXPECT_NE(message("--vary nothing=0:1:2").find("error[unknown-setting]"), std::string::npos);
  EXPECT_NE(message("--vary time=0:1:64 --size 1000x10").find("error[too-large]: the sheet would have"), std::string::npos);
  EXPECT_NE(message("--vary time=0:1:2", "sheet.exr").find("end the name in .png"), std::string::npos);
  EXPECT_NE(message("--vary time=0:1:2", "sheet.bmp").find("end the name in .png"), std::string::npos);
  EXPECT_NE(message("--vary time=0:1:2 --quality 50").find("--quality needs the format jpg"), std::string::npos);
  EXPECT_EQ(run("sheet " + testing::scene + " --vary time=0:1:2 --vary time=0:1:2 --vary time=0:1:2 -o " + file("a.png")).exit, 2);
}

}  // namespace
}  // namespace isoshade
