// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/scene/image_file.h"
#include "runtime/scene/output_file.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
using scene::Encoding;
using scene::FileImage;
using support::Diagnostics;

/// A folder of its own for each test.
class ImageFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("isoshade_") + info->name() + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  size_t file_count() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

FileImage special_image(int width, int height) {
  constexpr float specials[] = {0.0f,
                                -0.0f,
                                1.0f,
                                -1.5f,
                                1e30f,
                                std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::quiet_NaN(),
                                0x1p-126f,
                                0.1f,
                                65504.0f,
                                1e-7f};
  FileImage image;
  image.width = width;
  image.height = height;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  for (size_t i = 0; i < 4 * pixels; ++i) image.rgba.push_back(specials[i % std::size(specials)]);
  for (size_t i = 0; i < pixels; ++i) image.depth.push_back(specials[(i + 3) % std::size(specials)]);
  return image;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

FileImage finite(FileImage image) {
  scene::make_finite(image);
  return image;
}

TEST_F(ImageFile, ExrKeepsEveryFiniteColourAndEveryDepth) {
  const std::pair<int, int> sizes[] = {{1, 1}, {3, 2}, {15, 15}, {17, 33}, {64, 1}, {1, 100}, {200, 120}};
  for (const auto& [width, height] : sizes) {
    const FileImage image = special_image(width, height);
    Diagnostics diagnostics;
    ASSERT_TRUE(scene::write_image(path("a.exr"), image.view(), Encoding::srgb, 1, diagnostics));
    const auto read = scene::read_image(path("a.exr"), diagnostics);
    ASSERT_TRUE(read) << diagnostics.text();
    EXPECT_EQ(read->width, width);
    EXPECT_EQ(read->height, height);
    EXPECT_TRUE(same_bits(read->rgba, finite(image).rgba)) << width << " x " << height;
    EXPECT_TRUE(same_bits(read->depth, image.depth)) << width << " x " << height;
  }
}

TEST_F(ImageFile, NonFinitePixelsAreClampedWithAWarning) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  FileImage image{3, 1, {}, {inf, 1, -inf, 1, 1, 2, 3, 1, 0, nan, 0, 1}, {0, 0, 0}};
  for (const bool clean : {false, true}) {
    if (clean) image = finite(image);
    Diagnostics diagnostics;
    ASSERT_TRUE(scene::write_image(path("a.exr"), image.view(), Encoding::srgb, 1, diagnostics));
    const auto read = scene::read_image(path("a.exr"), diagnostics);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->rgba, (std::vector<float>{65504, 1, -65504, 1, 1, 2, 3, 1, 0, 0, 0, 1}));
    EXPECT_FALSE(diagnostics.has_errors());
    ASSERT_EQ(diagnostics.all().size(), clean ? 0u : 1u);
    if (clean) continue;
    EXPECT_EQ(diagnostics.all()[0].id, support::Id::not_finite);
    EXPECT_NE(diagnostics.text().find("2 pixels of the image \"" + path("a.exr").substr(0, 10)),
              std::string::npos)
        << diagnostics.text();
  }
}

TEST_F(ImageFile, PngKeepsEveryByte) {
  for (const int width : {1, 5, 300}) {
    FileImage image = special_image(width, 2);
    for (size_t i = 0; i < image.rgba.size(); ++i)
      image.rgba[i] = i % 4 == 3 ? 1 : static_cast<float>(i * 37 % 256) / 255.0f;
    Diagnostics diagnostics;
    ASSERT_TRUE(scene::write_image(path("a.png"), image.view(), Encoding::linear, 1, diagnostics));
    const auto read = scene::read_image(path("a.png"), diagnostics);
    ASSERT_TRUE(read) << diagnostics.text();
    EXPECT_EQ(read->width, width);
    EXPECT_TRUE(same_bits(scene::numbers_of(*read), image.rgba));
    EXPECT_TRUE(read->depth.empty());
  }
}

TEST_F(ImageFile, RefusesUnknownExtensionsBeforeRendering) {
  Diagnostics diagnostics;
  EXPECT_TRUE(scene::check_image_path("a.png", diagnostics));
  EXPECT_TRUE(scene::check_image_path("-", diagnostics));
  EXPECT_FALSE(scene::check_image_path("a.jpg", diagnostics));
  EXPECT_FALSE(scene::check_image_path("png", diagnostics));
  EXPECT_EQ(diagnostics.error_count(), 2u);
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(ImageFile, RejectsDamagedFilesWithAReason) {
  const FileImage image = special_image(40, 30);
  Diagnostics diagnostics;
  for (const std::string name : {"a.exr", "a.png"}) {
    ASSERT_TRUE(scene::write_image(path(name), image.view(), Encoding::srgb, 1, diagnostics));
    const std::string whole = content(path(name));
    for (const size_t length : {size_t{0}, size_t{3}, size_t{30}, whole.size() / 2, whole.size() * 3 / 4}) {
      std::ofstream(path(name), std::ios::binary) << whole.substr(0, length);
      Diagnostics found;
      EXPECT_FALSE(scene::read_image(path(name), found)) << name << " cut to " << length;
      ASSERT_EQ(found.error_count(), 1u);
      EXPECT_EQ(found.all()[0].id, support::Id::bad_image);
    }
  }
  std::ofstream(path("text.png")) << "no image";
  EXPECT_FALSE(scene::read_image(path("text.png"), diagnostics));
  EXPECT_FALSE(scene::read_image(path("missing.exr"), diagnostics));
  EXPECT_FALSE(scene::read_image(folder_.string(), diagnostics));
  EXPECT_EQ(diagnostics.error_count(), 3u);
}

TEST_F(ImageFile, FilesAreReplacedAtomicallyAndKeepTheirMode) {
  Diagnostics diagnostics;
  ASSERT_TRUE(scene::write_file(path("f"), "old", diagnostics));
  fs::permissions(path("f"), fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(scene::write_file(path("f"), std::string("new\0bytes", 9), diagnostics));
  EXPECT_EQ(content(path("f")), std::string("new\0bytes", 9));
  EXPECT_EQ(fs::status(path("f")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(file_count(), 1u);  // no temporary file is left
}

TEST_F(ImageFile, NewFilesFollowTheUmask) {
  const mode_t mask = ::umask(022);
  Diagnostics diagnostics;
  ASSERT_TRUE(scene::write_file(path("f"), "x", diagnostics));
  ::umask(mask);
  EXPECT_EQ(static_cast<int>(fs::status(path("f")).permissions()), 0644);
}

TEST_F(ImageFile, SymlinksAreWrittenThrough) {
  Diagnostics diagnostics;
  ASSERT_TRUE(scene::write_file(path("f"), "old", diagnostics));
  fs::create_symlink("f", folder_ / "link");
  ASSERT_TRUE(scene::write_file(path("link"), "new", diagnostics));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(path("f")), "new");
}

TEST_F(ImageFile, DevicesAreWrittenTo) {
  Diagnostics diagnostics;
  EXPECT_TRUE(scene::write_file("/dev/null", "x", diagnostics));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(ImageFile, ReportsFilesThatCannotBeWritten) {
  const std::string in_no_folder = path("none/f");
  const std::string folder = folder_.string();
  for (const std::string& target : {in_no_folder, folder, std::string("/dev/full"), std::string("")}) {
    Diagnostics diagnostics;
    EXPECT_FALSE(scene::write_file(target, "x", diagnostics)) << target;
    ASSERT_EQ(diagnostics.error_count(), 1u) << target;
    EXPECT_EQ(diagnostics.all()[0].id, support::Id::unwritable_file);
  }
  EXPECT_EQ(file_count(), 0u);
}

TEST(Encode, ClampsAndQuantises) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const float values[] = {-1, 0, 0.5f / 255, 1, 0.499f / 255, 2, inf, nan, -inf, 254.5f / 255, 1, 2};
  const auto bytes = scene::encode(values, Encoding::linear, 1);
  EXPECT_EQ(bytes, (std::vector<uint8_t>{0, 0, 1, 255, 0, 255, 255, 0, 0, 255, 255, 255}));
}

TEST(Encode, FollowsTheSrgbCurveExceptForAlpha) {
  const float values[] = {0.25f, 0.001f, 0.107f, 0.5f};
  const auto bytes = scene::encode(values, Encoding::srgb, 1);
  EXPECT_EQ(bytes, (std::vector<uint8_t>{188, 7, 127, 128}));
}

TEST(Encode, ExposureScalesColoursButNotAlpha) {
  const float values[] = {0.025f, 0.05f, 0.075f, 0.25f};
  const auto bytes = scene::encode(values, Encoding::linear, 2);
  EXPECT_EQ(bytes, (std::vector<uint8_t>{51, 102, 153, 64}));
}

TEST(Encode, DividesColoursByAlpha) {
  // White, half and hardly covering; more colour than alpha; none of either; alpha that is none.
  const float values[] = {0.5f, 0.5f,  0.5f, 0.5f, 1e-4f, 1e-4f, 1e-4f, 1e-4f, 0.4f, 0.1f,
                          0,    0.25f, 0,    0,    0,     0,     0.2f,  0.4f,  0.6f, -1};
  EXPECT_EQ(scene::encode(values, Encoding::srgb, 1)[0], 255);
  EXPECT_EQ(scene::encode(values, Encoding::linear, 1),
            (std::vector<uint8_t>{255, 255, 255, 128, 255, 255, 255, 0,   255, 102,
                                  0,   64,  0,   0,   0,   0,   51,  102, 153, 0}));
  // Where alpha is 0 or more than 1, colours stay.
  const float whole[] = {0.2f, 0.4f, 0.6f, 0, 0.2f, 0.4f, 0.6f, 4};
  EXPECT_EQ(scene::encode(whole, Encoding::linear, 1),
            (std::vector<uint8_t>{51, 102, 153, 0, 51, 102, 153, 255}));
}

TEST(Encode, InvertsSrgbDecodeForEveryByte) {
  for (int byte = 0; byte < 256; ++byte) {
    const double encoded = byte / 255.0;
    const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    const float values[] = {static_cast<float>(linear), 0, 0, 1};
    EXPECT_EQ(scene::encode(values, Encoding::srgb, 1)[0], byte);
  }
}

}  // namespace
}  // namespace isoshade
