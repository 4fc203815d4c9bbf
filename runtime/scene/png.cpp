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

std::string failure() {
  const char* reason = stbi_failure_reason();
  return reason == nullptr || *reason == '\0' ? "the file is damaged" : reason;
}

}  // namespace

Decoded decode_by_stb(std::string_view bytes) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!(bytes.starts_with("\x89PNG\r\n\x1a\n") || bytes.starts_with("\xff\xd8\xff")) ||
      stbi_info_from_memory(data, size, &width, &height, &channels) == 0) {
    return {{}, "it is no PNG, JPEG, HDR or EXR file"};
  }
  if (std::string reason = refuse_size(width, height); !reason.empty()) return {{}, std::move(reason)};
  FloatImage image;
  image.width = width;
  image.height = height;
  const bool words = stbi_is_16_bit_from_memory(data, size) != 0;
  image.bytes = !words;
  const auto take = [&](auto* loaded, float whole) -> Decoded {
    if (loaded == nullptr) return {{}, failure()};
    const std::unique_ptr<std::remove_pointer_t<decltype(loaded)>, void (*)(void*)> pixels(loaded,
                                                                                           stbi_image_free);
    const size_t values = size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height);
    image.rgba.reserve(values);
    for (size_t i = 0; i < values; ++i) image.rgba.push_back(static_cast<float>(pixels.get()[i]) / whole);
    return {std::move(image), {}};
  };
  if (words) return take(stbi_load_16_from_memory(data, size, &width, &height, &channels, 4), 65535.0f);
  return take(stbi_load_from_memory(data, size, &width, &height, &channels, 4), 255.0f);
}

}  // namespace isoshade::scene
