// SPDX-License-Identifier: Apache-2.0
// Images of all kinds that are read, from bytes.
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/scene/image_file.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;
using Floats = std::vector<float>;

Floats rgba_of(const std::string& bytes, bool has_bytes) {
  const auto header = scene::read_header(bytes);
  const auto decoded = scene::decode_image(bytes);
  if (!header.found || !decoded.found) {
    ADD_FAILURE() << decoded.reason;
    return {};
  }
  EXPECT_EQ(decoded.found->has_bytes(), has_bytes);
  EXPECT_EQ(header.found->bytes, has_bytes);
  EXPECT_EQ(header.found->width, decoded.found->width);
  EXPECT_EQ(header.found->height, decoded.found->height);
  return scene::numbers_of(*decoded.found);
}

TEST(ImageFormats, GreyIsThreeColoursAlike) {
  EXPECT_EQ(rgba_of(png_file(2, 1, 8, 0, {std::string("\x00\x33", 2)}), true),
            (Floats{0, 0, 0, 1, 0.2f, 0.2f, 0.2f, 1}));
  EXPECT_EQ(rgba_of(png_file(1, 1, 8, 4, {"\x33\x66"}), true), (Floats{0.2f, 0.2f, 0.2f, 0.4f}));
  EXPECT_EQ(rgba_of(png_file(2, 1, 1, 0, {"\x40"}), true), (Floats{0, 0, 0, 1, 1, 1, 1, 1}));
}

TEST(ImageFormats, PalettesBecomeColours) {
  const std::string palette = png_chunk("PLTE", "\xff\x33\x66\x33\xff\x99");
  EXPECT_EQ(rgba_of(png_file(2, 1, 8, 3, {std::string("\x01\x00", 2)}, palette), true),
            (Floats{0.2f, 1, 0.6f, 1, 1, 0.2f, 0.4f, 1}));
  const std::string alpha = png_chunk("tRNS", "\x33");
  EXPECT_EQ(rgba_of(png_file(1, 1, 8, 3, {std::string(1, '\0')}, palette + alpha), true),
            (Floats{1, 0.2f, 0.4f, 0.2f}));
}

TEST(ImageFormats, SixteenBitsAreKept) {
  const auto whole = [](int value) { return static_cast<float>(value) / 65535.0f; };
  EXPECT_EQ(rgba_of(png_file(1, 1, 16, 6, {std::string("\x00\x01\x80\x00\xff\xff\x12\x34", 8)}), false),
            (Floats{whole(1), whole(0x8000), 1, whole(0x1234)}));
}

TEST(ImageFormats, JpegIsNearlyWhatWasWritten) {
  std::vector<uint8_t> rgb;
  for (int y = 0; y < 13; ++y)
    for (int x = 0; x < 21; ++x) rgb.insert(rgb.end(), {uint8_t(10 * x), uint8_t(15 * y), 128});
  const Floats read = rgba_of(jpeg_file(21, 13, rgb), true);
  ASSERT_EQ(read.size(), size_t{4 * 21 * 13});
  for (size_t i = 0; i < rgb.size() / 3; ++i) {
    EXPECT_NEAR(read[4 * i], rgb[3 * i] / 255.0, 0.05);
    EXPECT_NEAR(read[4 * i + 1], rgb[3 * i + 1] / 255.0, 0.05);
    EXPECT_EQ(read[4 * i + 3], 1.0f);
  }
}

TEST(ImageFormats, HdrHasNumbersBeyondOne) {
  const Floats read = rgba_of(hdr_file(2, 1, {0.25f, 0.5f, 1, 100, 50, 0}), false);
  EXPECT_EQ(read, (Floats{0.25f, 0.5f, 1, 1, 100, 50, 0, 1}));
}

TEST(ImageFormats, ExrIsReadBitForBit) {
  const scene::FileImage image{2, 1, {}, {0.1f, -2, 1e20f, 0.5f, 1, 2, 3, 4}, {0, 0}};
  EXPECT_EQ(rgba_of(scene::exr(image.view()), false), image.rgba);
}

TEST(ImageFormats, SidesAreCheckedBeforeAnythingIsUnpacked) {
  for (const uint32_t side : {8193u, 0x7fffffffu, 0xffffffffu, 0u}) {
    const std::string reason = "a side is not from 1 to 8192 pixels";
    EXPECT_EQ(scene::decode_image(png_file(side, 1, 8, 0, {std::string(1, '\0')})).reason, reason) << side;
    EXPECT_EQ(scene::decode_image(png_file(1, side, 8, 0, {std::string(1, '\0')})).reason, reason) << side;
  }
  EXPECT_EQ(scene::decode_image(png_file(1, 1, 3, 0, {""})).reason, "its header is damaged");
  EXPECT_FALSE(scene::decode_image("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n").found);
}

TEST(ImageFormats, DataAreNotUnpackedBeyondTheRows) {
  EXPECT_NE(scene::decode_image(png_file(1, 1, 8, 0, {std::string(60'000, '\0')})).reason.find("unpack"),
            std::string::npos);
}

TEST(ImageFormats, WhatIsNoneOfThemIsRefused) {
  for (const char* bytes : {"", "BM", "GIF89a\1\0\1\0", "P6 1 1 255 abc", "\x89PNG", "{}", "\xff\xd8\xff"})
    EXPECT_FALSE(scene::decode_image(bytes).found) << bytes;
}

}  // namespace
}  // namespace isoshade
