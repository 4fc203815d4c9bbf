// SPDX-License-Identifier: Apache-2.0
// Radiance HDR: three bytes and an exponent a pixel. Not by stb, which never ends on some damaged files.
// Source: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's color.c for the runs.
#include <array>
#include <charconv>
#include <cmath>

#include "runtime/scene/image_codecs.h"

namespace isoshade::scene {
namespace {

using Pixel = std::array<uint8_t, 4>;

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  std::string_view line() {
    const size_t end = rest_.find('\n');
    const std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return found;
  }
  bool has(size_t count) const { return rest_.size() >= count; }
  uint8_t byte() {
    const auto value = static_cast<uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return value;
  }
  /// Whether a row of this width begins here that is packed by channel.
  bool packed(int width) const {
    const auto at = [&](size_t i) { return static_cast<uint8_t>(rest_[i]); };
    return width >= 8 && width < 32768 && has(4) && at(0) == 2 && at(1) == 2 && at(2) == width >> 8 &&
           at(3) == (width & 255);
  }

 private:
  std::string_view rest_;
};

/// "-Y 2 +X 3": rows from the top, pixels from the left. Other orders are rare.
bool read_size(std::string_view line, int& width, int& height) {
  const auto number = [&](std::string_view before, int& value) {
    if (!line.starts_with(before)) return false;
    line.remove_prefix(before.size());
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    line.remove_prefix(static_cast<size_t>(end - line.data()));
    return error == std::errc();
  };
  return number("-Y ", height) && number(" +X ", width) && line.empty();
}

/// Each channel in runs: above 128 of one value, else of values as they are.
bool unpack(Reader& reader, std::vector<Pixel>& row) {
  for (size_t channel = 0; channel < 4; ++channel) {
    for (size_t x = 0; x < row.size();) {
      if (!reader.has(1)) return false;
      const uint8_t code = reader.byte();
      const bool run = code > 128;
      const size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - x || !reader.has(run ? 1 : count)) return false;
      const uint8_t value = run ? reader.byte() : 0;
      for (size_t i = 0; i < count; ++i) row[x++][channel] = run ? value : reader.byte();
    }
  }
  return true;
}

bool read_row(Reader& reader, std::vector<Pixel>& row) {
  if (reader.packed(static_cast<int>(row.size()))) {
    for (int i = 0; i < 4; ++i) reader.byte();
    return unpack(reader, row);
  }
  if (!reader.has(4 * row.size())) return false;
  for (Pixel& pixel : row)
    for (uint8_t& value : pixel) value = reader.byte();
  return true;
}

/// Reads to where the rows begin.
Read<ImageHeader> read_to_rows(Reader& reader) {
  bool known = false;
  while (true) {
    if (!reader.has(1)) return {{}, "the header has no end"};
    const std::string_view line = reader.line();
    known = known || line == "FORMAT=32-bit_rle_rgbe";
    if (line.empty()) break;
  }
  ImageHeader header;
  if (!known) return {{}, "it is not of the format 32-bit_rle_rgbe"};
  if (!read_size(reader.line(), header.width, header.height))
    return {{}, "its size is not told as -Y rows +X columns"};
  if (std::string reason = refuse_size(header.width, header.height); !reason.empty())
    return {{}, std::move(reason)};
  return {header, {}};
}

}  // namespace

bool is_hdr(std::string_view bytes) {
  return bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n");
}

Read<ImageHeader> read_hdr_header(std::string_view bytes) {
  Reader reader(bytes);
  return read_to_rows(reader);
}

Read<FileImage> decode_hdr(std::string_view bytes) {
  Reader reader(bytes);
  Read<ImageHeader> header = read_to_rows(reader);
  if (!header.found) return {{}, std::move(header.reason)};
  FileImage image;
  image.width = header.found->width;
  image.height = header.found->height;
  std::vector<Pixel> row(static_cast<size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    if (!read_row(reader, row)) return {{}, "the file is damaged"};
    for (const Pixel& pixel : row) {
      for (size_t channel = 0; channel < 3; ++channel)
        image.rgba.push_back(pixel[3] == 0 ? 0.0f
                                           : std::ldexp(static_cast<float>(pixel[channel]), pixel[3] - 136));
      image.rgba.push_back(1.0f);
    }
  }
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
