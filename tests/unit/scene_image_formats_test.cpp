// SPDX-License-Identifier: Apache-2.0
// Images of all kinds that are read, from bytes.
#include <gtest/gtest.h>

#include "tests/unit/decoded_image.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

TEST(ImageFormats, HdrKeepsNumbersAboveOne) {
  const Floats read = rgba_of(hdr_file(2, 1, {0.25f, 0.5f, 1, 100, 50, 0}), false);
  EXPECT_EQ(read, (Floats{0.25f, 0.5f, 1, 1, 100, 50, 0, 1}));
}

TEST(ImageFormats, ExrIsReadBitForBit) {
  const scene::FileImage image{2, 1, {}, {0.1f, -2, 1e20f, 0.5f, 1, 2, 3, 4}, {0, 0}};
  EXPECT_EQ(rgba_of(scene::exr(image.view()), false), image.rgba);
}

TEST(ImageFormats, SizesAreCheckedBeforeDecompression) {
  EXPECT_FALSE(scene::decode_image("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n").found);
}

TEST(ImageFormats, OtherFormatsAreRefused) {
  for (const char* bytes : {"", "BM", "GIF89a\1\0\1\0", "P3 1 1 255 1 2 3", "\x89PNG", "{}", "\xff\xd8\xff"})
    EXPECT_FALSE(scene::decode_image(bytes).found) << bytes;
}

}  // namespace
}  // namespace isoshade
