// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/texture.h"

#include <algorithm>
#include <array>
#include <limits>

#include "compiler/functions/color.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

constexpr size_t channels = 4;

float finite(float x) {
  constexpr float most = std::numeric_limits<float>::max();
  if (!(x == x)) return 0.0f;
  return canonical(std::clamp(x, -most, most));
}

/// The texels of a row or column that one of half as many covers: `first` and those after it.
struct Cover {
  size_t first;
  size_t count;
  std::array<float, 3> weights;
};

/// Of n texels to max(1, n / 2).
std::vector<Cover> covers(int n) {
  const int m = std::max(1, n / 2);
  std::vector<Cover> all;
  for (int i = 0; i < m; ++i) {
    const auto first = static_cast<size_t>(2 * i);
    const auto share = [&](int part) { return static_cast<float>(part) / static_cast<float>(n); };
    if (n == 1) {
      all.push_back({0, 1, {1, 0, 0}});
    } else if (n % 2 == 0) {
      all.push_back({first, 2, {0.5f, 0.5f, 0}});
    } else {
      all.push_back({first, 3, {share(m - i), share(m), share(i + 1)}});
    }
  }
  return all;
}

float weighted(const Cover& cover, const float* from, size_t step) {
  float sum = cover.weights[0] * from[0];
  for (size_t i = 1; i < cover.count; ++i) sum = sum + cover.weights[i] * from[i * step];
  return finite(sum);
}

}  // namespace

TextureLevel linear_level(const FloatImage& image, bool srgb) {
  const lanes::FpGuard guard;
  TextureLevel level{image.width, image.height, image.rgba};
  std::array<float, 256> decoded{};
  for (size_t byte = 0; byte < decoded.size(); ++byte)
    decoded[byte] = functions::srgb_decode(static_cast<float>(byte) / 255.0f);
  for (size_t i = 0; i < level.texels.size(); ++i) {
    float& value = level.texels[i];
    value = finite(value);
    if (!srgb || i % channels == 3) continue;
    // Of a byte over 255, the byte again.
    value = image.bytes ? decoded[static_cast<size_t>(value * 255.0f + 0.5f)]
                        : finite(functions::srgb_decode(value));
  }
  return level;
}

TextureLevel half_size(const TextureLevel& level) {
  const lanes::FpGuard guard;
  const std::vector<Cover> across = covers(level.width), down = covers(level.height);
  const size_t width = across.size(), row = channels * width;
  std::vector<float> narrow(row * static_cast<size_t>(level.height));
  for (size_t y = 0; y < static_cast<size_t>(level.height); ++y) {
    const float* from = &level.texels[y * channels * static_cast<size_t>(level.width)];
    for (size_t x = 0; x < width; ++x)
      for (size_t c = 0; c < channels; ++c)
        narrow[y * row + x * channels + c] =
            weighted(across[x], from + across[x].first * channels + c, channels);
  }
  TextureLevel half{static_cast<int>(width), static_cast<int>(down.size()),
                    std::vector<float>(row * down.size())};
  for (size_t y = 0; y < down.size(); ++y)
    for (size_t i = 0; i < row; ++i)
      half.texels[y * row + i] = weighted(down[y], &narrow[down[y].first * row + i], row);
  return half;
}

}  // namespace isoshade::scene
