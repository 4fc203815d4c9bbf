// SPDX-License-Identifier: Apache-2.0
// PNG: read through libspng, written by bands of rows at the same time.
#include <algorithm>
#include <bit>
#include <cstdlib>
#include <memory>
#include <new>
#include <spng.h>
#include <zlib.h>

#include "compiler/support/assert.h"
#include "runtime/scene/deflate.h"
#include "runtime/scene/image_file.h"
#include "runtime/threads/workers.h"

namespace isoshade::scene {
namespace {

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

Context new_context(int flags) {
  Context context(spng_ctx_new(flags), spng_ctx_free);
  if (context == nullptr) throw std::bad_alloc();
  return context;
}

constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";

/// PNG, third edition, 9.4: the neighbour nearest to left + above - corner.
int paeth(int left, int above, int corner) {
  const int to_left = std::abs(above - corner), to_above = std::abs(left - corner),
            to_corner = std::abs(left + above - 2 * corner);
  const int of_two = to_above <= to_corner ? above : corner;
  return to_left <= to_above && to_left <= to_corner ? left : of_two;
}

/// Rows with their channels, 3 or 4, and each byte less the one that Paeth's filter predicts.
std::string filtered(std::span<const uint8_t> rgba, size_t width, size_t first_row, size_t rows, size_t channels) {
  constexpr char paeth_filter = 4;
  const size_t row_bytes = width * channels;
  // Behind as many zeros as a pixel has bytes, which is what is left of the first pixel.
  std::vector<uint8_t> above(channels + row_bytes), row(channels + row_bytes);
  const auto take = [&](size_t y, std::vector<uint8_t>& to) {
    const uint8_t* from = &rgba[4 * width * y];
    for (size_t x = 0; x < width; ++x)
      for (size_t c = 0; c < channels; ++c) to[(x + 1) * channels + c] = from[4 * x + c];
  };
  if (first_row > 0) take(first_row - 1, above);
  std::string bytes((1 + row_bytes) * rows, paeth_filter);
  for (size_t y = 0; y < rows; ++y) {
    take(first_row + y, row);
    char* const to = &bytes[y * (1 + row_bytes) + 1];
    for (size_t i = 0; i < row_bytes; ++i)
      to[i] = static_cast<char>(row[channels + i] - paeth(row[i], above[channels + i], above[i]));
    row.swap(above);
  }
  return bytes;
}

}  // namespace

std::string png_chunk(std::string_view type, std::string_view data) {
  std::string bytes;
  bytes.reserve(data.size() + 12);
  append_big_endian(bytes, static_cast<uint32_t>(data.size()));
  bytes.append(type).append(data);
  const auto* const checked = reinterpret_cast<const Bytef*>(bytes.data() + 4);
  append_big_endian(bytes, static_cast<uint32_t>(crc32_z(0, checked, type.size() + data.size())));
  return bytes;
}

std::string png_head(int width, int height, bool has_alpha) {
  std::string header;
  append_big_endian(header, static_cast<uint32_t>(width));
  append_big_endian(header, static_cast<uint32_t>(height));
  const char rgb = 2, rgba = 6;
  header += {8, has_alpha ? rgba : rgb, 0, 0, 0};  // bits; zlib, filters, not interlaced
  return std::string(signature) + png_chunk("IHDR", header);
}

std::vector<std::string> png_data(int width, int height, std::span<const uint8_t> rgba, bool has_alpha, int threads) {
  const auto columns = static_cast<size_t>(width), rows = static_cast<size_t>(height);
  support::assert_that(rgba.size() == 4 * columns * rows, "png: image of odd size");
  constexpr size_t band_bytes = size_t{1} << 17;
  const size_t channels = has_alpha ? 4 : 3;
  const size_t row_bytes = 1 + columns * channels;
  const size_t rows_of_band = std::max<size_t>(1, band_bytes / row_bytes);
  std::vector<std::string> bands((rows + rows_of_band - 1) / rows_of_band);
  std::vector<uLong> sums(bands.size());
  threads::Workers(threads).for_each(bands.size(), [&](size_t i) {
    const size_t first = i * rows_of_band, count = std::min(rows_of_band, rows - first);
    const std::string bytes = filtered(rgba, columns, first, count, channels);
    sums[i] = adler32_z(1, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (i == 0) bands[i] = zlib_head;
    append_deflated(bytes, i + 1 == bands.size(), bands[i]);
  });
  uLong sum = sums[0];
  for (size_t i = 1; i < bands.size(); ++i) {
    const size_t count = std::min(rows_of_band, rows - i * rows_of_band);
    sum = adler32_combine(sum, sums[i], static_cast<z_off_t>(count * row_bytes));
  }
  append_big_endian(bands.back(), static_cast<uint32_t>(sum));
  return bands;
}

std::string png(int width, int height, std::span<const uint8_t> rgba, int threads) {
  bool has_alpha = false;
  for (size_t i = 3; i < rgba.size(); i += 4) has_alpha |= rgba[i] != 255;
  std::string file = png_head(width, height, has_alpha);
  for (const std::string& data : png_data(width, height, rgba, has_alpha, threads)) file += png_chunk("IDAT", data);
  return file += png_chunk("IEND", "");
}

namespace {

uint32_t big_endian(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// What the chunks before the first damaged one contain.
struct Chunks {
  size_t data = 0;            ///< bytes of all IDAT
  bool transparency = false;  ///< whether a tRNS precedes them
  bool end = false;           ///< whether there is an IEND
};

Chunks survey(std::string_view bytes) {
  constexpr size_t around = 12;  // length and type before the data, CRC after it
  Chunks chunks;
  for (size_t at = signature.size(); bytes.size() - at >= around;) {
    const size_t length = big_endian(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - around) break;
    if (type == "IDAT") chunks.data += length;
    if (type == "IEND") chunks.end = true;
    if (type == "tRNS" && chunks.data == 0) chunks.transparency = true;
    at += around + length;
  }
  return chunks;
}

std::string reason_of(int error) {
  switch (error) {
    case SPNG_IO_EOF:
    case SPNG_EOF: return "the file ends early";
    case SPNG_EMEM: return "there is not enough memory for it";
    case SPNG_ECHUNK_LIMITS: return "its texts and profiles take more than 64 MiB";
    default: return spng_strerror(error);
  }
}

/// A decoder that has read the header.
struct Opened {
  Context context{nullptr, spng_ctx_free};
  spng_ihdr header{};
  std::string reason;  ///< why the file is not read; empty if it is
};

Opened open(std::string_view bytes) {
  constexpr size_t header_end = 24;
  if (bytes.size() >= header_end && bytes.substr(12, 4) == "IHDR") {  // libspng would not tell the size
    std::string reason = refuse_size(big_endian(bytes, 16), big_endian(bytes, 20));
    if (!reason.empty()) return {.reason = std::move(reason)};
  }
  Opened opened{new_context(0), {}, {}};
  spng_ctx* context = opened.context.get();
  // libspng decompresses texts and colour profiles, although they are not used.
  constexpr size_t most_texts = size_t{64} << 20;
  int error = spng_set_png_buffer(context, bytes.data(), bytes.size());
  if (error == 0) error = spng_set_chunk_limits(context, most_texts, most_texts);
  if (error == 0) error = spng_get_ihdr(context, &opened.header);
  if (error == SPNG_IO_EOF || error == SPNG_EOF)
    opened.reason = reason_of(error);
  else if (error != 0)
    opened.reason = std::string("its header is damaged: ") + spng_strerror(error);
  return opened;
}

/// Looks up the colours of a palette image; libspng would make indices beyond the palette black. Rows of `packed` are
/// padded to bytes. Returns the reason if an index is invalid.
std::string look_up(spng_ctx* context, const spng_ihdr& header, std::span<const uint8_t> packed,
                    std::vector<uint32_t>& colors) {
  spng_plte palette{};
  spng_trns alphas{};
  if (const int error = spng_get_plte(context, &palette); error != 0) return reason_of(error);
  if (spng_get_trns(context, &alphas) != 0) alphas.n_type3_entries = 0;
  const size_t row_bytes = packed.size() / header.height;
  const unsigned bits = header.bit_depth;
  colors.reserve(size_t{header.width} * header.height);
  for (size_t y = 0; y < header.height; ++y) {
    for (size_t x = 0; x < header.width; ++x) {
      const size_t bit = x * bits;
      const unsigned shift = 8 - bits - static_cast<unsigned>(bit % 8);
      const unsigned index = packed[y * row_bytes + bit / 8] >> shift & ((1u << bits) - 1);
      if (index >= palette.n_entries) {
        return "a pixel has the colour " + std::to_string(index) + " of a palette of " +
               std::to_string(palette.n_entries);
      }
      const spng_plte_entry& color = palette.entries[index];
      const uint32_t alpha = index < alphas.n_type3_entries ? alphas.type3_alpha[index] : 255;
      colors.push_back(uint32_t{color.red} | uint32_t{color.green} << 8 | uint32_t{color.blue} << 16 |
                       alpha << 24);
    }
  }
  return {};
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with(signature); }

Read<ImageHeader> read_png_header(std::string_view bytes) {
  Opened opened = open(bytes);
  if (!opened.reason.empty()) return {{}, std::move(opened.reason)};
  return {ImageHeader{static_cast<int>(opened.header.width), static_cast<int>(opened.header.height),
                      opened.header.bit_depth <= 8, true},
          {}};
}

Read<FileImage> decode_png(std::string_view bytes) {
  Opened opened = open(bytes);
  if (!opened.reason.empty()) return {{}, std::move(opened.reason)};
  spng_ctx* context = opened.context.get();
  const spng_ihdr& header = opened.header;
  const bool indexed = header.color_type == SPNG_COLOR_TYPE_INDEXED;
  const bool wide = header.bit_depth == 16;

  // Deflate compresses at most 258 bytes into two bits: shorter files are refused before memory is allocated.
  constexpr size_t most_per_byte = 258 * 4;
  const Chunks chunks = survey(bytes);
  if (!chunks.end) return {{}, reason_of(SPNG_IO_EOF)};  // libspng accepts truncated files
  size_t size = 0;
  if (const int error = spng_decoded_image_size(context, SPNG_FMT_PNG, &size); error != 0)
    return {{}, reason_of(error)};
  if (size / most_per_byte > chunks.data)
    return {{}, "its " + std::to_string(chunks.data) + " bytes of data are too few for its size"};

  FileImage image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  const size_t pixels = size_t{header.width} * header.height;
  const auto decode = [&](auto& values, size_t count, int format) {
    values.resize(count);
    return spng_decode_image(context, values.data(), count * sizeof values[0], format, SPNG_DECODE_TRNS);
  };
  std::vector<uint8_t> packed;
  std::vector<uint16_t> numbers;
  static_assert(std::endian::native == std::endian::little, "red is the lowest byte of a word");
  int error = indexed ? decode(packed, size, SPNG_FMT_PNG)
              : wide  ? decode(numbers, 4 * pixels, SPNG_FMT_RGBA16)
                      : decode(image.bytes, pixels, SPNG_FMT_RGBA8);
  if (error == 0) error = spng_decode_chunks(context);  // up to the end
  if (error != 0) return {{}, reason_of(error)};
  // libspng ignores a damaged tRNS. With an alpha channel it does not report it.
  spng_trns transparency;
  const bool has_alpha = (header.color_type & SPNG_COLOR_TYPE_GRAYSCALE_ALPHA) != 0;
  if (chunks.transparency && !has_alpha && spng_get_trns(context, &transparency) != 0)
    return {{}, "its tRNS chunk is damaged"};
  if (std::string reason = indexed ? look_up(context, header, packed, image.bytes) : ""; !reason.empty())
    return {{}, std::move(reason)};
  image.rgba.reserve(numbers.size());
  for (const uint16_t number : numbers) image.rgba.push_back(static_cast<float>(number) / 65535.0f);
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
