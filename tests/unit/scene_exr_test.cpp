// SPDX-License-Identifier: Apache-2.0
// OpenEXR files of every kind, from bytes that OpenEXR wrote.
#include <ImfArray.h>
#include <ImfInputFile.h>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "runtime/scene/chromaticities.h"
#include "runtime/scene/image_file.h"
#include "tests/unit/exr_files.h"

namespace isoshade {
namespace {

using namespace testing;
using scene::FileImage;

FileImage decoded(const std::string& bytes) {
  auto image = scene::decode_image(bytes);
  const auto header = scene::read_header(bytes);
  EXPECT_TRUE(image.found && header.found) << image.reason;
  if (!image.found || !header.found) return {};
  EXPECT_EQ(header.found->width, image.found->width);
  EXPECT_EQ(header.found->height, image.found->height);
  return *std::move(image.found);
}

std::string reason(const std::string& bytes) {
  const auto image = scene::decode_image(bytes);
  EXPECT_FALSE(image.found);
  return image.reason;
}

std::array<float, 4> pixel(const FileImage& image, int x, int y) {
  const size_t at = 4 * static_cast<size_t>(y * image.width + x);
  return {image.rgba.at(at), image.rgba.at(at + 1), image.rgba.at(at + 2), image.rgba.at(at + 3)};
}

/// Replaces the first `from` by as many bytes of `to`.
std::string patched(std::string bytes, std::string_view from, std::string_view to, size_t behind = 0) {
  const size_t at = bytes.find(from);
  EXPECT_NE(at, std::string::npos);
  if (at != std::string::npos) bytes.replace(at + behind, to.size(), to);
  return bytes;
}

void expect_values(const ExrPart& part, const FileImage& image, float error) {
  const Imath::Box2i window = part.window();
  ASSERT_EQ(image.width, window.max.x - window.min.x + 1);
  ASSERT_EQ(image.height, window.max.y - window.min.y + 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(pixel(image, x, y)[c], part.value(c, x + window.min.x, y + window.min.y), error)
            << x << " " << y << " " << c;
}

class ExrCompression : public ::testing::TestWithParam<int> {};

TEST_P(ExrCompression, IsReadInScanlinesAndTilesOfEveryType) {
  const auto compression = static_cast<Imf::Compression>(GetParam());
  const bool lossy = compression >= Imf::B44_COMPRESSION;
  for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      ExrPart part;
      part.display = {{-3, 5}, {67, 52}};
      part.compression = compression;
      part.channels = {{"R", type}, {"G", type}, {"B", type}, {"depth.Z", Imf::FLOAT}};
      part.order = order;
      if (type == Imf::UINT)
        part.value = [](size_t c, int x, int y) {
          return static_cast<float>(10 * c) + static_cast<float>(x + y + 4);
        };
      const float error = lossy && type != Imf::UINT ? 0.15f : 0.0f;
      expect_values(part, decoded(exr_file(part)), error);
      if (order == Imf::DECREASING_Y) continue;
      for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
        for (const Imf::LevelRoundingMode rounding : {Imf::ROUND_DOWN, Imf::ROUND_UP}) {
          if (rounding == Imf::ROUND_UP && type != Imf::HALF) continue;
          part.tiles = Imf::TileDescription(16, 24, mode, rounding);
          expect_values(part, decoded(exr_file(part)), error);
        }
      }
    }
  }
}

constexpr const char* compression_names[] = {"none",  "rle", "zips", "zip",  "piz",
                                             "pxr24", "b44", "b44a", "dwaa", "dwab"};
static_assert(std::size(compression_names) == size_t{Imf::NUM_COMPRESSION_METHODS});
INSTANTIATE_TEST_SUITE_P(Methods, ExrCompression, ::testing::Range(0, int{Imf::NUM_COMPRESSION_METHODS}),
                         [](const auto& info) { return std::string(compression_names[info.param]); });

/// Values with every exponent, and others that repeat.
FileImage varied_image(int width, int height) {
  FileImage image{width, height, {}, {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float noise = std::sin(static_cast<float>(x * 12.9898 + y * 78.233)) * 43758.5f;
      image.rgba.insert(image.rgba.end(), {noise, std::ldexp(1.1f, (x - y) % 120), x < width / 2 ? 0.25f : noise, 1});
      image.depth.push_back(static_cast<float>(y) / static_cast<float>(height));
    }
  }
  return image;
}

TEST(Exr, EveryCompressionThatIsWrittenKeepsEveryBit) {
  for (const auto& [name, compression] : scene::lossless_compressions) {
    for (const auto& [width, height] : {std::pair(1, 1), {5, 15}, {64, 16}, {33, 70}}) {
      const FileImage image = varied_image(width, height);
      const std::string file = scene::exr(image.view(), compression);
      const FileImage read = decoded(file);
      EXPECT_EQ(read.rgba, image.rgba) << name << " " << width << " x " << height;
      EXPECT_EQ(read.depth, image.depth) << name;
      // The library itself reads the file, and finds what is stated.
      ExrInput input(file);
      Imf::InputFile library(input);
      EXPECT_EQ(static_cast<int>(library.header().compression()), static_cast<int>(compression)) << name;
      std::vector<float> red(static_cast<size_t>(width * height));
      Imf::FrameBuffer buffer;
      buffer.insert("R", Imf::Slice::Make(Imf::FLOAT, red.data(), library.header().dataWindow()));
      library.setFrameBuffer(buffer);
      library.readPixels(0, height - 1);
      for (size_t i = 0; i < red.size(); ++i) ASSERT_EQ(red[i], image.rgba[4 * i]) << name << " " << i;
    }
  }
}

TEST(Exr, WrittenFilesDoNotDependOnTheNumberOfThreads) {
  const FileImage image = varied_image(120, 100);
  for (const auto& [name, compression] : scene::lossless_compressions) {
    const std::string file = scene::exr(image.view(), compression, 1);
    for (const int threads : {2, 7, 0}) EXPECT_TRUE(scene::exr(image.view(), compression, threads) == file) << name;
  }
}

TEST(Exr, NoiseIsStoredAndTheRestCompressed) {
  FileImage noise = varied_image(64, 64);
  const size_t size = 5 * sizeof(float) * 64 * 64;
  EXPECT_LT(scene::exr(noise.view(), scene::ExrCompression::zip).size(), size * 3 / 4);
  std::mt19937 random(1);
  for (std::vector<float>* values : {&noise.rgba, &noise.depth})
    for (float& value : *values) value = std::bit_cast<float>(static_cast<uint32_t>(random()) & 0xbfffffffu);
  const std::string file = scene::exr(noise.view(), scene::ExrCompression::zip);
  EXPECT_LT(file.size(), size + 500);
  EXPECT_EQ(decoded(file).rgba, noise.rgba);
}

TEST(Exr, DataWindowIsPlacedInTheDisplayWindow) {
  ExrPart part;
  part.display = {{0, 0}, {3, 3}};
  part.data = Imath::Box2i({1, 1}, {2, 2});
  part.value = [](size_t channel, int, int) { return channel == 0 ? 1.0f : 0.25f; };
  const FileImage image = decoded(exr_file(part));
  ASSERT_EQ(image.width, 4);
  ASSERT_EQ(image.height, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const bool inside = x >= 1 && x <= 2 && y >= 1 && y <= 2;
      const std::array<float, 4> expected =
          inside ? std::array<float, 4>{1, 0.25f, 0.25f, 1} : std::array<float, 4>{0, 0, 0, 0};
      EXPECT_EQ(pixel(image, x, y), expected) << x << " " << y;
    }
  }
}

TEST(Exr, DataOutsideTheDisplayWindowAreCropped) {
  for (const bool tiled : {false, true}) {
    ExrPart part;
    part.display = {{10, -20}, {13, -18}};
    part.data = Imath::Box2i({8, -22}, {12, -10});
    if (tiled) part.tiles = Imf::TileDescription(2, 2);
    part.channels = {{"R"}, {"G"}, {"B"}, {"A"}, {"Z", Imf::FLOAT}};
    const FileImage image = decoded(exr_file(part));
    ASSERT_EQ(image.width, 4);
    ASSERT_EQ(image.height, 3);
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 4; ++x) {
        std::array<float, 4> expected{};
        float depth = 0;
        for (size_t c = 0; c < 4 && x < 3; ++c) expected[c] = part.value(c, x + 10, y - 20);
        if (x < 3) depth = part.value(4, x + 10, y - 20);
        EXPECT_EQ(pixel(image, x, y), expected) << x << " " << y;
        EXPECT_EQ(image.depth[static_cast<size_t>(4 * y + x)], depth);
      }
    }
    part.data = Imath::Box2i({100, 100}, {102, 102});
    EXPECT_EQ(pixel(decoded(exr_file(part)), 0, 0), (std::array<float, 4>{}));
  }
}

TEST(Exr, ReadsTheFirstPartWithColours) {
  ExrPart depth, color, other;
  depth.name = "depth";
  depth.channels = {{"Z", Imf::FLOAT}};
  color.name = "color";
  color.tiles = Imf::TileDescription(4, 2);
  color.compression = Imf::PIZ_COMPRESSION;
  other.name = "other";
  other.value = [](size_t, int, int) { return 9.0f; };
  expect_values(color, decoded(exr_file(std::vector{depth, color, other})), 0);
  expect_values(other, decoded(exr_file(std::vector{depth, other, color})), 0);
  EXPECT_NE(reason(exr_file(std::vector{depth})).find("neither channels R, G and B nor Y"),
            std::string::npos);
}

TEST(Exr, FirstLayerWithColoursIsReadIfNoPartHasColours) {
  ExrPart part;
  part.channels = {{"light.R"},  {"light.G"},  {"light.B"}, {"albedo.B"},
                   {"albedo.G"}, {"albedo.R"}, {"noise.R"}};
  EXPECT_EQ(pixel(decoded(exr_file(part)), 0, 0), (std::array<float, 4>{5, 4, 3, 1}));
  part.channels[6].name = "Y";
  EXPECT_EQ(pixel(decoded(exr_file(part)), 0, 0), (std::array<float, 4>{6, 6, 6, 1}));
}

TEST(Exr, GreyBecomesThreeEqualColours) {
  ExrPart part;
  part.channels = {{"Y"}, {"A"}};
  EXPECT_EQ(pixel(decoded(exr_file(part)), 1, 0), (std::array<float, 4>{0.125f, 0.125f, 0.125f, 1.125f}));
}

TEST(Exr, RejectsChromaAndSubsampledColours) {
  ExrPart part;
  part.channels = {{"Y"}, {"RY", Imf::HALF, 2}, {"BY", Imf::HALF, 2}};
  part.display = {{0, 0}, {7, 5}};
  EXPECT_NE(reason(exr_file(part)).find("luminance and chroma"), std::string::npos);
  part.channels = {{"R"}, {"G"}, {"B", Imf::HALF, 2}};
  EXPECT_NE(reason(exr_file(part)).find("\"B\" has fewer samples than pixels"), std::string::npos);
  part.channels = {{"R"}, {"G"}, {"B"}, {"other", Imf::HALF, 2}, {"Z", Imf::FLOAT, 2}};
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    part.compression = static_cast<Imf::Compression>(compression);
    expect_values(part, decoded(exr_file(part)), compression >= Imf::B44_COMPRESSION ? 0.15f : 0);
  }
  part.channels = {{"R"}, {"G"}};
  EXPECT_NE(reason(exr_file(part)).find("neither channels R, G and B nor Y"), std::string::npos);
}

TEST(Exr, PrimariesAreConvertedToRec709) {
  ExrPart part;
  part.channels = {{"R", Imf::FLOAT}, {"G", Imf::FLOAT}, {"B", Imf::FLOAT}};
  part.value = [](size_t channel, int x, int) {
    return x == 3 || static_cast<int>(channel) == x ? 1.0f : 0.0f;
  };
  // Rec. 2020 to Rec. 709, by ITU-R BT.2087-0.
  part.chromaticities =
      Imf::Chromaticities({0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.3290f});
  constexpr float bt2087[3][3] = {
      {1.6605f, -0.1246f, -0.0182f}, {-0.5876f, 1.1329f, -0.1006f}, {-0.0728f, -0.0083f, 1.1187f}};
  FileImage image = decoded(exr_file(part));
  for (int x = 0; x < 3; ++x)
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, x, 0)[c], bt2087[x][c], 1e-4f);
  // ACES AP0 with its white of about D60: white stays white. The columns are those of Bradford's adaptation
  // (colour-science: RGB_COLOURSPACE_ACES2065_1 to sRGB).
  part.chromaticities =
      Imf::Chromaticities({0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.0770f}, {0.32168f, 0.33767f});
  constexpr float ap0[3][3] = {
      {2.5217f, -0.2765f, -0.0154f}, {-1.1341f, 1.3727f, -0.1530f}, {-0.3876f, -0.0962f, 1.1684f}};
  image = decoded(exr_file(part));
  for (int x = 0; x < 3; ++x)
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, x, 0)[c], ap0[x][c], 2e-3f);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, 3, 0)[c], 1, 2e-6f);
  // Those of Rec. 709, rounded, change no bit.
  part.chromaticities = Imf::Chromaticities({0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f});
  part.value = [](size_t channel, int x, int y) {
    return 0.1f * static_cast<float>(channel) + static_cast<float>(x * y);
  };
  expect_values(part, decoded(exr_file(part)), 0);
  part.chromaticities = Imf::Chromaticities({0.3f, 0.3f}, {0.3f, 0.3f}, {0.15f, 0.06f}, {0.3127f, 0.329f});
  EXPECT_NE(reason(exr_file(part)).find("chromaticities are degenerate"), std::string::npos);
}

TEST(Exr, Rec2020MatrixHasTheRecordedBits) {
  const auto found =
      scene::to_rec709({{0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.3290f}});
  ASSERT_TRUE(found.valid && found.matrix);
  EXPECT_EQ(*found.matrix, (scene::ColorMatrix{0x1.a915f2p+0f, -0x1.2cdf4cp-1f, -0x1.2a64aap-4f,
                                               -0x1.fe28b4p-4f, 0x1.2205bcp+0f, -0x1.1197e4p-7f,
                                               -0x1.2961d4p-6f, -0x1.9bf88cp-4f, 0x1.1e651p+0f}));
}

TEST(Exr, NonFiniteNumbersAreClampedAndCounted) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
    ExrPart part;
    part.channels = {{"R", type}, {"G", type}, {"B", type}, {"A", type}};
    part.value = [&](size_t channel, int x, int y) {
      if (y > 0 || x > 2) return 2.0f;
      return x == 0 ? inf : x == 1 ? -inf : channel == 1 ? nan : 3.0f;
    };
    const FileImage image = decoded(exr_file(part));
    EXPECT_EQ(image.not_finite, 3u);
    EXPECT_EQ(pixel(image, 0, 0), (std::array<float, 4>{65504, 65504, 65504, 65504}));
    EXPECT_EQ(pixel(image, 1, 0), (std::array<float, 4>{-65504, -65504, -65504, -65504}));
    EXPECT_EQ(pixel(image, 2, 0), (std::array<float, 4>{3, 0, 3, 3}));
    EXPECT_EQ(pixel(image, 3, 0), (std::array<float, 4>{2, 2, 2, 2}));
  }
}

TEST(Exr, RejectsTruncatedFiles) {
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const bool tiled : {false, true}) {
      ExrPart part;
      part.display = {{0, 0}, {40, 40}};
      part.compression = static_cast<Imf::Compression>(compression);
      if (tiled) part.tiles = Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS);
      const std::string whole = exr_file(part);
      decoded(whole);
      for (size_t length = 0; length < whole.size(); length += 1 + length / 50)
        ASSERT_FALSE(scene::decode_image(whole.substr(0, length)).found) << compression << " " << length;
      EXPECT_NE(reason(whole.substr(0, whole.size() - 1)).find("truncated"), std::string::npos);
    }
  }
}

TEST(Exr, ChunksWithTooFewSamplesAreErrors) {
  // A row of zlib that is whole, but shorter than the pixels; the row was never written by anyone otherwise.
  ExrPart part;
  part.display = {{0, 0}, {63, 0}};
  part.value = [](size_t, int, int) { return 1.0f; };
  for (const Imf::Compression compression : {Imf::ZIPS_COMPRESSION, Imf::RLE_COMPRESSION}) {
    part.compression = compression;
    const std::string whole = exr_file(part);
    ExrPart narrow = part;
    narrow.display = {{0, 0}, {31, 0}};
    const std::string half = exr_file(narrow);
    // The only chunk stands at the end, after its row and size.
    const auto chunk = [](const std::string& bytes) {
      const size_t table = bytes.rfind(std::string("screenWindowWidth"));
      const size_t at = table + 18 + 6 + 4 + 4 + 1 + 8;
      return at;
    };
    EXPECT_EQ(reason(whole.substr(0, chunk(whole)) + half.substr(chunk(half))), "the file is damaged");
  }
}

TEST(Exr, RejectsChunksOfZeros) {
  ExrPart part;
  part.display = {{0, 0}, {63, 63}};
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    part.compression = static_cast<Imf::Compression>(compression);
    std::string bytes = exr_file(part);
    std::fill(bytes.begin() + static_cast<ptrdiff_t>(bytes.size() / 2), bytes.end(), '\0');
    EXPECT_FALSE(scene::decode_image(bytes).found) << compression;
  }
}

TEST(Exr, SizesAreCheckedBeforeMemoryIsAllocated) {
  ExrPart part;
  const std::string whole = exr_file(part);
  const auto window = [&](const char* name, int32_t x, int32_t y) {
    std::string numbers(16, '\0');
    for (size_t i = 0; i < 4; ++i) {
      numbers[8 + i] = static_cast<char>(x >> (8 * i) & 255);
      numbers[12 + i] = static_cast<char>(y >> (8 * i) & 255);
    }
    return patched(whole, std::string(name) + std::string("\0box2i\0\20\0\0\0", 11), numbers,
                   std::string(name).size() + 11);
  };
  EXPECT_EQ(reason(window("displayWindow", 8192, 3)), "a side is not from 1 to 8192 pixels");
  EXPECT_EQ(reason(window("displayWindow", 3, 8192)), "a side is not from 1 to 8192 pixels");
  EXPECT_NE(reason(window("dataWindow", 20'000, 3)).find("data window"), std::string::npos);
  for (const int32_t far : {-1, INT32_MAX, INT32_MIN, 1 << 25})
    EXPECT_NE(reason(window("dataWindow", far, 3)).find("out of range"), std::string::npos);
  // Large, but without the chunks that it would need.
  EXPECT_NE(reason(window("dataWindow", 8191, 8191)).find("truncated"), std::string::npos);
  EXPECT_NE(
      reason(patched(whole, std::string("\0chlist\0", 8), "\xff\xff\xff\x7f", 8)).find("header is damaged"),
      std::string::npos);
}

TEST(Exr, TiledFilesWithoutATileSizeAreRefused) {
  // The type says tiles, the flag does not; and the other way round.
  std::string header("screenWindowWidth\0float\0\4\0\0\0\0\0\x80\x3f", 32);
  const std::string type("type\0string\0\12\0\0\0tiledimage", 26);
  ExrPart part;
  std::string bytes = exr_file(part);
  bytes.insert(bytes.find(header) + header.size(), type);
  EXPECT_NE(reason(bytes).find("tiledimage"), std::string::npos);
  bytes = exr_file(part);
  bytes[5] = 2;
  EXPECT_NE(reason(bytes).find("tiles"), std::string::npos);
}

TEST(Exr, RejectsDeepFiles) {
  std::string bytes = exr_file(ExrPart());
  bytes[5] = 8;
  EXPECT_EQ(reason(bytes), "it is deep: its pixels are lists");
}

TEST(Exr, WrittenFilesAreReadByOpenExrBitForBit) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float specials[] = {0.0f, -0.0f, 1e-40f, 65504, 1e30f, inf, -inf, nan, 0.1f, -1.5f};
  constexpr int width = 37, height = 21;
  FileImage image{width, height, {}, {}, {}};
  for (size_t i = 0; i < size_t{4} * width * height; ++i) image.rgba.push_back(specials[i % 10]);
  for (size_t i = 0; i < size_t{1} * width * height; ++i) image.depth.push_back(specials[(i + 3) % 10]);
  const std::string bytes = scene::exr(image.view());

  class Memory : public Imf::IStream {
   public:
    explicit Memory(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char* to, int count) override {
      std::memcpy(to, bytes_.data() + at_, static_cast<size_t>(count));
      at_ += static_cast<size_t>(count);
      return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t at) override { at_ = at; }

   private:
    const std::string& bytes_;
    size_t at_ = 0;
  } memory(bytes);
  Imf::InputFile file(memory);
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  EXPECT_FALSE(file.header().hasTileDescription());
  constexpr const char* names[] = {"R", "G", "B", "A", "Z"};
  std::vector<std::vector<float>> planes(5, std::vector<float>(size_t{1} * width * height));
  Imf::FrameBuffer buffer;
  int count = 0;
  for (auto channel = file.header().channels().begin(); channel != file.header().channels().end();
       ++channel, ++count)
    EXPECT_EQ(channel.channel().type, Imf::FLOAT);
  EXPECT_EQ(count, 5);
  for (size_t c = 0; c < 5; ++c)
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(planes[c].data()), 4, 4 * width));
  file.setFrameBuffer(buffer);
  file.readPixels(0, height - 1);
  for (size_t i = 0; i < image.depth.size(); ++i) {
    for (size_t c = 0; c < 4; ++c) ASSERT_EQ(std::memcmp(&planes[c][i], &image.rgba[4 * i + c], 4), 0) << i;
    ASSERT_EQ(std::memcmp(&planes[4][i], &image.depth[i], 4), 0) << i;
  }
}

}  // namespace
}  // namespace isoshade
