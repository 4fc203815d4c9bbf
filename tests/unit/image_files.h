// SPDX-License-Identifier: Apache-2.0
// Image files that the tests make.
#pragma once

#include <cstdint>
#include <stb_image_write.h>
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

/// A PNG; `rows` are those of the image, each of the bytes that its bits fill. Colour types: 0 grey, 2 RGB, 3 palette, 4
/// grey and alpha, 6 RGBA. `chunks` stand before the data.
inline std::string png_file(uint32_t width, uint32_t height, int bits, int color_type,
                            const std::vector<std::string>& rows, const std::string& chunks = "") {
  std::string data;
  for (const std::string& row : rows) data += '\0' + row;
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bits) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + chunks + png_chunk("IDAT", stored(data)) +
         png_chunk("IEND", "");
}

inline void append_bytes(void* to, void* data, int size) {
  static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(size));
}

inline std::string jpeg_file(int width, int height, const std::vector<uint8_t>& rgb, int quality = 95) {
  std::string bytes;
  stbi_write_jpg_to_func(append_bytes, &bytes, width, height, 3, rgb.data(), quality);
  return bytes;
}

inline std::string hdr_file(int width, int height, const std::vector<float>& rgb) {
  std::string bytes;
  stbi_write_hdr_to_func(append_bytes, &bytes, width, height, 3, rgb.data());
  return bytes;
}

}  // namespace isoshade::testing
