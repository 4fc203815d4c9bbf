// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/encode.h"

#include <algorithm>

#include "runtime/raster/tile.h"
#include "runtime/threads/workers.h"

namespace isoshade::scene {

std::vector<uint8_t> encode(std::span<const float> rgba, Encoding encoding, float exposure, Alpha alpha, int threads) {
  std::vector<uint8_t> bytes(rgba.size());
  constexpr size_t pixels_at_once = 16384;
  const size_t pixels = rgba.size() / 4;
  threads::Workers(threads).for_each((pixels + pixels_at_once - 1) / pixels_at_once, [&](size_t part) {
    const size_t first = part * pixels_at_once;
    const detail::EncodeJob job{&rgba[4 * first],
                                &bytes[4 * first],
                                std::min(pixels_at_once, pixels - first),
                                exposure,
                                encoding == Encoding::srgb,
                                alpha == Alpha::straight};
    switch (raster::rasterizer_lanes()) {
      case 16: return detail::encode_16(job);
      case 8: return detail::encode_8(job);
      default: return detail::encode_4(job);
    }
  });
  return bytes;
}

}  // namespace isoshade::scene
