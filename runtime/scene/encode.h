// SPDX-License-Identifier: Apache-2.0
// Linear floats to the bytes of an image file.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::scene {

enum class Encoding : uint8_t { srgb, linear };
inline constexpr std::string_view encoding_names[] = {"srgb", "linear"};

/// Rendered images have premultiplied alpha, PNG files have straight alpha, and others none.
enum class Alpha : uint8_t {
  straight,    ///< colours are divided by alpha where it is between 0 and 1
  over_black,  ///< colours stay, and all alphas become 255
};

/// Multiplies colours by `exposure`, divides them by alpha, encodes them (alpha stays linear), clamps to [0, 1] and
/// quantises to floor(255 x + 0.5). NaN becomes 0. `rgba` has 4 floats per pixel, the result 4 bytes. The result is the
/// same on every machine and for any number of threads; 0 threads: one for each core.
std::vector<uint8_t> encode(std::span<const float> rgba, Encoding encoding, float exposure,
                            Alpha alpha = Alpha::straight, int threads = 0);

namespace detail {

/// For some pixels. One function for each number of lanes; encode chooses one.
struct EncodeJob {
  const float* rgba;
  uint8_t* bytes;
  size_t pixels;
  float exposure;
  bool srgb, straight;
};
void encode_4(const EncodeJob& job);
void encode_8(const EncodeJob& job);
void encode_16(const EncodeJob& job);

}  // namespace detail

}  // namespace isoshade::scene
