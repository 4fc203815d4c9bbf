// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/exr_data.h"

#include <array>
#include <zlib.h>

namespace isoshade::scene::exr_file {
namespace {

/// Of the pixels as they are before they are packed.
int64_t unpacked_size(const Part& part, const Window& pixels) {
  int64_t size = 0;
  for (const Channel& channel : part.channels)
    size += sampled_rows(part, pixels, channel) * samples(pixels.width(), channel.x_sampling) *
            bytes_of(channel.type);
  return size;
}

/// The bytes that runs unpack to; -1 if a run is cut off.
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
  // They count from the first row of the data window, which has samples.
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
  if (packed == size) return true;  // stored as it is, where packing does not make it smaller
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
