// SPDX-License-Identifier: Apache-2.0
// The values of a parameter block: what an object gives to its effect, or the scene to a post, as words of a record.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "compiler/driver/fixed.h"
#include "compiler/driver/parameter_block.h"
#include "runtime/render/textures.h"
#include "runtime/scene/model.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// Returns the number of the texture for an image of the block, or nothing if there is none, which is then reported.
using FindTexture =
    std::function<std::optional<int>(const ImageSource& source, const lower::ImageSlot& slot)>;

/// What gives values to a block: an object or a post of the scene.
struct ParameterGiver {
  std::string_view name;  ///< for messages
  std::span<const scene::Parameter> parameters;
  std::span<const scene::Repeat> repeat = {};
  const scene::Material* material = nullptr;
  support::Span material_where = {};  ///< what names the material's file
};

/// The values that a giver has for a block, found once for all copies of an object.
class ParameterValues {
 public:
  /// A field takes its value from the first of these that has one: the variations of the giver's grid, its parameters,
  /// its material (base_color of 3 or 4 components, metallic, roughness, and whatever else a material has under the
  /// field's name), the defaults of the document. Paths are relative to the document that gives them.
  /// Reports parameters that the block does not have, and values that do not fit their types or ranges. Looks up the
  /// textures of the block's images only, which are those that some pass reads.
  static std::optional<ParameterValues> resolve(const driver::ParameterBlock& block,
                                                const ParameterGiver& giver, const FindTexture& find_texture,
                                                support::Diagnostics& diagnostics);

  /// The record of one copy. `record_of` maps the number of a texture, or -1, to the number of its record. The caller
  /// holds lanes::FpGuard.
  std::vector<float> words(const scene::Instance& instance, const std::function<int(int)>& record_of) const;

  /// Calls use(image, texture) for each image of the block and the number of each texture that it is in some copy.
  template <class Use>
  void for_each_texture(const Use& use) const {
    for (size_t image = 0; image < images_.size(); ++image) {
      if (images_[image].texture >= 0) use(image, images_[image].texture);
      for (const int texture : images_[image].along_axis)
        if (texture >= 0) use(image, texture);
    }
  }

  /// Whether both have the same textures.
  bool has_images_of(const ParameterValues& other) const { return images_ == other.images_; }

  /// The greatest number that a word of the record has in any copy; of no image.
  float most(size_t word) const;

  /// The words that are the same in all copies; of an image only that there is none.
  driver::FixedWords common() const;

  int64_t word_count() const { return static_cast<int64_t>(common_.size()); }

 private:
  class Resolver;

  /// A field that varies along an axis of the grid.
  struct Varying {
    size_t axis;
    int64_t count;  ///< of copies along the axis
    scene::Variation variation;
    graph::Type type;
    std::vector<std::string> names;  ///< of an integer's values
    size_t first_word;
  };
  struct ImageWord {
    int texture = -1;             ///< of all copies, if `along_axis` is empty
    size_t axis = 0;              ///< of the grid
    std::vector<int> along_axis;  ///< the textures along the axis
    bool operator==(const ImageWord&) const = default;
  };

  std::vector<float> common_;  ///< the record, but for what varies and for the images
  std::vector<Varying> varying_;
  std::vector<ImageWord> images_;
  size_t first_image_word_ = 0;
};

}  // namespace isoshade::render
