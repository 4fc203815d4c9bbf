// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gif_lib.h>
#include <gtest/gtest.h>

#include "runtime/scene/animation_file.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene {
namespace {

constexpr int width = 16, height = 8;

/// A picture of one colour.
std::vector<uint8_t> picture(uint8_t r, uint8_t g, uint8_t b, uint8_t a = 255) {
  std::vector<uint8_t> rgba;
  for (int i = 0; i < width * height; ++i) rgba.insert(rgba.end(), {r, g, b, a});
  return rgba;
}

std::string file_of(AnimationFormat format, double seconds = 0.04) {
  AnimationFile file(format, width, height, seconds);
  file.add(picture(255, 0, 0));
  file.add(picture(0, 100, 0));
  file.add(picture(0, 0, 255, 0));
  return file.finish();
}

uint32_t number(std::string_view bytes, size_t at, size_t count) {
  uint32_t value = 0;
  for (size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

TEST(AnimationFile, AnApngShowsItsFirstPictureAsAPngAndCountsTheRest) {
  const std::string file = file_of(AnimationFormat::apng);
  const auto first = decode_png(file);
  ASSERT_TRUE(first.found) << first.reason;
  EXPECT_EQ(first.found->bytes, std::vector<uint32_t>(width * height, 0xff0000ffu));
  std::vector<std::string> types;
  std::vector<uint32_t> numbers;
  for (size_t at = 8; at < file.size(); at += 12 + number(file, at, 4)) {
    types.push_back(file.substr(at + 4, 4));
    if (types.back() == "acTL") {
      EXPECT_EQ(number(file, at + 8, 4), 3u);
      EXPECT_EQ(number(file, at + 12, 4), 0u);
    }
    if (types.back() == "fcTL" || types.back() == "fdAT") numbers.push_back(number(file, at + 8, 4));
    if (types.back() == "fcTL") {
      EXPECT_EQ(number(file, at + 12, 4), static_cast<uint32_t>(width));
      EXPECT_EQ(number(file, at + 16, 4), static_cast<uint32_t>(height));
      EXPECT_EQ(number(file, at + 28, 2), 40u);
      EXPECT_EQ(number(file, at + 30, 2), 1000u);
    }
  }
  EXPECT_EQ(types, (std::vector<std::string>{"IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL", "fdAT", "IEND"}));
  for (size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
}

/// A picture of an APNG as a PNG of its own: with the data of the chunk fdAT as IDAT, whose CRC decoders must accept.
TEST(AnimationFile, PicturesOfAnApngHoldTheDataOfTheirPngs) {
  const std::string file = file_of(AnimationFormat::apng);
  const std::string bytes = png_data(width, height, picture(0, 100, 0), true, 1).at(0);
  EXPECT_NE(file.find(std::string("fdAT") + std::string("\0\0\0\2", 4) + bytes), std::string::npos);
}

struct Reading {
  std::string_view bytes;
  size_t at = 0;
};

GifFileType* open_gif(Reading& reading) {
  int error = 0;
  return DGifOpen(
      &reading,
      [](GifFileType* file, GifByteType* out, int count) {
        auto& from = *static_cast<Reading*>(file->UserData);
        const size_t taken = std::min(from.bytes.size() - from.at, static_cast<size_t>(count));
        std::copy_n(from.bytes.data() + from.at, taken, out);
        from.at += taken;
        return static_cast<int>(taken);
      },
      &error);
}

TEST(AnimationFile, AGifShowsEachPictureInItsNearestColours) {
  const std::string bytes = file_of(AnimationFormat::gif);
  Reading reading{bytes};
  GifFileType* const gif = open_gif(reading);
  ASSERT_NE(gif, nullptr);
  ASSERT_EQ(DGifSlurp(gif), GIF_OK);
  EXPECT_EQ(gif->SWidth, width);
  EXPECT_EQ(gif->SHeight, height);
  ASSERT_EQ(gif->ImageCount, 3);
  for (int i = 0; i < 3; ++i) {
    GraphicsControlBlock control;
    ASSERT_EQ(DGifSavedExtensionToGCB(gif, i, &control), GIF_OK);
    EXPECT_EQ(control.DelayTime, 4);
    const SavedImage& image = gif->SavedImages[i];
    double green = 0;
    for (int p = 0; p < width * height; ++p) {
      const int index = image.RasterBits[p];
      if (i == 2) {
        EXPECT_EQ(index, control.TransparentColor);
        continue;
      }
      const GifColorType color = gif->SColorMap->Colors[index];
      EXPECT_EQ(color.Red, i == 0 ? 255 : 0);
      EXPECT_EQ(color.Blue, 0);
      green += color.Green;
    }
    // The dither mixes the level below and the level above in proportion.
    if (i == 1) {
      EXPECT_NEAR(green / (width * height), 100, 1);
    }
  }
  int error = 0;
  DGifCloseFile(gif, &error);
}

TEST(AnimationFile, PicturesLastAsLongTogetherAsTheyShould) {
  // 31 pictures at 30 each second: 1033 ms, though none can last 33.3 ms or 3.33 hundredths of a second.
  for (const auto format : {AnimationFormat::apng, AnimationFormat::gif}) {
    AnimationFile file(format, 1, 1, 1.0 / 30);
    const std::vector<uint8_t> pixel{10, 20, 30, 255};
    for (int i = 0; i < 31; ++i) file.add(pixel);
    const std::string bytes = file.finish();
    const bool is_gif = format == AnimationFormat::gif;
    const std::string mark = is_gif ? std::string("\x21\xf9\x04", 3) : "fcTL";
    const size_t offset = is_gif ? 4 : 24;
    int steps = 0;
    for (size_t at = bytes.find(mark); at != std::string::npos; at = bytes.find(mark, at + 1)) {
      const auto byte = [&](size_t i) { return int{static_cast<unsigned char>(bytes[at + offset + i])}; };
      steps += is_gif ? byte(0) + 256 * byte(1) : 256 * byte(0) + byte(1);
    }
    EXPECT_EQ(steps, is_gif ? 103 : 1033);
  }
}

TEST(AnimationFile, FormatsAreToldByTheEndingOfTheName) {
  EXPECT_EQ(animation_format_of("a/b.apng"), AnimationFormat::apng);
  EXPECT_EQ(animation_format_of("b.GIF"), AnimationFormat::gif);
  EXPECT_FALSE(animation_format_of("b_%04d.png"));
}

}  // namespace
}  // namespace isoshade::scene
