// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <zlib.h>

#include "runtime/scene/exr_file.h"

namespace isoshade::scene::exr_file {
namespace {

template <class T>
T number_at(std::string_view bytes, size_t at) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i)
    value |= static_cast<T>(T{static_cast<unsigned char>(bytes[at + i])} << (8 * i));
  return value;
}

int32_t int_at(std::string_view bytes, size_t at) {
  return static_cast<int32_t>(number_at<uint32_t>(bytes, at));
}

class Finder {
 public:
  Finder(std::string_view bytes, const Contents& contents)
      : bytes_(bytes), contents_(contents), part_(contents.read_part()) {}

  /// Empty if the file contains the whole offset table.
  bool find_table() {
    table_ = contents_.tables;
    for (size_t i = 0; i < contents_.parts.size(); ++i) {
      const auto size = 8 * static_cast<uint64_t>(contents_.parts[i].chunk_count);
      if (size > bytes_.size() - table_) return false;
      if (i == contents_.part) return true;
      table_ += size;
    }
    return false;
  }

  /// The bytes of the chunk at this position in the table, from its offset on; empty if they are not in the file.
  std::string_view chunk(int64_t number) const {
    const auto offset = number_at<uint64_t>(bytes_, table_ + 8 * static_cast<size_t>(number));
    const size_t head = number_size() + place_size() + 4;
    if (offset < contents_.tables || offset > bytes_.size() || bytes_.size() - offset < head) return {};
    std::string_view found = bytes_.substr(offset);
    if (contents_.multipart && number_at<uint32_t>(found, 0) != contents_.part) return {};
    const uint32_t size = number_at<uint32_t>(found, head - 4);
    if (size > found.size() - head) return {};
    return found.substr(number_size(), place_size() + 4 + size);
  }

  /// The position that a chunk states.
  bool is_at(std::string_view chunk, const Chunk& place) const {
    if (!part_.tiles) return int_at(chunk, 0) == place.pixels.min_y;
    return int_at(chunk, 0) == place.column && int_at(chunk, 4) == place.row && int_at(chunk, 8) == 0 &&
           int_at(chunk, 12) == 0;
  }

  std::string_view data_of(std::string_view chunk) const { return chunk.substr(place_size() + 4); }

  /// The positions of the chunks of the largest level, in the order of the table.
  std::vector<Chunk> places() const {
    const Window& data = part_.data;
    const int64_t width = part_.tiles ? part_.tiles->width : data.width();
    const int64_t height = part_.tiles ? part_.tiles->height : rows_per_chunk(part_.compression);
    std::vector<Chunk> places;
    for (int64_t y = 0; y * height < data.height(); ++y) {
      for (int64_t x = 0; x * width < data.width(); ++x) {
        Chunk& place = places.emplace_back();
        place.column = static_cast<int>(x);
        place.row = static_cast<int>(y);
        const auto end = [](int64_t first, int64_t size, int32_t last) {
          return static_cast<int32_t>(std::min<int64_t>(first + size - 1, last));
        };
        const int64_t left = data.min_x + x * width, top = data.min_y + y * height;
        place.pixels = {static_cast<int32_t>(left), static_cast<int32_t>(top), end(left, width, data.max_x),
                        end(top, height, data.max_y)};
      }
    }
    return places;
  }

 private:
  size_t number_size() const { return contents_.multipart ? 4 : 0; }
  size_t place_size() const { return part_.tiles ? 16 : 4; }

  std::string_view bytes_;
  const Contents& contents_;
  const Part& part_;
  size_t table_ = 0;
};

}  // namespace

Read<std::vector<Chunk>> find_chunks(std::string_view bytes, const Contents& contents) {
  const Part& part = contents.read_part();
  const std::string truncated = "the file is truncated: it lacks pixels";
  Finder finder(bytes, contents);
  if (!finder.find_table()) return {{}, truncated};
  std::vector<Chunk> chunks = finder.places();
  for (int64_t i = 0; i < part.chunk_count; ++i) {
    const std::string_view found = finder.chunk(i);
    if (found.empty()) return {{}, truncated};
    if (static_cast<size_t>(i) >= chunks.size()) continue;  // of a smaller level
    Chunk& chunk = chunks[static_cast<size_t>(i)];
    if (!finder.is_at(found, chunk) || !data_fill(part, chunk.pixels, finder.data_of(found)))
      return {{}, "the file is damaged"};
    chunk.bytes = found;
  }
  if (chunks.empty() || chunks.back().bytes.empty()) return {{}, truncated};
  return {std::move(chunks), {}};
}

namespace {

/// The size of the pixels before compression.
int64_t unpacked_size(const Part& part, const Window& pixels) {
  int64_t size = 0;
  for (const Channel& channel : part.channels)
    size += sampled_rows(part, pixels, channel) * samples(pixels.width(), channel.x_sampling) *
            bytes_of(channel.type);
  return size;
}

/// The number of bytes that run lengths decompress to; -1 if a run is truncated.
int64_t run_length(std::string_view data) {
  int64_t size = 0;
  for (size_t at = 0; at < data.size();) {
    const int count = static_cast<signed char>(data[at]);
    const size_t packed = count < 0 ? static_cast<size_t>(-count) : 1;
    size += count < 0 ? -count : count + 1;
    at += 1 + packed;
    if (at > data.size()) return -1;
  }
  return size;
}

}  // namespace

int64_t samples(int64_t pixels, int64_t sampling) { return (pixels + sampling - 1) / sampling; }

int64_t sampled_rows(const Part& part, const Window& pixels, const Channel& channel) {
  // Rows are counted from the first row of the data window, which has samples.
  const int64_t first = int64_t{pixels.min_y} - part.data.min_y,
                end = int64_t{pixels.max_y} + 1 - part.data.min_y;
  return samples(end, channel.y_sampling) - samples(first, channel.y_sampling);
}

int64_t bytes_of(PixelType type) { return type == PixelType::half ? 2 : 4; }

bool inflates_to(std::string_view data, int64_t size) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  std::array<Bytef, 65536> unpacked;
  int64_t found = 0;
  int result = Z_OK;
  while (result == Z_OK && found <= size) {
    stream.next_out = unpacked.data();
    stream.avail_out = unpacked.size();
    result = inflate(&stream, Z_NO_FLUSH);
    found += static_cast<int64_t>(unpacked.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return result == Z_STREAM_END && found == size;
}

bool data_fill(const Part& part, const Window& pixels, std::string_view data) {
  const int64_t size = unpacked_size(part, pixels), packed = static_cast<int64_t>(data.size());
  if (packed == size) return true;  // stored uncompressed, if compression would not make it smaller
  if (packed == 0 || packed > size) return false;
  switch (part.compression) {
    case Compression::none: return false;
    case Compression::rle: return run_length(data) == size;
    case Compression::zips:
    case Compression::zip: return inflates_to(data, size);
    case Compression::dwaa:
    case Compression::dwab: return dwa_fills(part, pixels, data);
    case Compression::piz:
    case Compression::pxr24:
    case Compression::b44:
    case Compression::b44a: return true;
  }
  return false;
}

}  // namespace isoshade::scene::exr_file
