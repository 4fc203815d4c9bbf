// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

Material read_factors(const tinygltf::Material& from) {
  const tinygltf::PbrMetallicRoughness& factors = from.pbrMetallicRoughness;
  const auto number = [](double value) {
    return value > 0 ? canonical(static_cast<float>(std::min(value, 1.0))) : 0.0f;
  };
  Material material;
  for (size_t i = 0; i < 3 && i < factors.baseColorFactor.size(); ++i)
    material.base_color[i] = number(factors.baseColorFactor[i]);
  if (factors.baseColorFactor.size() > 3) material.alpha = number(factors.baseColorFactor[3]);
  if (from.alphaMode == "MASK")
    material.alpha_cutoff = canonical(static_cast<float>(std::clamp(from.alphaCutoff, 0.0, 1e6)));
  material.double_sided = from.doubleSided;
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

std::map<std::string, MaterialImage> read_textures(const tinygltf::Model& model,
                                                   const tinygltf::Material& material, ImageBytes& images,
                                                   Refusal& refusal) {
  std::map<std::string, MaterialImage> found;
  const auto read = [&](const char* parameter, int texture, int texcoord, bool srgb = false) {
    if (texture < 0 || texcoord != 0 || refusal.refused()) return;
    const std::string name = "the texture " + std::to_string(texture);
    if (static_cast<size_t>(texture) >= model.textures.size()) {
      refusal.refuse(support::Id::bad_image, name, "it does not exist");
      return;
    }
    const int source = model.textures[static_cast<size_t>(texture)].source;
    if (source < 0 || static_cast<size_t>(source) >= model.images.size()) {
      refusal.refuse(
          support::Id::bad_image, name,
          source < 0 ? "it has no image" : "the image " + std::to_string(source) + " does not exist");
      return;
    }
    if (auto image = read_gltf_image(model, source, images, refusal)) {
      image->srgb = srgb;
      found[parameter] = *std::move(image);
    }
  };
  const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  read("base_color_texture", pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord, true);
  read("metallic_roughness_texture", pbr.metallicRoughnessTexture.index,
       pbr.metallicRoughnessTexture.texCoord);
  read("normal_texture", material.normalTexture.index, material.normalTexture.texCoord);
  read("occlusion_texture", material.occlusionTexture.index, material.occlusionTexture.texCoord);
  read("emissive_texture", material.emissiveTexture.index, material.emissiveTexture.texCoord, true);
  return found;
}

}  // namespace

Material read_material(const tinygltf::Model& model, int material, ImageBytes& images, Refusal& refusal) {
  const tinygltf::Material& from = model.materials[static_cast<size_t>(material)];
  Material result = read_factors(from);
  result.textures = read_textures(model, from, images, refusal);
  return result;
}

}  // namespace isoshade::scene
