// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/textures.h"

#include <algorithm>

#include "compiler/graph/files.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"

namespace isoshade::render {
namespace {

/// Of a texture of this size, with its mip levels or without.
int64_t texel_count(int width, int height, bool mips) {
  int64_t count = int64_t{width} * height;
  while (mips && (width > 1 || height > 1)) {
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    count += int64_t{width} * height;
  }
  return count;
}

bool is_srgb(lower::Decoding decoding, bool bytes) {
  return decoding == lower::Decoding::srgb || (decoding == lower::Decoding::srgb_if_bytes && bytes);
}

}  // namespace

std::vector<Skip> unread_images(const std::vector<driver::Effect>& effects) {
  std::vector<Skip> skips;
  for (const driver::Effect& effect : effects) {
    for (const driver::Field& field : effect.parameters) {
      const bool read = std::ranges::any_of(
          effect.images, [&](const driver::Image& image) { return image.slot.parameter == field.name; });
      if (field.type == graph::type_name(graph::Type::filename) && !read)
        skips.push_back(
            {"the images of " + field.name + " of the effect " + effect.name, "no pass reads them"});
    }
  }
  return skips;
}

bool TextureStore::fits(int64_t texels, const std::string& path, const support::Span& where,
                        support::Diagnostics& diagnostics) {
  for (const Texture& texture : textures_)
    texels += texel_count(texture.largest.width, texture.largest.height, texture.mips);
  if (texels <= max_texels && textures_.size() < max_textures) return true;
  diagnostics
      .report(support::Id::too_large, where,
              "with the image " + support::quote(path) + " the scene has more than " +
                  (texels <= max_texels ? std::to_string(max_textures) + " textures"
                                        : std::to_string(max_texels) + " texels"))
      .suggest("use smaller images");
  return false;
}

std::optional<int> TextureStore::find(const ImageSource& source, lower::Decoding decoding, bool mips,
                                      support::Diagnostics& diagnostics) {
  const auto& [path, bytes, where] = source;
  const std::string canonical = graph::canonical_path(path);
  if (const auto read = has_bytes_.find(canonical); read != has_bytes_.end()) {
    const auto known = numbers_.find({canonical, is_srgb(decoding, read->second)});
    if (known != numbers_.end()) {
      Texture& texture = textures_[static_cast<size_t>(known->second)];
      const scene::TextureLevel& largest = texture.largest;
      if (mips && !texture.mips) {
        const int64_t more = texel_count(largest.width, largest.height, true) -
                             texel_count(largest.width, largest.height, false);
        if (!fits(more, path, where, diagnostics)) return std::nullopt;
        texture.mips = true;
      }
      return known->second;
    }
  }
  const std::optional<scene::FloatImage> image = bytes != nullptr
                                                     ? scene::read_image(path, *bytes, diagnostics, where)
                                                     : scene::read_image(path, diagnostics, where);
  if (!image || !fits(texel_count(image->width, image->height, mips), path, where, diagnostics))
    return std::nullopt;
  has_bytes_[canonical] = image->bytes;
  const bool srgb = is_srgb(decoding, image->bytes);
  const auto number = static_cast<int>(textures_.size());
  numbers_[{canonical, srgb}] = number;
  textures_.push_back({canonical, srgb, mips, scene::linear_level(*image, srgb)});
  return number;
}

void TextureStore::store(backends::Frame& frame) {
  namespace word = lower::texture_word;
  for (Texture& texture : textures_) {
    records_.push_back(static_cast<int>(frame.textures.size() / word::stride));
    std::vector<scene::TextureLevel> levels;
    levels.push_back(std::move(texture.largest));
    while (texture.mips && (levels.back().width > 1 || levels.back().height > 1))
      levels.push_back(scene::half_size(levels.back()));
    for (size_t i = 0; i < levels.size(); ++i) {
      int32_t record[word::stride];
      record[word::first] = static_cast<int32_t>(frame.texels.size());
      record[word::width] = levels[i].width;
      record[word::height] = levels[i].height;
      record[word::smaller] = static_cast<int32_t>(levels.size() - 1 - i);
      frame.textures.insert(frame.textures.end(), std::begin(record), std::end(record));
      frame.texels.insert(frame.texels.end(), levels[i].texels.begin(), levels[i].texels.end());
    }
  }
}

}  // namespace isoshade::render
