// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {
namespace {

/// The bytes of an image that lies in a buffer.
std::shared_ptr<const std::string> bytes_in_buffer(const tinygltf::Model& model, int view) {
  if (view < 0 || static_cast<size_t>(view) >= model.bufferViews.size()) return nullptr;
  const tinygltf::BufferView& part = model.bufferViews[static_cast<size_t>(view)];
  if (part.buffer < 0 || static_cast<size_t>(part.buffer) >= model.buffers.size()) return nullptr;
  const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(part.buffer)].data;
  if (part.byteOffset > data.size() || part.byteLength > data.size() - part.byteOffset) return nullptr;
  const auto first = data.begin() + static_cast<ptrdiff_t>(part.byteOffset);
  return std::make_shared<const std::string>(first, first + static_cast<ptrdiff_t>(part.byteLength));
}

}  // namespace

std::map<std::string, GltfImage> read_textures(const tinygltf::Model& model,
                                               const tinygltf::Material& material, const std::string& file,
                                               const ImageBytes& images, Refusal& refusal) {
  std::map<std::string, GltfImage> found;
  const auto read = [&](const char* parameter, int texture, int texcoord) {
    if (texture < 0 || texcoord != 0 || refusal.refused()) return;
    const bool exists = static_cast<size_t>(texture) < model.textures.size();
    const int source = exists ? model.textures[static_cast<size_t>(texture)].source : -1;
    if (source < 0 || static_cast<size_t>(source) >= model.images.size()) {
      refusal.refuse("a material has a texture without an image");
      return;
    }
    const auto kept = images.find(source);
    GltfImage image{file + "#image" + std::to_string(source),
                    kept != images.end()
                        ? kept->second
                        : bytes_in_buffer(model, model.images[static_cast<size_t>(source)].bufferView)};
    if (image.bytes == nullptr) {
      refusal.refuse("the image " + std::to_string(source) + " of a material cannot be read");
      return;
    }
    found[parameter] = std::move(image);
  };
  const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  read("base_color_texture", pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord);
  read("metallic_roughness_texture", pbr.metallicRoughnessTexture.index,
       pbr.metallicRoughnessTexture.texCoord);
  read("normal_texture", material.normalTexture.index, material.normalTexture.texCoord);
  read("occlusion_texture", material.occlusionTexture.index, material.occlusionTexture.texCoord);
  read("emissive_texture", material.emissiveTexture.index, material.emissiveTexture.texCoord);
  return found;
}

}  // namespace isoshade::scene
