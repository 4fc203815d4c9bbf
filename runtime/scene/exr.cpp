// SPDX-License-Identifier: Apache-2.0
// OpenEXR through tinyexr.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <tinyexr.h>

#include "compiler/support/check.h"
#include "runtime/scene/image_codecs.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {
namespace {

constexpr int channel_count = 5;
// The format wants its channels in alphabetical order.
constexpr const char* channel_names[channel_count] = {"A", "B", "G", "R", "Z"};
constexpr int channel_source[channel_count] = {3, 2, 1, 0, 4};  // in our pixel; 4 is the depth

/// tinyexr's messages have to be freed.
std::string take_message(const char* message) {
  if (message == nullptr) return "the file is damaged";
  std::string text(message);
  FreeEXRErrorMessage(message);
  return text;
}

struct Header : EXRHeader {
  Header() { InitEXRHeader(this); }
  ~Header() { FreeEXRHeader(this); }
  Header(const Header&) = delete;
  Header& operator=(const Header&) = delete;
};

struct LoadedImage : EXRImage {
  LoadedImage() { InitEXRImage(this); }
  ~LoadedImage() { FreeEXRImage(this); }
  LoadedImage(const LoadedImage&) = delete;
  LoadedImage& operator=(const LoadedImage&) = delete;
};

int find_channel(const EXRHeader& header, const char* name) {
  for (int c = 0; c < header.num_channels; ++c)
    if (std::strcmp(header.channels[c].name, name) == 0) return c;
  return -1;
}

bool is_grey(const EXRHeader& header) {
  return find_channel(header, "Y") >= 0 && find_channel(header, "R") < 0;
}

/// Empty if the header describes what we read: flat scanlines of a sensible size with the three colours, or grey.
std::string refuse(const EXRVersion& version, const EXRHeader& header) {
  if (version.multipart != 0 || version.non_image != 0 || header.tiled != 0)
    return "it is tiled, deep or of several parts";
  const EXRBox2i& window = header.data_window;
  const int64_t width = int64_t{window.max_x} - window.min_x + 1;
  const int64_t height = int64_t{window.max_y} - window.min_y + 1;
  if (std::string reason = refuse_size(width, height); !reason.empty()) return reason;
  constexpr int64_t most_values = int64_t{8} * max_size * max_size;  // tinyexr unpacks all channels
  if (header.num_channels > most_values / (width * height) || header.num_channels > 64)
    return "it has too many channels";
  for (const char* name : {"R", "G", "B"})
    if (!is_grey(header) && find_channel(header, name) < 0) return "it has no channel " + std::string(name);
  for (int c = 0; c < header.num_channels; ++c) {
    if (header.channels[c].x_sampling != 1 || header.channels[c].y_sampling != 1)
      return "a channel is subsampled";
    if (header.channels[c].pixel_type == TINYEXR_PIXELTYPE_UINT) return "a channel holds integers";
  }
  return {};
}

}  // namespace

std::string exr(const ImageView& image) {
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  support::check(image.rgba.size() == 4 * pixels && image.depth.size() == pixels, "exr: image of odd size");
  std::vector<float> planes[channel_count];
  unsigned char* pointers[channel_count];
  EXRChannelInfo infos[channel_count];
  int types[channel_count];
  for (int c = 0; c < channel_count; ++c) {
    planes[c].resize(pixels);
    const int source = channel_source[c];
    for (size_t i = 0; i < pixels; ++i)
      planes[c][i] = source == 4 ? image.depth[i] : image.rgba[4 * i + static_cast<size_t>(source)];
    pointers[c] = reinterpret_cast<unsigned char*>(planes[c].data());
    std::memset(&infos[c], 0, sizeof infos[c]);
    std::strcpy(infos[c].name, channel_names[c]);
    types[c] = TINYEXR_PIXELTYPE_FLOAT;
  }

  // These two only borrow what they point to, so they are not freed.
  EXRHeader header;
  InitEXRHeader(&header);
  header.num_channels = channel_count;
  header.channels = infos;
  header.pixel_types = types;
  header.requested_pixel_types = types;
  header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
  EXRImage picture;
  InitEXRImage(&picture);
  picture.num_channels = channel_count;
  picture.images = pointers;
  picture.width = image.width;
  picture.height = image.height;

  unsigned char* memory = nullptr;
  const char* message = nullptr;
  const size_t size = SaveEXRImageToMemory(&picture, &header, &memory, &message);
  if (size == 0) support::bug("tinyexr: " + take_message(message));
  const std::unique_ptr<unsigned char, void (*)(void*)> owner(memory, std::free);
  return std::string(reinterpret_cast<const char*>(memory), size);
}

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

namespace {

/// Why there is none; empty if it was read and describes what we read.
std::string read_into(Header& header, std::string_view bytes) {
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  EXRVersion version;
  if (ParseEXRVersionFromMemory(&version, data, bytes.size()) != TINYEXR_SUCCESS)
    return "it is no OpenEXR file";
  if (version.multipart != 0) return "it is of several parts";
  const char* message = nullptr;
  if (ParseEXRHeaderFromMemory(&header, &version, data, bytes.size(), &message) != TINYEXR_SUCCESS)
    return take_message(message);
  return refuse(version, header);
}

}  // namespace

Read<ImageHeader> read_exr_header(std::string_view bytes) {
  Header header;
  if (std::string reason = read_into(header, bytes); !reason.empty()) return {{}, std::move(reason)};
  const EXRBox2i& window = header.data_window;
  return {ImageHeader{window.max_x - window.min_x + 1, window.max_y - window.min_y + 1, false}, {}};
}

Read<FileImage> decode_exr(std::string_view bytes) {
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  Header header;
  if (std::string reason = read_into(header, bytes); !reason.empty()) return {{}, std::move(reason)};
  const char* message = nullptr;
  for (int c = 0; c < header.num_channels; ++c) header.requested_pixel_types[c] = TINYEXR_PIXELTYPE_FLOAT;
  LoadedImage loaded;
  loaded.num_channels = header.num_channels;  // so that on failure tinyexr frees all of them
  if (LoadEXRImageFromMemory(&loaded, &header, data, bytes.size(), &message) != TINYEXR_SUCCESS) {
    InitEXRImage(&loaded);  // tinyexr has freed what it allocated, and left the pointers
    return {{}, take_message(message)};
  }
  if (loaded.images == nullptr) return {{}, "it holds no scanlines"};

  FileImage image;
  image.width = loaded.width;
  image.height = loaded.height;
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  image.rgba.assign(4 * pixels, 1.0f);
  for (int c = 0; c < channel_count; ++c) {
    const bool color = channel_source[c] < 3;
    const int place = find_channel(header, color && is_grey(header) ? "Y" : channel_names[c]);
    if (place < 0) continue;
    const auto* plane = reinterpret_cast<const float*>(loaded.images[place]);
    if (channel_source[c] == 4) {
      image.depth.assign(plane, plane + pixels);
      continue;
    }
    for (size_t i = 0; i < pixels; ++i) image.rgba[4 * i + static_cast<size_t>(channel_source[c])] = plane[i];
  }
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
