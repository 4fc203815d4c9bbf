// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/textures.h"

#include <algorithm>
#include <bit>

#include "compiler/graph/files.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"

namespace isoshade::render {
namespace {

/// The number of texels of a texture of this shape, with or without mip levels.
int64_t texel_count(const ImageShape& shape, bool mips) {
  int64_t width = shape.header.width, height = shape.header.height, count = width * height;
  while (mips && (width > 1 || height > 1)) {
    width = std::max<int64_t>(1, width / 2);
    height = std::max<int64_t>(1, height / 2);
    count += width * height;
  }
  return count * shape.layers;
}

int64_t bytes_of(const ImageShape& shape, bool mips) {
  return texel_count(shape, mips) * (shape.header.bytes ? 4 : 16);
}

bool is_srgb(lower::Decoding decoding, const ImageSource& source, const scene::ImageHeader& header) {
  const bool by_itself = header.bytes || (source.srgb && header.integers);
  return decoding == lower::Decoding::srgb || (decoding == lower::Decoding::srgb_if_bytes && by_itself);
}

}  // namespace

std::vector<Skip> unread_images(const std::vector<driver::Effect>& effects) {
  std::vector<Skip> skips;
  for (const driver::Effect& effect : effects) {
    for (const driver::Field& field : effect.parameters.fields) {
      const bool read = std::ranges::any_of(effect.parameters.images, [&](const driver::Image& image) {
        return image.slot.parameter == field.name;
      });
      if (field.type == graph::type_name(graph::Type::filename) && !read)
        skips.push_back(
            {"the images of " + field.name + " of the effect " + effect.name, "no pass reads them"});
    }
  }
  return skips;
}

int64_t TextureStore::Texture::texel_count() const { return render::texel_count(shape, mips); }
int64_t TextureStore::Texture::bytes() const { return bytes_of(shape, mips); }

backends::Largest TextureStore::Texture::described() const {
  return {"the image " + support::quote(source.path) + ", " + std::to_string(shape.header.width) + " x " +
              std::to_string(shape.header.height) +
              (shape.layers > 1 ? ", " + std::to_string(shape.layers) + " layers" : "") + (mips ? " with mip levels: " : ": ") + std::to_string(bytes()) +
              " bytes",
          source.where};
}

int64_t TextureStore::texel_count() const {
  int64_t count = 0;
  for (const Texture& texture : textures_) count += texture.texel_count();
  return count;
}

bool TextureStore::fits(int64_t bytes, bool is_new, const ImageSource& source,
                        support::Diagnostics& diagnostics) const {
  for (const Texture& texture : textures_) bytes += texture.bytes();
  std::string reason;
  if (bytes > most_bytes_)
    reason = "take " + std::to_string(bytes) + " bytes; at most " + std::to_string(most_bytes_);
  if (is_new && textures_.size() == max_textures) reason = "are more than " + std::to_string(max_textures);
  if (reason.empty()) return true;
  diagnostics
      .report(support::Id::too_large, source.where,
              "with the image " + support::quote(source.path) + " the textures of the scene " + reason)
      .suggest("use smaller images");
  return false;
}

std::optional<int> TextureStore::find(const ImageSource& source, lower::Decoding decoding, bool mips,
                                      support::Diagnostics& diagnostics) {
  const std::string canonical = graph::canonical_path(source.path);
  if (const auto read = shapes_.find(canonical); read != shapes_.end()) {
    const auto known = numbers_.find({canonical, is_srgb(decoding, source, read->second.header)});
    if (known != numbers_.end()) {
      Texture& texture = textures_[static_cast<size_t>(known->second)];
      if (mips && !texture.mips) {
        const int64_t more = bytes_of(texture.shape, true) - texture.bytes();
        if (!fits(more, false, source, diagnostics)) return std::nullopt;
        texture.mips = true;
      }
      return known->second;
    }
  }
  const auto image = LayeredImage::open(source, rule_, diagnostics);
  if (!image || !fits(bytes_of(image->shape(), mips), true, source, diagnostics)) return std::nullopt;
  auto layers = image->decode(diagnostics);
  if (!layers) return std::nullopt;
  const ImageShape& shape = image->shape();
  const bool srgb = is_srgb(decoding, source, shape.header);
  const auto number = static_cast<int>(textures_.size());
  shapes_[canonical] = shape;
  numbers_[{canonical, srgb}] = number;
  Texture& texture = textures_.emplace_back(Texture{source, srgb, mips, shape, {}});
  for (std::vector<scene::FileImage>& layer : *layers) {
    Levels& levels = texture.layers.emplace_back();
    for (scene::FileImage& level : layer) {
      if (shape.header.bytes)
        levels.emplace_back(scene::ByteLevel{level.width, level.height, std::move(level.bytes)});
      else
        levels.emplace_back(scene::linear_level(std::move(level), srgb));
    }
  }
  return number;
}

namespace {

namespace word = lower::texture_word;

/// What the record of a level says beside its size.
struct Follow {
  int smaller = 0;  ///< levels after it
  int layers = 1;
};

/// Adds the record of a level whose texels will come after those that are stored.
void add_record(size_t first, int width, int height, Follow follow, int table, backends::Frame& frame) {
  int32_t record[word::stride];
  record[word::first] = static_cast<int32_t>(first);
  record[word::width] = width;
  record[word::height] = height;
  record[word::smaller] = follow.smaller;
  record[word::layers] = follow.layers;
  record[word::table] = table;
  frame.textures.insert(frame.textures.end(), std::begin(record), std::end(record));
}

void add_level(const scene::ByteLevel& level, bool srgb, Follow follow, backends::Frame& frame) {
  const int table = srgb ? lower::byte_table::srgb : lower::byte_table::linear;
  add_record(frame.texel_bytes.size(), level.width, level.height, follow, table, frame);
  frame.texel_bytes.insert(frame.texel_bytes.end(), level.texels.begin(), level.texels.end());
}

void add_level(const scene::TextureLevel& level, Follow follow, backends::Frame& frame) {
  add_record(frame.texels.size(), level.width, level.height, follow, -1, frame);
  frame.texels.insert(frame.texels.end(), level.texels.begin(), level.texels.end());
}

int smaller_levels(const scene::ImageHeader& header) {
  return std::bit_width(static_cast<unsigned>(std::max(header.width, header.height))) - 1;
}

}  // namespace

int append_levels(const std::vector<scene::TextureLevel>& levels, backends::Frame& frame) {
  const auto first = static_cast<int>(frame.textures.size() / word::stride);
  for (size_t i = 0; i < levels.size(); ++i) add_level(levels[i], {}, frame);
  return first;
}

void TextureStore::store(backends::Frame& frame) {
  size_t byte_words = 0, float_words = 0;
  for (const Texture& texture : textures_)
    (texture.shape.header.bytes ? byte_words : float_words) += static_cast<size_t>(texture.bytes()) / 4;
  frame.texel_bytes.reserve(1 + byte_words);
  if (!textures_.empty()) frame.texel_bytes.push_back(0);
  frame.texels.reserve(2 * lower::byte_table::size + float_words);
  if (byte_words > 0) {
    for (const bool srgb : {false, true})
      frame.texels.insert(frame.texels.end(), scene::byte_table(srgb).begin(), scene::byte_table(srgb).end());
  }
  for (Texture& texture : textures_) {
    records_.push_back(static_cast<int>(frame.textures.size() / word::stride));
    for (Levels& levels : texture.layers) store_layer(texture, std::exchange(levels, {}), frame);
  }
  const Texture* largest[] = {nullptr, nullptr};
  for (const Texture& texture : textures_) {
    const Texture*& known = largest[texture.shape.header.bytes ? 1 : 0];
    if (known == nullptr || texture.bytes() > known->bytes()) known = &texture;
  }
  if (largest[0] != nullptr) frame.largest_in_texels = largest[0]->described();
  if (largest[1] != nullptr) frame.largest_in_texel_bytes = largest[1]->described();
}

/// Stores the levels of files, then those that are computed from the last of them.
void TextureStore::store_layer(const Texture& texture, Levels levels, backends::Frame& frame) const {
  Follow follow{texture.mips ? smaller_levels(texture.shape.header) : 0, texture.shape.layers};
  scene::TextureLevel next;
  for (size_t i = 0; i < levels.size(); ++i) {
    const bool is_last = i + 1 == levels.size() || follow.smaller == 0;
    const bool continues = is_last && follow.smaller > 0;
    if (const auto* bytes = std::get_if<scene::ByteLevel>(&levels[i])) {
      add_level(*bytes, texture.srgb, follow, frame);
      if (continues) next = scene::half_size(*bytes, texture.srgb);
    } else {
      const auto& floats = std::get<scene::TextureLevel>(levels[i]);
      add_level(floats, follow, frame);
      if (continues) next = scene::half_size(floats);
    }
    levels[i] = scene::ByteLevel{};
    if (is_last) break;
    --follow.smaller;
  }
  // Each level of bytes is computed from floats before they are rounded to bytes, so that errors do not accumulate.
  while (follow.smaller-- > 0) {
    if (texture.shape.header.bytes)
      add_level(scene::byte_level(next, texture.srgb), texture.srgb, follow, frame);
    else
      add_level(next, follow, frame);
    if (follow.smaller > 0) next = scene::half_size(next);
  }
}

}  // namespace isoshade::render
