// SPDX-License-Identifier: Apache-2.0
// The textures of a frame: each file read once, stored once for each way in which it is decoded.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/stats.h"
#include "runtime/scene/texture.h"

namespace isoshade::render {

/// Limits that keep hostile scenes harmless. A side is limited by scene::max_size.
inline constexpr int64_t max_texels = 96'000'000;  ///< 16 bytes each, of all textures with their mip levels
inline constexpr size_t max_textures = 4096;

/// Where an image comes from.
struct ImageSource {
  std::string path;                          ///< of its file, or what else it is called
  std::shared_ptr<const std::string> bytes;  ///< of the file, if it is none on the disk
  support::Span where;                       ///< what names it
};

/// The parameters of effects that name images which no pass reads.
std::vector<Skip> unread_images(const std::vector<driver::Effect>& effects);

class TextureStore {
 public:
  /// The number of the texture; it is `mips` for all who ask for it, if it is for one. Reports what is no image, or too
  /// large.
  std::optional<int> find(const ImageSource& source, lower::Decoding decoding, bool mips,
                          support::Diagnostics& diagnostics);

  /// Fills the frame's `texels` and `textures`, after the last find().
  void store(backends::Frame& frame);
  /// The record of a stored texture, by its number; -1 for -1.
  int record(int number) const { return number < 0 ? -1 : records_[static_cast<size_t>(number)]; }

  size_t count() const { return textures_.size(); }

 private:
  struct Texture {
    std::string path;  ///< canonical
    bool srgb;
    bool mips;
    scene::TextureLevel largest;
  };
  bool fits(int64_t texels, const std::string& path, const support::Span& where,
            support::Diagnostics& diagnostics);

  std::vector<Texture> textures_;
  std::map<std::pair<std::string, bool>, int> numbers_;  ///< by path and srgb
  std::map<std::string, bool> has_bytes_;                ///< by path, of files that were read
  std::vector<int> records_;
};

}  // namespace isoshade::render
