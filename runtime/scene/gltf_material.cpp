// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"

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

GltfMaterial read_factors(const tinygltf::Material& from) {
  const tinygltf::PbrMetallicRoughness& factors = from.pbrMetallicRoughness;
  const auto number = [](double value) {
    return value > 0 ? canonical(static_cast<float>(std::min(value, 1.0))) : 0.0f;
  };
  GltfMaterial material;
  for (size_t i = 0; i < 4 && i < factors.baseColorFactor.size(); ++i)
    material.base_color[i] = number(factors.baseColorFactor[i]);
  material.metallic = number(factors.metallicFactor);
  const float perceptual = number(factors.roughnessFactor);
  material.roughness = perceptual * perceptual;
  for (size_t i = 0; i < 3 && i < from.emissiveFactor.size(); ++i)
    material.emissive_color[i] = number(from.emissiveFactor[i]);
  material.occlusion_strength = number(from.occlusionTexture.strength);
  const double scale = from.normalTexture.scale;
  if (std::abs(scale) <= 1e6) material.normal_scale = canonical(static_cast<float>(scale));
  return material;
}

std::map<std::string, GltfImage> read_textures(const tinygltf::Model& model,
                                               const tinygltf::Material& material, const std::string& file,
                                               ImageBytes& images, Refusal& refusal) {
  std::map<std::string, GltfImage> found;
  const auto read = [&](const char* parameter, int texture, int texcoord) {
    if (texture < 0 || texcoord != 0 || refusal.refused()) return;
    const bool exists = static_cast<size_t>(texture) < model.textures.size();
    const int source = exists ? model.textures[static_cast<size_t>(texture)].source : -1;
    if (source < 0 || static_cast<size_t>(source) >= model.images.size()) {
      refusal.refuse("a material has a texture without an image");
      return;
    }
    const auto [kept, is_new] = images.by_index.try_emplace(source);
    if (is_new) {
      kept->second = bytes_in_buffer(model, model.images[static_cast<size_t>(source)].bufferView);
      images.copied += kept->second == nullptr ? 0 : kept->second->size();
    }
    if (images.copied > max_gltf_bytes) {
      refusal.refuse("the images of its materials have more than " + std::to_string(max_gltf_bytes >> 20) +
                     " MiB");
      return;
    }
    if (kept->second == nullptr) {
      refusal.refuse("the image " + std::to_string(source) + " of a material cannot be read");
      return;
    }
    found[parameter] = {file + "#image" + std::to_string(source), kept->second};
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

}  // namespace

GltfMaterial read_material(const tinygltf::Model& model, int material, const std::string& file,
                           ImageBytes& images, Refusal& refusal) {
  const tinygltf::Material& from = model.materials[static_cast<size_t>(material)];
  GltfMaterial result = read_factors(from);
  result.textures = read_textures(model, from, file, images, refusal);
  return result;
}

}  // namespace isoshade::scene
