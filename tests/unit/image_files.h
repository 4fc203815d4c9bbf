// SPDX-License-Identifier: Apache-2.0
// Image files that the tests make.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <jpeglib.h>
#include <string>
#include <vector>

namespace isoshade::testing {

inline std::string big_endian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
  return bytes;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
  uint32_t crc = ~0u;
  for (const char c : type + data) {
    crc ^= static_cast<uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320u : 0);
  }
  return big_endian(static_cast<uint32_t>(data.size())) + type + data + big_endian(~crc);
}

/// Bytes (fewer than 65536) as zlib has them when it does not compress.
inline std::string stored(const std::string& bytes) {
  uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<uint8_t>(c)) % 65521;
    b = (b + a) % 65521;
  }
  const size_t n = bytes.size();
  const auto low_high = [](size_t v) {
    return std::string{static_cast<char>(v & 255), static_cast<char>(v >> 8 & 255)};
  };
  return std::string("\x78\x01\x01", 3) + low_high(n) + low_high(~n) + bytes + big_endian(b << 16 | a);
}

/// A PNG; `rows` are those of the image, each of the bytes that its bits fill; those of the seven smaller images if it is
/// interlaced. Colour types: 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA. `chunks` stand before the data.
inline std::string png_file(uint32_t width, uint32_t height, int bits, int color_type,
                            const std::vector<std::string>& rows, const std::string& chunks = "",
                            bool interlaced = false) {
  std::string data;
  for (const std::string& row : rows) data += '\0' + row;
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bits) +
                             static_cast<char>(color_type) + std::string(2, '\0') +
                             static_cast<char>(interlaced ? 1 : 0);
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + chunks + png_chunk("IDAT", stored(data)) +
         png_chunk("IEND", "");
}

/// How a JPEG is written.
struct JpegOptions {
  int quality = 95;
  int across = 2, down = 2;  ///< pixels for one of the two chroma channels
  bool progressive = false;
  int restart = 0;  ///< blocks between restart markers
  bool arithmetic = false;
  J_COLOR_SPACE colors = JCS_RGB;
};

/// `pixels` has as many bytes a pixel as the colour space has channels.
inline std::string jpeg_file(int width, int height, const std::vector<uint8_t>& pixels,
                             const JpegOptions& options = {}) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &memory, &size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.in_color_space = options.colors;
  info.input_components = options.colors == JCS_GRAYSCALE ? 1 : options.colors == JCS_CMYK ? 4 : 3;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, options.quality, TRUE);
  info.comp_info[0].h_samp_factor = options.across;
  info.comp_info[0].v_samp_factor = options.down;
  info.restart_interval = static_cast<unsigned>(options.restart);
  info.arith_code = options.arithmetic ? TRUE : FALSE;
  if (options.progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  const size_t row_bytes = pixels.size() / static_cast<size_t>(height);
  while (info.next_scanline < info.image_height) {
    auto* row = const_cast<JSAMPLE*>(&pixels[info.next_scanline * row_bytes]);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::string bytes(reinterpret_cast<const char*>(memory), size);
  std::free(memory);
  return bytes;
}

/// A Radiance HDR; its rows are packed where they may be, without runs of one value.
inline std::string hdr_file(int width, int height, const std::vector<float>& rgb) {
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
                      std::to_string(width) + "\n";
  const auto columns = static_cast<size_t>(width);
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    std::array<std::string, 4> channels;
    for (size_t x = 0; x < columns; ++x) {
      const float* pixel = &rgb[3 * (y * columns + x)];
      int exponent = 0;
      const float most = std::max({pixel[0], pixel[1], pixel[2]});
      std::frexp(most, &exponent);
      for (size_t c = 0; c < 3; ++c)
        channels[c] += static_cast<char>(static_cast<uint8_t>(std::ldexp(pixel[c], 8 - exponent)));
      channels[3] += static_cast<char>(most > 0 ? exponent + 128 : 0);
    }
    const bool packed = width >= 8 && width < 32768;
    if (packed)
      bytes += std::string("\2\2", 2) + static_cast<char>(width >> 8) + static_cast<char>(width & 255);
    for (size_t x = 0; x < columns && !packed; ++x)
      for (const std::string& channel : channels) bytes += channel[x];
    for (const std::string& channel : channels) {
      for (size_t x = 0; x < columns && packed; x += 128) {
        const std::string part = channel.substr(x, 128);
        bytes += static_cast<char>(part.size()) + part;
      }
    }
  }
  return bytes;
}

}  // namespace isoshade::testing
