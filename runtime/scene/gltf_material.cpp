// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

/// A member of an extension that is read; null if there is none. Numbers are numbers (check_json).
const tinygltf::Value* member_of(const tinygltf::ExtensionMap& extensions, const char* extension, const char* key) {
  const auto found = extensions.find(extension);
  if (found == extensions.end() || !found->second.IsObject() || !found->second.Has(key)) return nullptr;
  return &found->second.Get(key);
}

float number_of(const tinygltf::Value& value) { return canonical(static_cast<float>(value.GetNumberAsDouble())); }

/// What a material says of how a texture is read.
struct Reference {
  int texture = -1;
  int set = 0;
  std::array<float, 3> u{1, 0, 0}, v{0, 1, 0};
};

/// `Info`: tinygltf has a type for each kind of texture, all with these members.
template <class Info>
Reference reference_of(const Info& info) {
  const auto member = [&](const char* key) { return member_of(info.extensions, extension::texture_transform, key); };
  const auto pair = [&](const char* key, float otherwise) {
    const tinygltf::Value* found = member(key);
    if (found == nullptr) return std::array{otherwise, otherwise};
    return std::array{number_of(found->Get(0)), number_of(found->Get(1))};
  };
  Reference made{info.index, info.texCoord};
  if (const tinygltf::Value* set = member("texCoord")) made.set = set->GetNumberAsInt();
  const auto offset = pair("offset", 0), scale = pair("scale", 1);
  const tinygltf::Value* rotation = member("rotation");
  const SinCos turn = rotation == nullptr ? SinCos{0, 1} : sin_cos_of_radians(number_of(*rotation));
  // Scaled, then turned against the clock, v down, then moved.
  made.u = {turn.cos * scale[0], turn.sin * scale[1], offset[0]};
  made.v = {-turn.sin * scale[0], turn.cos * scale[1], offset[1]};
  return made;
}

std::string_view wrap_name(int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE: return "clamp";
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT: return "mirror";
    default: return "periodic";
  }
}

/// The filter nearest to both of a sampler's: what magnifies says whether texels have edges, what minifies whether there
/// are mip levels. Without a sampler they are there.
std::string_view filter_name(const tinygltf::Sampler& sampler) {
  const int smaller = sampler.minFilter, larger = sampler.magFilter;
  const bool has_edges = larger == TINYGLTF_TEXTURE_FILTER_NEAREST ||
                         (larger < 0 && smaller == TINYGLTF_TEXTURE_FILTER_NEAREST);
  if (has_edges) return "closest";
  const bool has_levels = smaller != TINYGLTF_TEXTURE_FILTER_NEAREST && smaller != TINYGLTF_TEXTURE_FILTER_LINEAR;
  return has_levels ? "trilinear" : "linear";
}

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
  material.blended = from.alphaMode == "BLEND";
  material.double_sided = from.doubleSided;
  material.metallic = number(factors.metallicFactor);
  const float perceptual = number(factors.roughnessFactor);
  material.roughness = perceptual * perceptual;
  for (size_t i = 0; i < 3 && i < from.emissiveFactor.size(); ++i)
    material.emissive_color[i] = number(from.emissiveFactor[i]);
  if (const auto* strength = member_of(from.extensions, extension::emissive_strength, "emissiveStrength"))
    for (float& channel : material.emissive_color) channel = canonical(channel * std::max(number_of(*strength), 0.0f));
  if (from.extensions.contains(extension::unlit)) material.values["unlit"] = {1};
  material.occlusion_strength = number(from.occlusionTexture.strength);
  const double scale = from.normalTexture.scale;
  if (std::abs(scale) <= 1e6) material.normal_scale = canonical(static_cast<float>(scale));
  return material;
}

void read_textures(const tinygltf::Model& model, const tinygltf::Material& from, ImageBytes& images,
                   Refusal& refusal, Material& material) {
  const auto read = [&](const std::string& parameter, const Reference& reference, bool srgb = false) {
    if (reference.texture < 0 || reference.set > 1 || refusal.refused()) return;
    const std::string name = "the texture " + std::to_string(reference.texture);
    const auto refuse = [&](const std::string& reason) { refusal.refuse(support::Id::bad_image, name, reason); };
    if (static_cast<size_t>(reference.texture) >= model.textures.size()) return refuse("it does not exist");
    const tinygltf::Texture& texture = model.textures[static_cast<size_t>(reference.texture)];
    if (texture.source < 0) return refuse("it has no image");
    if (static_cast<size_t>(texture.source) >= model.images.size())
      return refuse("the image " + std::to_string(texture.source) + " does not exist");
    tinygltf::Sampler sampler;
    if (texture.sampler >= 0) {
      if (static_cast<size_t>(texture.sampler) >= model.samplers.size())
        return refuse("the sampler " + std::to_string(texture.sampler) + " does not exist");
      sampler = model.samplers[static_cast<size_t>(texture.sampler)];
    }
    auto image = read_gltf_image(model, texture.source, images, refusal);
    if (!image) return;
    image->srgb = srgb;
    material.textures[parameter] = *std::move(image);
    material.values[parameter + "_set"] = {static_cast<float>(reference.set)};
    material.values[parameter + "_u"] = {reference.u.begin(), reference.u.end()};
    material.values[parameter + "_v"] = {reference.v.begin(), reference.v.end()};
    material.names[parameter + "_wrap_u"] = wrap_name(sampler.wrapS);
    material.names[parameter + "_wrap_v"] = wrap_name(sampler.wrapT);
    material.names[parameter + "_filter"] = filter_name(sampler);
  };
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  read("base_color_texture", reference_of(pbr.baseColorTexture), true);
  read("metallic_roughness_texture", reference_of(pbr.metallicRoughnessTexture));
  read("normal_texture", reference_of(from.normalTexture));
  read("occlusion_texture", reference_of(from.occlusionTexture));
  read("emissive_texture", reference_of(from.emissiveTexture), true);
}

}  // namespace

Material read_material(const tinygltf::Model& model, int material, ImageBytes& images, Refusal& refusal) {
  const tinygltf::Material& from = model.materials[static_cast<size_t>(material)];
  Material result = read_factors(from);
  read_textures(model, from, images, refusal, result);
  return result;
}

int normal_texcoord_set(const tinygltf::Model& model, int material) {
  if (material < 0 || static_cast<size_t>(material) >= model.materials.size()) return 0;
  return reference_of(model.materials[static_cast<size_t>(material)].normalTexture).set == 1 ? 1 : 0;
}

}  // namespace isoshade::scene
