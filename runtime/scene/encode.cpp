// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/encode.h"

#include "compiler/functions/color.h"

namespace isoshade::scene {
namespace {

uint8_t quantise(float x) {
  // NaN fails this comparison.
  const float clamped = x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f;
  return static_cast<uint8_t>(lanes::to_int(lanes::floor(clamped * 255.0f + 0.5f)));
}

}  // namespace

std::vector<uint8_t> encode(std::span<const float> rgba, Encoding encoding, float exposure) {
  std::vector<uint8_t> bytes(rgba.size());
  const lanes::FpGuard guard;
  for (size_t i = 0; i + 3 < rgba.size(); i += 4) {
    const float alpha = rgba[i + 3];
    const float divisor = alpha > 0.0f && alpha < 1.0f ? alpha : 1.0f;
    for (size_t c = i; c < i + 3; ++c) {
      const float color = rgba[c] * exposure / divisor;
      bytes[c] = quantise(encoding == Encoding::srgb ? functions::srgb_encode(color) : color);
    }
    bytes[i + 3] = quantise(alpha);
  }
  return bytes;
}

}  // namespace isoshade::scene
