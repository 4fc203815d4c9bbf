// SPDX-License-Identifier: Apache-2.0
// The parameters of an object as words of its record.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "runtime/render/textures.h"
#include "runtime/scene/gltf.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// What an object gives to the parameters of its effect, found once for all of its copies.
/// The number of the texture that is to fill an image of the effect; nothing where there is none, which is reported.
using FindTexture =
    std::function<std::optional<int>(const ImageSource& source, const lower::ImageSlot& slot)>;

class ObjectParameters {
 public:
  /// Reports parameters that the effect has not, and values that do not fit their type.
  /// What neither the object gives nor a variation is the material's, if there is one and the effect calls it
  /// base_color (of 3 or 4 components), metallic, roughness, or as another of its members or textures; else the effect's own. Paths that the object gives
  /// count from the scene's folder. Asks for no texture of what no pass reads.
  static std::optional<ObjectParameters> resolve(const scene::Object& object, const driver::Effect& effect,
                                                 const scene::GltfMaterial* material,
                                                 const FindTexture& find_texture,
                                                 support::Diagnostics& diagnostics);

  /// The words of one copy, from object_word::parameters on. `record_of` tells where the texture of a number, or -1, is
  /// stored. Computed under lanes::FpGuard, which the caller holds.
  std::vector<float> words(const scene::Object& object, const scene::Instance& instance,
                           const std::function<int(int)>& record_of) const;

  int64_t word_count() const { return static_cast<int64_t>(common_.size() + images_.size()); }

 private:
  /// A variation, the axis along which it runs, and where its words go.
  struct Varying {
    size_t axis, variation;
    graph::Type type;
    std::vector<std::string> names;  ///< of an integer's values
    size_t first_word;
  };
  /// The same of an image: its textures along the axis.
  struct VaryingImage {
    size_t axis, image;
    std::vector<int> textures;
  };
  bool resolve_image(const scene::Object& object, const driver::Image& image,
                     const scene::GltfMaterial* material, const FindTexture& find_texture);

  std::vector<float> common_;  ///< of all copies
  std::vector<int> images_;    ///< of all copies: the number of each image's texture, or -1
  std::vector<VaryingImage> varying_images_;
  std::vector<Varying> varying_;
};

}  // namespace isoshade::render
