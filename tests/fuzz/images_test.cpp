// SPDX-License-Identifier: Apache-2.0
// Damaged image files: each is read or refused, and what is read is whole and finite once it is a texture. With
// ISOSHADE_FULL set there are 5,000 of them.
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>

#include "runtime/scene/texture.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

std::vector<std::string> images() {
  std::vector<uint8_t> rgb, rgba;
  std::vector<float> floats;
  for (int i = 0; i < 19 * 11; ++i) {
    const auto byte = static_cast<uint8_t>(i * 7);
    rgb.insert(rgb.end(), {byte, uint8_t(byte ^ 85), 9});
    rgba.insert(rgba.end(), {byte, 3, 200, uint8_t(i)});
    floats.insert(floats.end(), {0.5f * static_cast<float>(i), 1, 3e5f});
  }
  scene::FileImage image{19, 11, {}, {}, std::vector<float>(19 * 11, 0.5f)};
  for (int i = 0; i < 19 * 11 * 4; ++i) image.rgba.push_back(static_cast<float>(i));
  const std::string palette = png_chunk("PLTE", "\xff\x33\x66\x33\xff\x99") + png_chunk("tRNS", "\x33");
  return {scene::png(19, 11, rgba),
          png_file(3, 2, 16, 2, {std::string(18, 'a'), std::string(18, 'b')}),
          png_file(4, 2, 8, 3, {std::string(4, '\1'), std::string(4, '\0')}, palette),
          png_file(9, 1, 2, 0, {"abc"}),
          jpeg_file(19, 11, rgb),
          hdr_file(19, 11, floats),
          scene::exr(image.view())};
}

TEST(DamagedImages, AreReadOrRefused) {
  const std::vector<std::string> good = images();
  for (const std::string& bytes : good)
    ASSERT_TRUE(scene::decode_image(bytes).found) << scene::decode_image(bytes).reason;
  std::mt19937 random(11);
  const auto below = [&](size_t end) { return random() % end; };
  const int count = std::getenv("ISOSHADE_FULL") != nullptr ? 5000 : 200;
  int read = 0;
  for (int i = 0; i < count; ++i) {
    std::string bytes = good[static_cast<size_t>(i) % good.size()];
    for (size_t n = 1 + below(4); n > 0 && !bytes.empty(); --n) {
      // Half of the damage is where sizes and formats stand.
      const size_t at = below(below(2) == 0 ? std::min<size_t>(bytes.size(), 400) : bytes.size());
      switch (below(5)) {
        case 0: bytes[at] ^= static_cast<char>(1u << below(8)); break;
        case 1: bytes[at] = static_cast<char>(below(2) == 0 ? 255 : below(256)); break;
        case 2: bytes.resize(at); break;
        case 3: bytes.insert(at, bytes.substr(below(bytes.size()), below(40))); break;
        default: bytes.erase(at, 1 + below(8)); break;
      }
    }
    const auto header = scene::read_header(bytes);
    ASSERT_NE(header.found.has_value(), !header.reason.empty()) << "file " << i;
    const auto decoded = scene::decode_image(bytes);
    ASSERT_NE(decoded.found.has_value(), !decoded.reason.empty()) << "file " << i;
    if (!decoded.found) continue;
    ++read;
    const scene::FileImage& image = *decoded.found;
    ASSERT_TRUE(header.found) << "file " << i;
    ASSERT_EQ(header.found->width, image.width) << "file " << i;
    ASSERT_EQ(header.found->height, image.height) << "file " << i;
    ASSERT_EQ(header.found->bytes, image.has_bytes()) << "file " << i;
    const size_t pixels = size_t{1} * image.width * image.height;
    ASSERT_EQ(4 * image.bytes.size() + image.rgba.size(), 4 * pixels) << "file " << i;
    if (pixels > 1'000'000) continue;
    const scene::TextureLevel level = scene::linear_level(image, i % 2 == 0);
    for (const float value : level.texels) ASSERT_TRUE(std::isnormal(value) || value == 0) << "file " << i;
    for (const float value : scene::half_size(level).texels) ASSERT_TRUE(std::isnormal(value) || value == 0);
  }
  EXPECT_GT(read, count / 20);  // else the damage is too great to get beyond the headers
  EXPECT_LT(read, count);
}

}  // namespace
}  // namespace isoshade
