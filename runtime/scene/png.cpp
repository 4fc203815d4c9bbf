// SPDX-License-Identifier: Apache-2.0
// PNG through stb. Debian's libstb has the implementation; a copy of our own would clash with tinygltf's.
#include <memory>
#include <stb_image.h>
#include <stb_image_write.h>

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

Decoded decode_png(std::string_view bytes) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
  int width = 0, height = 0, channels = 0;
  if (bytes.substr(0, signature.size()) != signature ||
      stbi_info_from_memory(data, size, &width, &height, &channels) == 0) {
    return {{}, "it is no PNG file"};
  }
  if (width > max_size || height > max_size)
    return {{}, "a side is longer than " + std::to_string(max_size) + " pixels"};
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), stbi_image_free);
  if (pixels == nullptr) return {{}, stbi_failure_reason()};
  FloatImage image;
  image.width = width;
  image.height = height;
  const size_t values = size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height);
  image.rgba.reserve(values);
  for (size_t i = 0; i < values; ++i) image.rgba.push_back(static_cast<float>(pixels.get()[i]) / 255.0f);
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
