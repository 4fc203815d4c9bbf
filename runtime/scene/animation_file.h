// SPDX-License-Identifier: Apache-2.0
// Files of several pictures that are shown one after the other: APNG and GIF.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::scene {

enum class AnimationFormat : uint8_t { apng, gif };
/// By the path's ending: .apng or .gif. Nothing of another one.
std::optional<AnimationFormat> animation_format_of(const std::string& path);

/// Collects pictures of one size, and is shown again and again. An APNG has all colours of a PNG. A GIF has 252, of which
/// an ordered dither mixes the others, the same way in each picture; what covers less than half is transparent.
class AnimationFile {
 public:
  /// `seconds`: how long each picture is shown. `threads`: 0 for one for each core; the file does not depend on it.
  AnimationFile(AnimationFormat format, int width, int height, double seconds, int threads = 0);
  ~AnimationFile();
  /// 4 bytes a pixel, with straight alpha, as png().
  void add(std::span<const uint8_t> rgba);
  /// The bytes of the file. Call it once, after at least one picture.
  std::string finish();

 private:
  class Gif;
  AnimationFormat format_;
  int width_, height_;
  double seconds_;
  int threads_;
  std::vector<std::vector<std::string>> pictures_;  ///< as png_data gives them
  std::unique_ptr<Gif> gif_;
};

}  // namespace isoshade::scene
