// SPDX-License-Identifier: Apache-2.0
// PNG: what its pixels are, and that no damaged file gives any.
#include <array>
#include <cstdlib>
#include <zlib.h>

#include "tests/unit/decoded_image.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

const std::string palette = png_chunk("PLTE", "\xff\x33\x66\x33\xff\x99");

float whole(int value) { return static_cast<float>(value) / 65535.0f; }

TEST(Png, GreyBecomesThreeEqualChannels) {
  EXPECT_EQ(rgba_of(png_file(2, 1, 8, 0, {std::string("\x00\x33", 2)}), true),
            (Floats{0, 0, 0, 1, 0.2f, 0.2f, 0.2f, 1}));
  EXPECT_EQ(rgba_of(png_file(1, 1, 8, 4, {"\x33\x66"}), true), (Floats{0.2f, 0.2f, 0.2f, 0.4f}));
  EXPECT_EQ(rgba_of(png_file(2, 1, 1, 0, {"\x40"}), true), (Floats{0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(rgba_of(png_file(2, 1, 2, 0, {"\x60"}), true)[0], 1 / 3.0f);
  EXPECT_EQ(rgba_of(png_file(2, 1, 4, 0, {"\x3c"}), true)[4], 0.8f);
  EXPECT_EQ(rgba_of(png_file(1, 1, 16, 0, {"\x12\x34"}), false),
            (Floats{whole(0x1234), whole(0x1234), whole(0x1234), 1}));
  EXPECT_EQ(rgba_of(png_file(1, 1, 16, 4, {"\x12\x34\x56\x78"}), false)[3], whole(0x5678));
}

TEST(Png, ExpandsPalettes) {
  EXPECT_EQ(rgba_of(png_file(2, 1, 8, 3, {std::string("\x01\x00", 2)}, palette), true),
            (Floats{0.2f, 1, 0.6f, 1, 1, 0.2f, 0.4f, 1}));
  EXPECT_EQ(
      rgba_of(png_file(2, 1, 8, 3, {std::string("\x01\x00", 2)}, palette + png_chunk("tRNS", "\x33")), true),
      (Floats{0.2f, 1, 0.6f, 1, 1, 0.2f, 0.4f, 0.2f}));
  for (const int bits : {1, 2, 4})
    EXPECT_EQ(
        rgba_of(png_file(1, 1, bits, 3, {std::string(1, static_cast<char>(1 << (8 - bits)))}, palette), true),
        (Floats{0.2f, 1, 0.6f, 1}))
        << bits;
}

TEST(Png, KeepsSixteenBits) {
  EXPECT_EQ(rgba_of(png_file(1, 1, 16, 6, {std::string("\x00\x01\x80\x00\xff\xff\x12\x34", 8)}), false),
            (Floats{whole(1), whole(0x8000), 1, whole(0x1234)}));
}

TEST(Png, TransparentColourHasAlphaZero) {
  const auto alphas = [](const std::string& bytes, bool has_bytes) {
    Floats found;
    const Floats rgba = rgba_of(bytes, has_bytes);
    for (size_t i = 3; i < rgba.size(); i += 4) found.push_back(rgba[i]);
    return found;
  };
  const auto transparent = [](const std::string& color) { return png_chunk("tRNS", color); };
  EXPECT_EQ(alphas(png_file(2, 1, 8, 0, {"\x07\x08"}, transparent(std::string("\0\x07", 2))), true),
            (Floats{0, 1}));
  EXPECT_EQ(alphas(png_file(2, 1, 4, 0, {"\x78"}, transparent(std::string("\0\x07", 2))), true),
            (Floats{0, 1}));
  EXPECT_EQ(alphas(png_file(2, 1, 1, 0, {"\x40"}, transparent(std::string("\0\x01", 2))), true),
            (Floats{1, 0}));
  EXPECT_EQ(alphas(png_file(2, 1, 16, 0, {"\x01\x07\x01\x08"}, transparent("\x01\x07")), false),
            (Floats{0, 1}));
  EXPECT_EQ(alphas(png_file(2, 1, 8, 2, {"\1\2\3\1\2\4"}, transparent(std::string("\0\1\0\2\0\3", 6))), true),
            (Floats{0, 1}));
  EXPECT_EQ(alphas(png_file(2, 1, 16, 2, {"\1\1\2\2\3\3\1\1\2\2\3\4"}, transparent("\1\1\2\2\3\3")), false),
            (Floats{0, 1}));
}

/// The bits of a row from `first` on, `count` of them; at most 64.
uint64_t bits_of(const std::string& row, size_t first, size_t count) {
  uint64_t value = 0;
  for (size_t i = first; i < first + count; ++i)
    value = value << 1 | (static_cast<uint8_t>(row[i / 8]) >> (7 - i % 8) & 1u);
  return value;
}

/// The rows of the seven images of an interlaced one. PNG, second edition, 8.2.
std::vector<std::string> interlaced(size_t width, size_t height, size_t bits,
                                    const std::vector<std::string>& rows) {
  constexpr size_t x0[] = {0, 4, 0, 2, 0, 1, 0}, y0[] = {0, 0, 4, 0, 2, 0, 1};
  constexpr size_t dx[] = {8, 8, 4, 4, 2, 2, 1}, dy[] = {8, 8, 8, 4, 4, 2, 2};
  std::vector<std::string> all;
  for (size_t pass = 0; pass < 7; ++pass) {
    for (size_t y = y0[pass]; y < height && x0[pass] < width; y += dy[pass]) {
      std::string row;
      size_t used = 0;
      for (size_t x = x0[pass]; x < width; x += dx[pass]) {
        const uint64_t pixel = bits_of(rows[y], x * bits, bits);
        for (size_t bit = bits; bit-- > 0; ++used) {
          if (used % 8 == 0) row += '\0';
          row.back() = static_cast<char>(row.back() | static_cast<int>(pixel >> bit & 1) << (7 - used % 8));
        }
      }
      all.push_back(row);
    }
  }
  return all;
}

TEST(Png, InterlacingKeepsThePixels) {
  struct Kind {
    int type, bits, channels;
  };
  std::string colors;
  for (int i = 0; i < 256 * 3; ++i) colors += static_cast<char>(i * 37);
  constexpr Kind kinds[] = {{0, 1, 1}, {0, 2, 1},  {0, 4, 1},  {0, 8, 1}, {0, 16, 1},
                            {2, 8, 3}, {2, 16, 3}, {3, 1, 1},  {3, 2, 1}, {3, 4, 1},
                            {3, 8, 1}, {4, 8, 2},  {4, 16, 2}, {6, 8, 4}, {6, 16, 4}};
  for (const auto& [type, bits, channels] : kinds) {
    for (const auto& [width, height] : {std::pair(1, 1), {2, 2}, {3, 5}, {5, 1}, {8, 8}, {9, 17}}) {
      const size_t pixel = static_cast<size_t>(bits * channels);
      std::vector<std::string> rows;
      for (int y = 0; y < height; ++y) {
        std::string row;
        for (size_t i = 0; i < (static_cast<size_t>(width) * pixel + 7) / 8; ++i)
          row += static_cast<char>(91 * i + 57 * static_cast<size_t>(y) + 13);
        rows.push_back(row);
      }
      const std::string plte =
          type == 3 ? png_chunk("PLTE", colors.substr(0, size_t{3} << bits)) : std::string();
      const auto w = static_cast<uint32_t>(width), h = static_cast<uint32_t>(height);
      const std::string plain = png_file(w, h, bits, type, rows, plte);
      const std::string woven = png_file(w, h, bits, type, interlaced(w, h, pixel, rows), plte, true);
      EXPECT_EQ(rgba_of(plain, bits <= 8), rgba_of(woven, bits <= 8))
          << type << " " << bits << " " << width << " x " << height;
    }
  }
}

TEST(Png, KeepsEveryByte) {
  std::vector<uint8_t> rgba;
  for (int i = 0; i < 4 * 60 * 70; ++i) rgba.push_back(static_cast<uint8_t>(i * i / 7));
  const auto read = scene::decode_image(scene::png(60, 70, rgba)).found;
  ASSERT_TRUE(read && read->bytes.size() == rgba.size() / 4);
  for (size_t i = 0; i < rgba.size(); ++i) ASSERT_EQ(read->bytes[i / 4] >> (8 * (i % 4)) & 255, rgba[i]) << i;
}

std::vector<uint8_t> noisy_picture(int width, int height, bool has_alpha) {
  std::vector<uint8_t> rgba;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : {x * x / 9, (x ^ y) * 3, x * y / 31 % 7, has_alpha ? x + y : 255})
        rgba.push_back(static_cast<uint8_t>(value));
  return rgba;
}

uint32_t number(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

/// A reader of its own: the chunks with zlib's checksum, their data through zlib, and the filters as the standard has them
/// (PNG, second edition, 9.2).
std::vector<uint8_t> read_by_the_standard(const std::string& file) {
  const auto bytes_of = [&](size_t at) { return reinterpret_cast<const Bytef*>(file.data() + at); };
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::string packed, header, last;
  size_t at = 8;
  for (size_t length = 0; at < file.size(); at += 12 + length) {
    length = number(file, at);
    const std::string type = last = file.substr(at + 4, 4), data = file.substr(at + 8, length);
    EXPECT_EQ(number(file, at + 8 + length), crc32(0, bytes_of(at + 4), static_cast<uInt>(length + 4)));
    if (type == "IHDR") header = data;
    if (type == "IDAT") packed += data;
  }
  EXPECT_EQ(at, file.size());
  EXPECT_EQ(last, "IEND");
  const size_t width = number(header, 0), height = number(header, 4), channels = header[9] == 2 ? 3 : 4;
  EXPECT_TRUE(header[8] == 8 && (header[9] == 2 || header[9] == 6));
  const size_t row = width * channels;
  std::vector<uint8_t> raw((row + 1) * height), above(row), rgba;
  auto size = static_cast<uLongf>(raw.size());
  EXPECT_EQ(uncompress(raw.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size())), Z_OK);
  EXPECT_EQ(size, raw.size());
  for (size_t y = 0; y < height; ++y) {
    uint8_t* const line = &raw[y * (row + 1)] + 1;
    for (size_t i = 0; i < row; ++i) {
      const int a = i < channels ? 0 : line[i - channels], b = above[i], c = i < channels ? 0 : above[i - channels];
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int predicted[] = {0, a, b, (a + b) / 2, pa <= pb && pa <= pc ? a : pb <= pc ? b : c};
      line[i] = static_cast<uint8_t>(line[i] + predicted[raw[y * (row + 1)]]);
    }
    above.assign(line, line + row);
    for (size_t i = 0; i < row; ++i) {
      rgba.push_back(line[i]);
      if (channels == 3 && i % 3 == 2) rgba.push_back(255);
    }
  }
  return rgba;
}

TEST(Png, TwoReadersReadWhatIsWritten) {
  for (const auto& [width, height] : {std::pair(1, 1), {1, 300}, {300, 1}, {333, 257}, {700, 200}}) {
    for (const bool has_alpha : {false, true}) {
      const std::vector<uint8_t> rgba = noisy_picture(width, height, has_alpha);
      const std::string file = scene::png(width, height, rgba);
      EXPECT_EQ(read_by_the_standard(file), rgba) << width << " x " << height;
      const auto read = scene::decode_image(file);
      ASSERT_TRUE(read.found) << read.reason;
      for (size_t i = 0; i < rgba.size(); ++i) ASSERT_EQ(read.found->bytes[i / 4] >> (8 * (i % 4)) & 255, rgba[i]) << i;
    }
  }
}

TEST(Png, FilesDoNotDependOnTheNumberOfThreads) {
  const std::vector<uint8_t> rgba = noisy_picture(700, 400, true);
  const std::string file = scene::png(700, 400, rgba, 1);
  size_t bands = 0;
  for (size_t at = file.find("IDAT"); at != std::string::npos; at = file.find("IDAT", at + 4)) ++bands;
  EXPECT_GT(bands, 3u);
  for (const int threads : {2, 3, 16, 0}) EXPECT_TRUE(scene::png(700, 400, rgba, threads) == file) << threads;
}

TEST(Png, OpaquePicturesHaveNoAlpha) {
  const size_t color_type = 25;
  EXPECT_EQ(scene::png(1, 1, std::vector<uint8_t>{1, 2, 3, 255})[color_type], 2);
  EXPECT_EQ(scene::png(1, 1, std::vector<uint8_t>{1, 2, 3, 254})[color_type], 6);
}

TEST(Png, IgnoresColourProfiles) {
  const std::string gamma = png_chunk("gAMA", big_endian(100000)),
                    srgb = png_chunk("sRGB", std::string(1, '\0'));
  const std::string profile = png_chunk("iCCP", std::string("p\0\0", 3) + stored("no profile"));
  const Floats plain = rgba_of(png_file(1, 1, 8, 2, {"\x33\x66\x99"}), true);
  for (const std::string& chunk : {gamma, srgb, profile})
    EXPECT_EQ(rgba_of(png_file(1, 1, 8, 2, {"\x33\x66\x99"}, chunk), true), plain);
}

TEST(Png, RejectsColoursBeyondThePalette) {
  const std::string three = png_chunk("PLTE", "abcdefghi");
  EXPECT_EQ(reason_of(png_file(4, 1, 8, 3, {std::string("\0\1\2\3", 4)}, three)),
            "a pixel has the colour 3 of a palette of 3");
  EXPECT_EQ(reason_of(png_file(4, 1, 8, 3, {"\1\1\1\xff"}, three)),
            "a pixel has the colour 255 of a palette of 3");
  EXPECT_EQ(reason_of(png_file(4, 1, 2, 3, {"\x1b"}, three)), "a pixel has the colour 3 of a palette of 3");
  EXPECT_EQ(reason_of(png_file(2, 1, 4, 3, {"\x1b"}, three)), "a pixel has the colour 11 of a palette of 3");
  EXPECT_EQ(reason_of(png_file(1, 1, 1, 3, {"\x80"}, png_chunk("PLTE", "abc"))),
            "a pixel has the colour 1 of a palette of 1");
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 3, {"\5"}, three, true)),
            "a pixel has the colour 5 of a palette of 3");
  // The bits behind the last pixel are nobody's.
  EXPECT_EQ(reason_of(png_file(3, 1, 2, 3, {"\x1b"}, three)), "");
  EXPECT_NE(reason_of(png_file(1, 1, 8, 3, {std::string(1, '\0')})), "");
}

TEST(Png, RejectsDamagedTransparency) {
  const std::vector<std::string> row = {std::string(1, '\0')};
  const std::string damaged = "its tRNS chunk is damaged";
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 3, row, palette + png_chunk("tRNS", "abc"))), damaged);
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 3, row, png_chunk("tRNS", "a") + palette)), damaged);
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 0, row, png_chunk("tRNS", "a"))), damaged);
  std::string chunk = png_chunk("tRNS", "a");
  chunk.back() ^= 1;
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 3, row, palette + chunk)), damaged);
  // Beside a channel for alpha it means nothing.
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 4, {"ab"}, png_chunk("tRNS", "ab"))), "");
}

TEST(Png, RejectsTruncatedFiles) {
  std::vector<uint8_t> rgba;
  for (int i = 0; i < 4 * 20 * 20; ++i) rgba.push_back(static_cast<uint8_t>(i * i));
  const std::string files[] = {scene::png(20, 20, rgba),
                               png_file(2, 2, 16, 6, {std::string(16, 'a'), std::string(16, 'b')}),
                               png_file(2, 1, 8, 3, {std::string(2, '\1')}, palette)};
  for (const std::string& bytes : files) {
    ASSERT_EQ(reason_of(bytes), "");
    for (size_t length = 0; length < bytes.size(); ++length)
      ASSERT_NE(reason_of(bytes.substr(0, length)), "") << length << " of " << bytes.size();
  }
}

TEST(Png, DetectsEveryChangedByte) {
  std::vector<uint8_t> rgba(4 * 9 * 9, 77);
  const std::string bytes = scene::png(9, 9, rgba);
  ASSERT_EQ(reason_of(bytes), "");
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] ^= 16;
    EXPECT_NE(reason_of(changed), "") << i;
  }
}

TEST(Png, ChecksSizesBeforeDecoding) {
  for (const uint32_t side : {8193u, 0x7fffffffu, 0xffffffffu, 0u}) {
    const std::string reason = "a side is not from 1 to 8192 pixels";
    EXPECT_EQ(reason_of(png_file(side, 1, 8, 0, {std::string(1, '\0')})), reason) << side;
    EXPECT_EQ(reason_of(png_file(1, side, 8, 0, {std::string(1, '\0')})), reason) << side;
  }
  EXPECT_EQ(reason_of(png_file(1, 1, 3, 0, {""})).rfind("its header is damaged", 0), 0u);
}

TEST(Png, RejectsTooLittleDataBeforeAllocating) {
  EXPECT_EQ(reason_of(png_file(8192, 8192, 16, 6, {std::string(1, '\0')})),
            "its 13 bytes of data are too few for its size");
}

TEST(Png, IgnoresDataBeyondTheRows) {
  EXPECT_EQ(rgba_of(png_file(1, 1, 8, 0, {"\x33" + std::string(60'000, 'a')}), true)[0], 0.2f);
}

TEST(Png, LimitsTheSizeOfTextChunks) {
  const std::string text = png_chunk("tEXt", std::string("a\0", 2) + std::string(1 << 20, 'b'));
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 0, {"a"}, text)), "");
  EXPECT_EQ(reason_of(png_file(1, 1, 8, 0, {"a"},
                               png_chunk("tEXt", std::string("a\0", 2) + std::string(65 << 20, 'b')))),
            "its texts and profiles take more than 64 MiB");
}

}  // namespace
}  // namespace isoshade
