// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "compiler/graph/files.h"
#include "compiler/support/visible.h"
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {
namespace {

using support::Id;

/// Decodes a URI: "a%20b" becomes "a b".
std::string percent_decoded(const std::string& uri) {
  const auto digit = [&](size_t at) {
    constexpr std::string_view digits = "0123456789abcdef0123456789ABCDEF";
    const size_t found = at < uri.size() ? digits.find(uri[at]) : std::string_view::npos;
    return found == std::string_view::npos ? -1 : static_cast<int>(found % 16);
  };
  std::string decoded;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool escaped = uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0;
    decoded += escaped ? static_cast<char>(digit(i + 1) * 16 + digit(i + 2)) : uri[i];
    if (escaped) i += 2;
  }
  return decoded;
}

support::FileBytes bytes_in_file(const std::string& path, const ImageBytes& images) {
  if (path.find('\0') == std::string::npos && !graph::is_within(graph::canonical_path(path), images.folder))
    return {{}, Id::outside_reference, "it lies outside of the folder of the glTF"};
  return support::read_file(path, max_gltf_bytes);
}

support::FileBytes bytes_in_buffer(const tinygltf::Model& model, int view) {
  const support::FileBytes outside{{}, Id::bad_image, "it lies outside of its buffer"};
  if (view < 0 || static_cast<size_t>(view) >= model.bufferViews.size()) return outside;
  const tinygltf::BufferView& part = model.bufferViews[static_cast<size_t>(view)];
  if (part.buffer < 0 || static_cast<size_t>(part.buffer) >= model.buffers.size()) return outside;
  const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(part.buffer)].data;
  if (part.byteOffset > data.size() || part.byteLength > data.size() - part.byteOffset) return outside;
  const auto first = data.begin() + static_cast<ptrdiff_t>(part.byteOffset);
  return {std::string(first, first + static_cast<ptrdiff_t>(part.byteLength)), {}, {}};
}

}  // namespace

std::optional<MaterialImage> read_gltf_image(const tinygltf::Model& model, int image, ImageBytes& images,
                                             Refusal& refusal) {
  const tinygltf::Image& from = model.images[static_cast<size_t>(image)];
  std::string name = images.file + "#image" + std::to_string(image);
  std::string part = "the image " + std::to_string(image);
  if (!from.uri.empty()) {
    const std::string beside = percent_decoded(from.uri);
    name = (std::filesystem::path(images.file).parent_path() / beside).string();
    part = "the image " + support::quote(beside);
  }
  std::shared_ptr<const std::string>& kept = images.by_index[image];
  if (kept == nullptr) {
    support::FileBytes read =
        from.uri.empty() ? bytes_in_buffer(model, from.bufferView) : bytes_in_file(name, images);
    if (!read.bytes) {
      refusal.refuse(read.id, std::move(part), std::move(read.reason));
      return std::nullopt;
    }
    images.total += read.bytes->size();
    kept = std::make_shared<const std::string>(*std::move(read.bytes));
  }
  if (images.total > max_gltf_bytes) {
    refusal.refuse(
        Id::too_large, std::move(part),
        "the images of the materials have more than " + std::to_string(max_gltf_bytes >> 20) + " MiB");
    return std::nullopt;
  }
  return MaterialImage{std::move(name), kept, false};
}

}  // namespace isoshade::scene
