// SPDX-License-Identifier: Apache-2.0
// PPM and PGM (bytes or 16-bit numbers) and PFM (floats): a few words of text, then pixels.
// Source: the manual pages ppm(5), pgm(5) and pfm(5) of Netpbm.
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "compiler/support/parse_number.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The words before the pixels. Comments from # to the end of a line are allowed in PPM and PGM.
class Words {
 public:
  Words(std::string_view bytes, bool has_comments) : rest_(bytes), has_comments_(has_comments) {}

  /// Empty at the end of the bytes.
  std::string_view next() {
    while (!rest_.empty() && (is_space(rest_.front()) || (has_comments_ && rest_.front() == '#'))) {
      const size_t count = rest_.front() == '#' ? std::min(rest_.find('\n'), rest_.size()) : 1;
      rest_.remove_prefix(count);
    }
    size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length]) && !(has_comments_ && rest_[length] == '#')) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }
  /// What is behind the single space after the last word.
  std::optional<std::string_view> pixels() const {
    if (rest_.empty() || !is_space(rest_.front())) return std::nullopt;
    return rest_.substr(1);
  }

 private:
  std::string_view rest_;
  bool has_comments_;
};

std::optional<int> whole_number(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

struct Header {
  int width = 0, height = 0;
  size_t channels = 0;
  int most = 0;                  ///< PPM and PGM: the number of white
  bool is_little_endian = false;  ///< PFM
  std::string_view pixels;
};

/// The size of a pixel's numbers.
size_t number_bytes(const Header& header) { return header.most == 0 ? 4 : header.most > 255 ? 2 : 1; }

Read<Header> read(std::string_view bytes, bool has_floats) {
  Words words(bytes, !has_floats);
  Header header;
  const std::string_view kind = words.next();
  header.channels = kind == "P6" || kind == "PF" ? 3 : 1;
  const auto width = whole_number(words.next()), height = whole_number(words.next());
  if (!width || !height) return {{}, "its header does not state its size"};
  if (std::string reason = refuse_size(*width, *height); !reason.empty()) return {{}, std::move(reason)};
  header.width = *width;
  header.height = *height;
  const std::string_view last = words.next();
  if (has_floats) {
    const auto scale = support::parse_float(last);
    if (!scale || !std::isfinite(*scale) || *scale == 0.0f) return {{}, "its scale is not a number other than 0"};
    header.is_little_endian = *scale < 0.0f;
  } else {
    header.most = whole_number(last).value_or(0);
    if (header.most < 1 || header.most > 65535) return {{}, "its largest number is not from 1 to 65535"};
  }
  const auto pixels = words.pixels();
  const size_t needed = static_cast<size_t>(header.width) * static_cast<size_t>(header.height) * header.channels *
                        number_bytes(header);
  if (!pixels || pixels->size() < needed) return {{}, "the file ends early"};
  header.pixels = *pixels;
  return {header, {}};
}

uint32_t number_at(std::string_view bytes, size_t at, size_t size, bool is_little_endian) {
  uint32_t value = 0;
  for (size_t i = 0; i < size; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + (is_little_endian ? size - 1 - i : i)]);
  return value;
}

Read<ImageHeader> image_header(const Read<Header>& read) {
  if (!read.found) return {{}, read.reason};
  const Header& header = *read.found;
  return {ImageHeader{header.width, header.height, header.most == 255, header.most != 0}, {}};
}

Read<FileImage> decode(const Read<Header>& read) {
  if (!read.found) return {{}, read.reason};
  const Header& header = *read.found;
  const bool has_floats = header.most == 0;
  FileImage image;
  image.width = header.width;
  image.height = header.height;
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  const size_t size = number_bytes(header);
  if (header.most == 255)
    image.bytes.reserve(width * height);
  else
    image.rgba.reserve(4 * width * height);
  const lanes::FpGuard guard;
  for (size_t y = 0; y < height; ++y) {
    const size_t row = has_floats ? height - 1 - y : y;  // PFM has the lowest row first
    for (size_t x = 0; x < width; ++x) {
      std::array<uint32_t, 3> numbers{};
      for (size_t c = 0; c < 3; ++c) {
        const size_t channel = header.channels == 1 ? 0 : c;
        numbers[c] = number_at(header.pixels, ((row * width + x) * header.channels + channel) * size, size,
                               header.is_little_endian);
        if (!has_floats && numbers[c] > static_cast<uint32_t>(header.most))
          return {{}, "a pixel has the number " + std::to_string(numbers[c]) + " of at most " + std::to_string(header.most)};
      }
      if (header.most == 255) {
        image.bytes.push_back(numbers[0] | numbers[1] << 8 | numbers[2] << 16 | 0xff000000u);
        continue;
      }
      for (const uint32_t number : numbers)
        image.rgba.push_back(has_floats ? std::bit_cast<float>(number)
                                        : static_cast<float>(number) / static_cast<float>(header.most));
      image.rgba.push_back(1.0f);
    }
  }
  make_finite(image);
  return {std::move(image), {}};
}

bool begins(std::string_view bytes, char kind) {
  return bytes.size() >= 3 && bytes[0] == 'P' && bytes[1] == kind && is_space(bytes[2]);
}

std::string head(std::string_view kind, int width, int height, std::string_view last) {
  return std::string(kind) + "\n" + std::to_string(width) + " " + std::to_string(height) + "\n" + std::string(last) + "\n";
}

}  // namespace

bool is_pnm(std::string_view bytes) { return begins(bytes, '5') || begins(bytes, '6'); }

Read<ImageHeader> read_pnm_header(std::string_view bytes) { return image_header(read(bytes, false)); }

Read<FileImage> decode_pnm(std::string_view bytes) { return decode(read(bytes, false)); }

std::string ppm(const ByteView& image) {
  std::string file = head("P6", image.width, image.height, "255");
  file.reserve(file.size() + image.rgba.size() / 4 * 3);
  for (size_t i = 0; i < image.rgba.size(); i += 4)
    file.append(reinterpret_cast<const char*>(&image.rgba[i]), 3);
  return file;
}

bool is_pfm(std::string_view bytes) { return begins(bytes, 'F') || begins(bytes, 'f'); }

Read<ImageHeader> read_pfm_header(std::string_view bytes) { return image_header(read(bytes, true)); }

Read<FileImage> decode_pfm(std::string_view bytes) { return decode(read(bytes, true)); }

std::string pfm(const ImageView& image) {
  static_assert(std::endian::native == std::endian::little, "a negative scale says that numbers begin with the lowest byte");
  std::string file = head("PF", image.width, image.height, "-1.0");
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  file.reserve(file.size() + 3 * sizeof(float) * width * height);
  for (size_t y = height; y-- > 0;)
    for (size_t x = 0; x < width; ++x)
      file.append(reinterpret_cast<const char*>(&image.rgba[4 * (y * width + x)]), 3 * sizeof(float));
  return file;
}

}  // namespace isoshade::scene
