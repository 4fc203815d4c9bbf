// SPDX-License-Identifier: Apache-2.0
// Which images the programs of a scene still read once they are compiled for the values that it fixes.
#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/reads.h"
#include "compiler/support/visible.h"
#include "runtime/render/planner.h"

namespace isoshade::render {

namespace {

/// What all programs read of a texture, and what first names it.
struct Reads {
  bool texels = false, levels = false;
  bool mips = false;  ///< an effect may read smaller levels for some values of its parameters
  std::string user;
};

}  // namespace

void Planner::leave_out_images() {
  if (!skips(interface::Skip::textures)) return;
  std::vector<Reads> reads(textures_.found());
  std::vector<std::optional<std::vector<driver::ImageReads>>> of_effect(plan_.effects.size());
  for (size_t o = 0; o < parameters_.size(); ++o) {
    const size_t e = effect_of_object_[o];
    const driver::Effect& effect = plan_.effects[e];
    if (!of_effect[e]) of_effect[e] = driver::images_read(effect);
    for (const std::vector<PartValues>* values : {&parameters_, &parameters_before_})
      for (const ParameterValues& part : (*values)[o])
        part.for_each_texture([&](size_t image, int texture) {
          Reads& read = reads[static_cast<size_t>(texture)];
          const lower::ImageSlot& slot = effect.parameters.images[image].slot;
          read.texels |= (*of_effect[e])[image].any;
          read.levels |= slot.mips && (*of_effect[e])[image].levels;
          read.mips |= slot.mips;
          if (read.user.empty()) read.user = slot.name + " of " + effect.name;
        });
  }
  for (size_t i = 0; i < reads.size(); ++i) {
    const Reads& read = reads[i];
    const auto number = static_cast<int>(i);
    const int64_t saved = textures_.store_only(number, {read.texels, read.levels});
    if (read.texels && (read.levels || !read.mips)) continue;
    const std::string image = support::quote(textures_.name(number)) + " (" + read.user + ")";
    skipped_in_programs_.push_back({.skip = interface::Skip::textures,
                                    .what = (read.texels ? "mip levels of " : "texels of ") + image,
                                    .reason = "no program reads them",
                                    .of = image,
                                    .bytes = saved});
  }
}

}  // namespace isoshade::render
