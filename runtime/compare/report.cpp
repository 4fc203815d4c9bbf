// SPDX-License-Identifier: Apache-2.0
#include "runtime/compare/report.h"

#include <bit>
#include <filesystem>
#include <system_error>

#include "compiler/support/visible.h"
#include "runtime/scene/image_file.h"
#include "runtime/scene/output_file.h"

namespace isoshade::compare {
namespace {

scene::ImageView view(const backends::Image& image) {
  return {image.width, image.height, image.rgba, image.depth};
}

std::string report_text(const NamedImage& a, const NamedImage& b, const Comparison& comparison) {
  std::string text = describe(comparison, a.name, b.name) + "\n\n";
  for (const NamedImage* side : {&a, &b}) {
    text += side->name + ": " + side->description + "\n";
    text += "  " + std::to_string(side->image->width) + " x " + std::to_string(side->image->height) +
            ", sha256 " + image_hash(*side->image) + "\n";
  }
  if (comparison.same_size)
    text += "\ndifference.png: from yellow (pixels differ by 1 ULP) to red (by 2^31 ULP); grey: identical\n";
  return text;
}

}  // namespace

std::vector<uint8_t> heat_map(const backends::Image& a, const backends::Image& b,
                              std::span<const uint8_t> encoded_a) {
  std::vector<uint8_t> map;
  map.reserve(encoded_a.size());
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const uint8_t* pixel = &encoded_a[map.size()];
      const uint32_t distance = ulp_distance(pixel_at(a, x, y), pixel_at(b, x, y));
      if (distance == 0) {
        const auto grey = static_cast<uint8_t>((pixel[0] + 2 * pixel[1] + pixel[2]) / 16);
        map.insert(map.end(), {grey, grey, grey, 255});
      } else {
        const int octave = std::bit_width(distance) - 1;  // 0 to 31
        map.insert(map.end(), {255, static_cast<uint8_t>(255 - octave * 8), 0, 255});
      }
    }
  }
  return map;
}

bool write_report(const std::string& folder, const NamedImage& a, const NamedImage& b,
                  const Comparison& comparison, scene::Encoding encoding, float exposure,
                  support::Diagnostics& diagnostics) {
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error) {
    diagnostics.report(support::Id::unwritable_file,
                       "cannot create the folder " + support::quote(folder) + ": " + error.message());
    return false;
  }
  for (const NamedImage* side : {&a, &b}) {
    for (const char* ending : {".png", ".exr"}) {
      const std::string path = (root / (side->name + ending)).string();
      if (!scene::write_image(path, view(*side->image), {.encoding = encoding, .exposure = exposure}, diagnostics))
        return false;
    }
  }
  if (comparison.same_size) {
    const std::vector<uint8_t> encoded = scene::encode(a.image->rgba, encoding, exposure);
    const std::string bytes =
        scene::png(a.image->width, a.image->height, heat_map(*a.image, *b.image, encoded));
    if (!scene::write_file((root / "difference.png").string(), bytes, diagnostics)) return false;
  }
  return scene::write_file((root / "report.txt").string(), report_text(a, b, comparison), diagnostics);
}

}  // namespace isoshade::compare
