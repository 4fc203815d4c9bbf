// SPDX-License-Identifier: Apache-2.0
// JPEG whose segments and data are damaged, each by itself.
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

/// A marker with its segment, or what stands between two, which begins with no marker.
struct Part {
  int marker = 0;    ///< 0: data
  std::string data;  ///< of a segment without its length
};

bool has_segment(int marker) { return marker > 0x01 && (marker < 0xd0 || marker > 0xd9); }

std::vector<Part> parts_of(const std::string& bytes) {
  std::vector<Part> parts;
  for (size_t at = 0; at < bytes.size();) {
    const auto byte = [&](size_t i) {
      return at + i < bytes.size() ? static_cast<uint8_t>(bytes[at + i]) : 0;
    };
    if (byte(0) == 0xff && byte(1) != 0 && byte(1) != 0xff) {
      Part part{byte(1), ""};
      size_t length = 0;
      if (has_segment(part.marker)) {
        length = std::max(2, byte(2) << 8 | byte(3));
        part.data = bytes.substr(std::min(bytes.size(), at + 4), length - 2);
      }
      parts.push_back(std::move(part));
      at += 2 + length;
    } else {
      if (parts.empty() || parts.back().marker != 0) parts.push_back({});
      parts.back().data += bytes[at++];
    }
  }
  return parts;
}

std::string file_of(const std::vector<Part>& parts) {
  std::string bytes;
  for (const auto& [marker, data] : parts) {
    if (marker != 0) bytes += {'\xff', static_cast<char>(marker)};
    const size_t length = data.size() + 2;
    if (has_segment(marker)) bytes += {static_cast<char>(length >> 8 & 255), static_cast<char>(length & 255)};
    bytes += data;
  }
  return bytes;
}

std::vector<std::string> good() {
  std::vector<uint8_t> rgb, gray;
  for (int i = 0; i < 19 * 11; ++i) {
    rgb.insert(rgb.end(), {static_cast<uint8_t>(i * 7), static_cast<uint8_t>(i * 7 ^ 85), 9});
    gray.push_back(static_cast<uint8_t>(i * 11));
  }
  return {jpeg_file(19, 11, rgb),
          jpeg_file(19, 11, rgb, {.quality = 50, .progressive = true}),
          jpeg_file(19, 11, rgb, {.quality = 50, .across = 1, .down = 1, .restart = 2}),
          jpeg_file(19, 11, rgb, {.quality = 30, .across = 2, .down = 1}),
          jpeg_file(19, 11, gray, {.across = 1, .down = 1, .progressive = true, .colors = JCS_GRAYSCALE}),
          jpeg_file(19, 11, gray, {.across = 1, .down = 1, .colors = JCS_GRAYSCALE})};
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  std::vector<Part> parts = parts_of(bytes);
  if (parts.size() < 3 || random.one_in(8)) {
    damage_file(bytes, random);
    return bytes;
  }
  for (size_t n = 1 + random.below(3); n > 0 && parts.size() > 1; --n) {
    Part& part = parts[1 + random.below(parts.size() - 1)];
    switch (random.below(8)) {
      case 0:
      case 1: damage_order(parts, 1, random); break;
      case 2: {  // a part of another file
        const std::vector<Part> other = parts_of(random.any(files));
        if (!other.empty())
          parts.insert(parts.begin() + 1 + static_cast<ptrdiff_t>(random.below(parts.size())),
                       random.any(other));
        break;
      }
      case 3:
        part.marker = static_cast<int>(random.one_in(2) ? 0xc0 + random.below(16) : random.below(256));
        break;
      case 4:  // ends after any part
        parts.resize(1 + random.below(parts.size()));
        parts.push_back({0xd9, ""});
        break;
      default: damage_bytes(part.data, part.data.size(), random); break;
    }
  }
  bytes = file_of(parts);
  if (random.one_in(10)) bytes.resize(random.below(bytes.size()));
  return bytes;
}

}  // namespace

const Reader jpeg_reader = {"jpeg", good, damaged, nullptr, read_image};

}  // namespace isoshade
