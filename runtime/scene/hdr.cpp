// SPDX-License-Identifier: Apache-2.0
// Radiance HDR: three mantissa bytes and an exponent per pixel.
// Source: Ward, "Real Pixels", Graphics Gems II, 1991; "Radiance File Formats", section picture, and Radiance's color.c.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/chromaticities.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene {
namespace {

using Pixel = std::array<uint8_t, 4>;

/// The order of scanlines: "-Y 2 +X 3" means rows from the top, pixels from the left.
struct Orientation {
  bool columns = false;  ///< scanlines are columns
  bool right_to_left = false;
  bool bottom_up = false;
};

struct Header {
  ImageHeader size;
  Orientation orientation;
  /// The divisor of the colours: EXPOSURE states the factor that they were multiplied by, COLORCORR one per channel.
  std::array<float, 3> scale{1, 1, 1};
  std::optional<Chromaticities> primaries;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  /// Without the line ending, which may be CR LF.
  std::string_view line() {
    const size_t end = rest_.find('\n');
    std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (found.ends_with('\r')) found.remove_suffix(1);
    return found;
  }
  bool has(size_t count) const { return rest_.size() >= count; }
  uint8_t byte() {
    const auto value = static_cast<uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return value;
  }
  /// Whether a run-length scanline, compressed by channel, of this length begins here.
  bool packed(size_t length) const {
    const auto at = [&](size_t i) { return size_t{static_cast<uint8_t>(rest_[i])}; };
    return length >= 8 && length < 32768 && has(4) && at(0) == 2 && at(1) == 2 && at(2) == length >> 8 &&
           at(3) == (length & 255);
  }

 private:
  std::string_view rest_;
};

/// The next word of a line, between blanks.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

/// "-Y 2 +X 3", or any of the other seven orders of two axes.
bool read_size(std::string_view line, Header& header) {
  bool seen_x = false, seen_y = false;
  for (const bool first : {true, false}) {
    const std::string_view axis = take_word(line), number = take_word(line);
    if (axis.size() != 2 || (axis[0] != '+' && axis[0] != '-') || (axis[1] != 'X' && axis[1] != 'Y'))
      return false;
    const bool x = axis[1] == 'X';
    (x ? seen_x : seen_y) = true;
    if (first) header.orientation.columns = x;
    (x ? header.orientation.right_to_left : header.orientation.bottom_up) = axis[0] == (x ? '-' : '+');
    int& side = x ? header.size.width : header.size.height;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), side);
    if (error != std::errc() || end != number.data() + number.size()) return false;
  }
  return seen_x && seen_y && take_word(line).empty();
}

/// Exactly as many numbers as the span has.
template <size_t N>
bool read_numbers(std::string_view text, std::array<float, N>& numbers) {
  for (float& number : numbers) {
    const auto found = support::parse_float(take_word(text));
    if (!found || !std::isfinite(*found)) return false;
    number = *found;
  }
  return take_word(text).empty();
}

/// Reads a line of the header. Returns why it is refused; empty if it is not.
std::string read_variable(std::string_view line, Header& header, bool& known) {
  const size_t equals = line.find('=');
  if (equals == std::string_view::npos || line.starts_with('#')) return {};
  std::string_view name = line.substr(0, equals), value = line.substr(equals + 1);
  name = take_word(name);
  if (name == "FORMAT") {
    const std::string_view format = take_word(value);
    if (format == "32-bit_rle_xyze")
      return "it holds XYZ colours (32-bit_rle_xyze); write it with RGB colours";
    known = format == "32-bit_rle_rgbe";
  } else if (name == "EXPOSURE" || name == "COLORCORR") {
    std::array<float, 3> factors{};
    std::array<float, 1> one{};
    if (name == "EXPOSURE" && read_numbers(value, one)) factors.fill(one[0]);
    if (name == "COLORCORR" && !read_numbers(value, factors)) factors = {};
    for (size_t c = 0; c < 3; ++c) {
      header.scale[c] = header.scale[c] * factors[c];
      if (!(header.scale[c] > 0 && std::isnormal(header.scale[c])))
        return "its " + std::string(name) + " is not a positive number";
    }
  } else if (name == "PRIMARIES") {
    std::array<float, 8> p{};
    if (!read_numbers(value, p)) return "its PRIMARIES are not eight numbers";
    // Some writers put zeros for unknown values.
    if (p == std::array<float, 8>{}) return {};
    header.primaries = {{p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]}};
    if (!to_rec709(*header.primaries).valid) return "its PRIMARIES are degenerate";
  }
  return {};
}

/// Each channel in runs: a count above 128 repeats one value, otherwise literal values follow.
bool unpack(Reader& reader, std::vector<Pixel>& line) {
  for (size_t channel = 0; channel < 4; ++channel) {
    for (size_t x = 0; x < line.size();) {
      if (!reader.has(1)) return false;
      const uint8_t code = reader.byte();
      const bool run = code > 128;
      const size_t count = run ? code - 128u : code;
      if (count == 0 || count > line.size() - x || !reader.has(run ? 1 : count)) return false;
      const uint8_t value = run ? reader.byte() : 0;
      for (size_t i = 0; i < count; ++i) line[x++][channel] = run ? value : reader.byte();
    }
  }
  return true;
}

/// The old format: a pixel 1 1 1 n repeats the pixel before it n times; a second one that follows directly n * 256
/// times, and so on.
bool unpack_pixels(Reader& reader, std::vector<Pixel>& line) {
  int shift = 0;
  for (size_t x = 0; x < line.size();) {
    if (!reader.has(4)) return false;
    Pixel pixel;
    for (uint8_t& value : pixel) value = reader.byte();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      line[x++] = pixel;
      shift = 0;
      continue;
    }
    if (x == 0 || shift > 24) return false;
    const size_t count = size_t{pixel[3]} << shift;
    if (count > line.size() - x) return false;
    for (size_t i = 0; i < count; ++i, ++x) line[x] = line[x - 1];
    shift += 8;
  }
  return true;
}

bool read_scanline(Reader& reader, std::vector<Pixel>& line) {
  if (!reader.packed(line.size())) return unpack_pixels(reader, line);
  for (int i = 0; i < 4; ++i) reader.byte();
  return unpack(reader, line);
}

/// Reads up to the first scanline.
Read<Header> read_to_scanlines(Reader& reader) {
  const lanes::FpGuard guard;
  Header header;
  bool known = false;
  while (true) {
    if (!reader.has(1)) return {{}, "the header has no end"};
    const std::string_view line = reader.line();
    if (line.empty()) break;
    if (std::string reason = read_variable(line, header, known); !reason.empty())
      return {{}, std::move(reason)};
  }
  if (!known) return {{}, "it is not of the format 32-bit_rle_rgbe"};
  if (!read_size(reader.line(), header)) return {{}, "its size is not stated as -Y rows +X columns"};
  if (std::string reason = refuse_size(header.size.width, header.size.height); !reason.empty())
    return {{}, std::move(reason)};
  return {header, {}};
}

}  // namespace

bool is_hdr(std::string_view bytes) { return bytes.starts_with("#?"); }

Read<ImageHeader> read_hdr_header(std::string_view bytes) {
  Reader reader(bytes);
  Read<Header> header = read_to_scanlines(reader);
  if (!header.found) return {{}, std::move(header.reason)};
  return {header.found->size, {}};
}

Read<FileImage> decode_hdr(std::string_view bytes) {
  Reader reader(bytes);
  const Read<Header> read = read_to_scanlines(reader);
  if (!read.found) return {{}, read.reason};
  const Header& header = *read.found;
  const Orientation& orientation = header.orientation;
  FileImage image;
  image.width = header.size.width;
  image.height = header.size.height;
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  const size_t lines = orientation.columns ? width : height, length = orientation.columns ? height : width;
  const std::string truncated = "the file is damaged or truncated";
  if (!reader.has(4 * lines))
    return {{}, truncated};  // before memory is allocated: every scanline has at least 4 bytes
  image.rgba.resize(4 * width * height);
  std::vector<Pixel> line(length);
  const lanes::FpGuard guard;
  for (size_t i = 0; i < lines; ++i) {
    if (!read_scanline(reader, line)) return {{}, truncated};
    for (size_t j = 0; j < length; ++j) {
      size_t x = orientation.columns ? i : j, y = orientation.columns ? j : i;
      if (orientation.right_to_left) x = width - 1 - x;
      if (orientation.bottom_up) y = height - 1 - y;
      float* to = &image.rgba[4 * (y * width + x)];
      const Pixel& pixel = line[j];
      for (size_t c = 0; c < 3; ++c) {
        // A product with a power of two is exact.
        const float value = pixel[3] == 0 ? 0.0f : std::ldexp(static_cast<float>(pixel[c]), pixel[3] - 136);
        to[c] = value / header.scale[c];
      }
      to[3] = 1;
    }
  }
  make_finite(image);
  if (header.primaries)
    if (const auto matrix = to_rec709(*header.primaries).matrix) transform(*matrix, image.rgba);
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
