// SPDX-License-Identifier: Apache-2.0
// The parameters of an object as words of its record.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "runtime/scene/gltf.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// What an object gives to the parameters of its effect, found once for all of its copies.
class ObjectParameters {
 public:
  /// Reports parameters that the effect has not, and values that do not fit their type.
  /// What neither the object gives nor a variation is the material's, if there is one and the effect calls it
  /// base_color (of 3 or 4 components), metallic or roughness; else the effect's own.
  static std::optional<ObjectParameters> resolve(const scene::Object& object, const driver::Effect& effect,
                                                 const scene::GltfMaterial* material,
                                                 support::Diagnostics& diagnostics);

  /// The words of one copy, from object_word::parameters on. Computed under lanes::FpGuard, which the caller
  /// holds.
  std::vector<float> words(const scene::Object& object, const scene::Instance& instance) const;

  int64_t word_count() const { return static_cast<int64_t>(common_.size()); }

 private:
  /// A variation, the axis along which it runs, and where its words go.
  struct Varying {
    size_t axis, variation;
    graph::Type type;
    std::vector<std::string> names;  ///< of an integer's values
    size_t first_word;
  };
  std::vector<float> common_;  ///< of all copies
  std::vector<Varying> varying_;
};

}  // namespace isoshade::render
