// SPDX-License-Identifier: Apache-2.0
// The textures of a frame: each file is read once, and stored once for each decoding.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/image_layers.h"
#include "runtime/render/stats.h"
#include "runtime/scene/texture.h"
#include "runtime/threads/workers.h"

namespace isoshade::render {

/// Limits that keep hostile scenes harmless. A side is limited by scene::max_size.
/// Of all textures with their mip levels: 4 bytes per texel for files with at most 8 bits per channel, otherwise 16.
/// Checked before an image is decompressed.
inline constexpr int64_t max_texture_bytes = int64_t{3} << 29;
inline constexpr size_t max_textures = 4096;

/// The parameters of effects that name images which no pass reads.
std::vector<Skipped> unread_images(const std::vector<driver::Effect>& effects);

/// Appends levels as textures, each the record after the other; returns the record of the first. Call it after
/// TextureStore::store.
int append_levels(const std::vector<scene::TextureLevel>& levels, backends::Frame& frame);

class TextureStore {
 public:
  /// `rule`: which files image documents may name; null for any.
  TextureStore(const graph::FileRule* rule, threads::Workers& workers, int64_t most_bytes = max_texture_bytes)
      : rule_(rule), workers_(workers), most_bytes_(most_bytes) {}

  /// The number of the texture; it has mip levels if any caller passes `mips`. Reports what is not an image, or too
  /// large. After store() finds, and does not report, only what was found before.
  std::optional<int> find(const ImageSource& source, lower::Decoding decoding, bool mips,
                          support::Diagnostics& diagnostics);

  /// How many have been found; their numbers are those below.
  size_t found() const { return textures_.size(); }
  /// What is stored of a texture.
  struct Part {
    bool texels = true, levels = true;  ///< `levels`: the smaller mip levels, if it has them
  };
  /// Leaves the rest of a texture out: it need not be decoded. Returns the bytes that this saves. Call it before store().
  int64_t store_only(int number, Part part);
  /// What messages call the image.
  const std::string& name(int number) const { return textures_[static_cast<size_t>(number)].source.path; }

  /// Fills the texture buffers of the frame. Call it once; it releases the images. They are decoded only now, unless their
  /// files were too large to wait for it: those of bytes on all threads. Reports damaged ones.
  bool store(backends::Frame& frame, support::Diagnostics& diagnostics);
  /// The record of a texture, by its number; -1 for -1, and for what is not stored.
  int record(int number) const { return number < 0 ? -1 : records_[static_cast<size_t>(number)]; }

  // Of what is stored.
  int64_t count() const;
  int64_t texel_count() const;  ///< with mip levels

 private:
  /// Of a layer, from the largest on.
  using Levels = std::vector<std::variant<scene::ByteLevel, scene::TextureLevel>>;
  struct Texture {
    ImageSource source;  ///< of the first find()
    bool srgb;
    bool mips;
    ImageShape shape;
    std::optional<LayeredImage> image;  ///< until it is decoded
    Part part = {};                     ///< that is stored
    std::vector<Levels> layers;         ///< what the files have

    bool decode(support::Diagnostics& diagnostics);
    bool stores_mips() const { return mips && part.levels; }
    int smaller_levels() const;  ///< of each layer
    int64_t texel_count() const;
    int64_t bytes() const;
    backends::Largest described() const;
  };
  /// Decodes the images that are not yet decoded and will be stored.
  bool decode_all(support::Diagnostics& diagnostics);
  template <class Word>
  void store_layer(const Texture& texture, Levels levels, Word* to) const;
  /// Whether this many more bytes fit the limits, and one more texture if it is new.
  bool fits(int64_t bytes, bool is_new, const ImageSource& source, support::Diagnostics& diagnostics) const;

  const graph::FileRule* rule_;
  threads::Workers& workers_;
  int64_t most_bytes_;
  size_t waiting_bytes_ = 0;  ///< of the files of images that are not yet decoded
  bool is_stored_ = false;
  std::vector<Texture> textures_;
  std::map<std::pair<std::string, bool>, int> numbers_;  ///< by path and srgb
  std::map<std::string, ImageShape> shapes_;             ///< by path, of images that were read
  std::vector<int> records_;
};

}  // namespace isoshade::render
