// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <sys/stat.h>
#include <unistd.h>

#include "compiler/functions/color.h"
#include "runtime/raster/tile.h"
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
    ASSERT_TRUE(scene::write_image(path("a.exr"), image.view(), {}, diagnostics));
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
    ASSERT_TRUE(scene::write_image(path("a.exr"), image.view(), {}, diagnostics));
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
    ASSERT_TRUE(scene::write_image(path("a.png"), image.view(), {.encoding = Encoding::linear}, diagnostics));
    const auto read = scene::read_image(path("a.png"), diagnostics);
    ASSERT_TRUE(read) << diagnostics.text();
    EXPECT_EQ(read->width, width);
    EXPECT_TRUE(same_bits(scene::numbers_of(*read), image.rgba));
    EXPECT_TRUE(read->depth.empty());
  }
}

TEST_F(ImageFile, TheFormatIsToldByTheEndingOrByItsName) {
  const auto format = [](const std::string& path, const std::string& name = "") {
    Diagnostics diagnostics;
    const scene::ImageFormat* const found = scene::output_format(path, name, diagnostics);
    EXPECT_EQ(found == nullptr, diagnostics.has_errors()) << path;
    return found == nullptr ? diagnostics.text() : std::string(found->name);
  };
  EXPECT_EQ(format("a.png"), "png");
  EXPECT_EQ(format("b/a.EXR"), "exr");
  EXPECT_EQ(format("a.jpeg"), "jpg");
  EXPECT_EQ(format("a.ppm"), "ppm");
  EXPECT_EQ(format("a.pfm"), "pfm");
  EXPECT_EQ(format("-"), "png");
  EXPECT_EQ(format("-", "exr"), "exr");
  EXPECT_EQ(format("/dev/stdout", "ppm"), "ppm");
  EXPECT_EQ(format("a.tmp", "jpg"), "jpg");
  EXPECT_EQ(format("a.jpeg", "jpg"), "jpg");
  for (const char* unknown : {"a.bmp", "png", "a.", "a.hdr", "a.pgm", ""})
    EXPECT_NE(format(unknown).find("end the name in .png, .exr, .jpg, .ppm or .pfm"), std::string::npos) << format(unknown);
  EXPECT_NE(format("a.png", "exr").find("does not fit the format exr"), std::string::npos);
  EXPECT_NE(format("a.hdr", "png").find("end the name in .png"), std::string::npos);
}

TEST_F(ImageFile, EveryFormatThatIsWrittenIsReadAgain) {
  FileImage image = special_image(20, 10);
  for (float& value : image.rgba) value = 0.5f;
  for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1;
  size_t written = 0;
  for (const scene::ImageFormat& format : scene::image_formats()) {
    if (!format.is_written()) continue;
    ++written;
    EXPECT_NE(format.write_bytes == nullptr, format.write_floats == nullptr) << format.name;
    Diagnostics diagnostics;
    const std::string file = path("a." + std::string(format.name));
    ASSERT_TRUE(scene::write_image(file, image.view(), {.encoding = Encoding::linear}, diagnostics));
    const auto read = scene::read_image(file, diagnostics);
    ASSERT_TRUE(read) << diagnostics.text();
    EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.text();
    EXPECT_TRUE(format.is(content(file))) << format.name;
    EXPECT_EQ(read->has_bytes(), format.write_bytes != nullptr);
    for (const float value : scene::numbers_of(*read)) ASSERT_TRUE(value == 1 || std::abs(value - 0.5f) <= 0.51f / 255) << value;
  }
  EXPECT_EQ(written, 5u);
}

TEST_F(ImageFile, LosingAlphaIsAWarningAndGivesTheImageOverBlack) {
  const FileImage image{2, 1, {}, {0.2f, 0.4f, 0.6f, 0.8f, 0.2f, 0.4f, 0.6f, 1}, {0, 0}};
  for (const char* name : {"a.jpg", "a.ppm", "a.pfm", "a.png", "a.exr"}) {
    Diagnostics diagnostics;
    ASSERT_TRUE(scene::write_image(path(name), image.view(), {.encoding = Encoding::linear, .quality = 100}, diagnostics));
    const bool keeps = std::string(name).ends_with("png") || std::string(name).ends_with("exr");
    ASSERT_EQ(diagnostics.all().size(), keeps ? 0u : 1u) << name;
    if (keeps) continue;
    EXPECT_EQ(diagnostics.all()[0].id, support::Id::lost_alpha);
    EXPECT_NE(diagnostics.text().find("1 of 2 pixels"), std::string::npos) << diagnostics.text();
    ASSERT_TRUE(scene::write_image(path(name), image.view(), {}, diagnostics));
    EXPECT_EQ(diagnostics.all().size(), 1u) << "once";
    const auto numbers = scene::numbers_of(*scene::read_image(path(name), diagnostics));
    EXPECT_EQ(numbers[0], numbers[4]) << name;
    EXPECT_EQ(numbers[3], 1) << name;
  }
}

TEST_F(ImageFile, RejectsDamagedFilesWithAReason) {
  const FileImage image = special_image(40, 30);
  Diagnostics diagnostics;
  for (const std::string name : {"a.exr", "a.png"}) {
    ASSERT_TRUE(scene::write_image(path(name), image.view(), {}, diagnostics));
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

/// As encode.h says, one value after the other.
uint8_t encoded(float value, float alpha, float exposure, Encoding encoding, scene::Alpha use) {
  const float divisor = use == scene::Alpha::straight && alpha > 0 && alpha < 1 ? alpha : 1;
  const float color = value * exposure / divisor;
  const float number = encoding == Encoding::srgb ? functions::srgb_encode(color) : color;
  return static_cast<uint8_t>(std::floor((number > 0 ? number < 1 ? number : 1 : 0) * 255.0f + 0.5f));
}

TEST(Encode, IsTheSameInLanesOfEveryWidthAndOnAnyNumberOfThreads) {
  std::mt19937 random(1);
  std::vector<float> values;
  for (int i = 0; i < 4 * 70'001; ++i) {
    const auto bits = static_cast<uint32_t>(random());
    const bool any = random() % 4 == 0;  // any bits, also infinities, NaN and denormals
    values.push_back(any ? std::bit_cast<float>(bits) : static_cast<float>(bits % 100'000) / 90'000.0f);
  }
  for (const Encoding encoding : {Encoding::srgb, Encoding::linear}) {
    for (const scene::Alpha use : {scene::Alpha::straight, scene::Alpha::over_black}) {
      const auto bytes = scene::encode(values, encoding, 1.25f, use, 1);
      ASSERT_EQ(bytes.size(), values.size());
      {
        const lanes::FpGuard guard;
        for (size_t i = 0; i < values.size(); ++i) {
          const float alpha = values[i | 3];
          const bool is_alpha = i % 4 == 3;
          const uint8_t expected = !is_alpha ? encoded(values[i], alpha, 1.25f, encoding, use)
                                   : use == scene::Alpha::straight
                                       ? encoded(alpha, 1, 1, Encoding::linear, use)
                                       : 255;
          ASSERT_EQ(bytes[i], expected) << i << " " << values[i] << " " << alpha;
        }
      }
      for (const int threads : {2, 5, 0}) EXPECT_EQ(scene::encode(values, encoding, 1.25f, use, threads), bytes);
      for (const auto& [width, function] :
           {std::pair(4, &scene::detail::encode_4), {8, &scene::detail::encode_8}, {16, &scene::detail::encode_16}}) {
        if (width > raster::rasterizer_lanes()) continue;
        for (const size_t pixels : {size_t{1}, size_t{31}, size_t{32}, size_t{33}, size_t{70'001}}) {
          std::vector<uint8_t> some(4 * pixels);
          const lanes::FpGuard guard;
          function({values.data(), some.data(), pixels, 1.25f, encoding == Encoding::srgb, use == scene::Alpha::straight});
          ASSERT_TRUE(std::equal(some.begin(), some.end(), bytes.begin())) << width << " lanes, " << pixels << " pixels";
        }
      }
    }
  }
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
