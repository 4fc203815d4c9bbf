// SPDX-License-Identifier: Apache-2.0
#include <isoshade/runtime.h>

#include "compiler/api/boundary.h"
#include "runtime/compare/compare.h"
#include "runtime/scene/image_file.h"

namespace isoshade {
namespace {

/// Whether the arrays have the size that the image says. Posts and textures have no depth.
bool is_whole(const Image& image) {
  if (image.width < 0 || image.height < 0) return false;
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  return image.rgba.size() == 4 * pixels && image.depth.size() == pixels;
}

backends::Image copy_of(const Image& image) { return {image.width, image.height, image.rgba, image.depth}; }

}  // namespace

std::string hash_of(const Image& image) noexcept {
  struct Hash : Outcome {
    std::string hex;
  };
  return api::guarded<Hash>({}, [&](Hash& hash, support::Diagnostics&) {
           if (is_whole(image)) hash.hex = compare::image_hash(copy_of(image));
           return true;
         })
      .hex;
}

Outcome write_image(const std::string& path, const Image& image) noexcept {
  return api::guarded<Outcome>({}, [&](Outcome&, support::Diagnostics& diagnostics) {
    if (!is_whole(image) || image.width == 0 || image.height == 0) {
      diagnostics.report(support::Id::bad_image, "the arrays of the image do not have its size");
      return false;
    }
    const std::string file = path == "-" ? "./-" : path;
    const scene::ImageView view{image.width, image.height, image.rgba, image.depth};
    scene::WriteOptions options;
    options.encoding = image.srgb ? scene::Encoding::srgb : scene::Encoding::linear;
    options.exposure = image.exposure;
    return scene::write_image(file, view, options, diagnostics);
  });
}

Comparison compare_images(const Image& a, const Image& b) noexcept {
  struct Compared : Outcome {
    Comparison comparison;
  };
  return api::guarded<Compared>({}, [&](Compared& compared, support::Diagnostics&) {
           if (!is_whole(a) || !is_whole(b)) return true;
           const compare::Comparison found = compare::compare(copy_of(a), copy_of(b));
           Comparison& result = compared.comparison;
           result.same_size = found.same_size;
           result.pixels = found.pixels;
           result.differing = found.differing;
           result.largest_ulp = found.largest_ulp;
           if (found.first) result.first = {found.first->x, found.first->y, found.first->a, found.first->b};
           return true;
         })
      .comparison;
}

}  // namespace isoshade
