// SPDX-License-Identifier: Apache-2.0
// PNG and JPEG through stb. Debian's libstb has the implementation; a copy of our own would clash with tinygltf's.
#include <memory>
#include <stb_image.h>
#include <stb_image_write.h>
#include <type_traits>

#include "compiler/support/check.h"
#include "runtime/scene/image_codecs.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

std::string png(int width, int height, std::span<const uint8_t> rgba) {
  support::check(rgba.size() == size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height),
                 "png: image of odd size");
  std::string bytes;
  const auto append = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  const int written = stbi_write_png_to_func(append, &bytes, width, height, 4, rgba.data(), 4 * width);
  support::check(written != 0 && !bytes.empty(), "stb wrote no PNG");
  return bytes;
}

namespace {

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

uint32_t big_endian(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// The bytes of an image's rows, with the byte before each, of this size.
size_t row_bytes(int64_t width, int64_t height, int64_t bits) {
  return width == 0 ? 0 : static_cast<size_t>(height * ((width * bits + 7) / 8 + 1));
}

/// Whether the data of a PNG unpack to no more than its rows have: stb would unpack gigabytes of zeros. The header was
/// found good.
bool unpacks_to_its_rows(std::string_view bytes, int width, int height) {
  constexpr size_t signature = 8, around = 12, header = 13;
  constexpr int channels[] = {1, 0, 3, 1, 2, 0, 4};
  size_t most = 0;
  std::string packed;
  for (size_t at = signature; bytes.size() - at >= around;) {
    const size_t length = big_endian(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - around) break;
    if (type == "IHDR" && length == header && most == 0) {
      const auto field = [&](size_t i) { return static_cast<unsigned char>(bytes[at + 8 + i]); };
      const int64_t bits = int64_t{field(8)} * (field(9) < 7 ? channels[field(9)] : 4);
      most = row_bytes(width, height, bits);
      // Interlaced: seven images, each of every so many columns and rows.
      constexpr int x0[] = {0, 4, 0, 2, 0, 1, 0}, y0[] = {0, 0, 4, 0, 2, 0, 1};
      constexpr int dx[] = {8, 8, 4, 4, 2, 2, 1}, dy[] = {8, 8, 8, 4, 4, 2, 2};
      if (field(12) != 0) most = 0;
      for (int i = 0; i < 7 && field(12) != 0; ++i)
        most += row_bytes((width - x0[i] + dx[i] - 1) / dx[i], (height - y0[i] + dy[i] - 1) / dy[i], bits);
    }
    if (type == "IDAT") packed.append(bytes.substr(at + 8, length));
    at += around + length;
  }
  if (packed.empty() || most == 0) return false;
  const std::unique_ptr<char[]> rows(new char[most]);
  return stbi_zlib_decode_buffer(rows.get(), static_cast<int>(most), packed.data(),
                                 static_cast<int>(packed.size())) >= 0;
}

std::string failure() {
  const char* reason = stbi_failure_reason();
  return reason == nullptr || *reason == '\0' ? "the file is damaged" : reason;
}

}  // namespace

Read<ImageHeader> read_stb_header(std::string_view bytes) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  ImageHeader header;
  int channels = 0;
  if (!is_png(bytes) && !bytes.starts_with("\xff\xd8\xff"))
    return {{}, "it is no PNG, JPEG, HDR or EXR file"};
  if (is_png(bytes) && bytes.size() >= 24 && bytes.substr(12, 4) == "IHDR") {  // stb would tell no size
    std::string reason = refuse_size(big_endian(bytes, 16), big_endian(bytes, 20));
    if (!reason.empty()) return {{}, std::move(reason)};
  }
  if (stbi_info_from_memory(data, size, &header.width, &header.height, &channels) == 0)
    return {{}, "its header is damaged"};
  if (std::string reason = refuse_size(header.width, header.height); !reason.empty())
    return {{}, std::move(reason)};
  header.bytes = stbi_is_16_bit_from_memory(data, size) == 0;
  return {header, {}};
}

Read<FileImage> decode_by_stb(std::string_view bytes) {
  Read<ImageHeader> header = read_stb_header(bytes);
  if (!header.found) return {{}, std::move(header.reason)};
  FileImage image;
  image.width = header.found->width;
  image.height = header.found->height;
  if (is_png(bytes) && !unpacks_to_its_rows(bytes, image.width, image.height))
    return {{}, "its data do not unpack to what its size needs"};
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  const auto owned = [](auto* loaded) {
    return std::unique_ptr<std::remove_pointer_t<decltype(loaded)>, void (*)(void*)>(loaded, stbi_image_free);
  };
  if (header.found->bytes) {
    const auto loaded = owned(stbi_load_from_memory(data, size, &width, &height, &channels, 4));
    if (loaded == nullptr) return {{}, failure()};
    image.bytes.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) {
      const auto byte = [&](size_t channel) { return uint32_t{loaded.get()[4 * i + channel]}; };
      image.bytes[i] = byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
    }
  } else {
    const auto loaded = owned(stbi_load_16_from_memory(data, size, &width, &height, &channels, 4));
    if (loaded == nullptr) return {{}, failure()};
    image.rgba.resize(4 * pixels);
    for (size_t i = 0; i < 4 * pixels; ++i) image.rgba[i] = static_cast<float>(loaded.get()[i]) / 65535.0f;
  }
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
