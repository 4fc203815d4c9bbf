// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/textures.h"

#include <algorithm>
#include <bit>

#include "compiler/graph/files.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"

namespace isoshade::render {
namespace {

/// The number of texels of a texture of this size, with or without mip levels.
int64_t texel_count(const scene::ImageHeader& header, bool mips) {
  int64_t width = header.width, height = header.height, count = width * height;
  while (mips && (width > 1 || height > 1)) {
    width = std::max<int64_t>(1, width / 2);
    height = std::max<int64_t>(1, height / 2);
    count += width * height;
  }
  return count;
}

int64_t bytes_of(const scene::ImageHeader& header, bool mips) {
  return texel_count(header, mips) * (header.bytes ? 4 : 16);
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

int64_t TextureStore::Texture::texel_count() const { return render::texel_count(header, mips); }
int64_t TextureStore::Texture::bytes() const { return bytes_of(header, mips); }

backends::Largest TextureStore::Texture::described() const {
  return {"the image " + support::quote(source.path) + ", " + std::to_string(header.width) + " x " +
              std::to_string(header.height) + (mips ? " with mip levels: " : ": ") + std::to_string(bytes()) +
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
  if (const auto read = headers_.find(canonical); read != headers_.end()) {
    const auto known = numbers_.find({canonical, is_srgb(decoding, source, read->second)});
    if (known != numbers_.end()) {
      Texture& texture = textures_[static_cast<size_t>(known->second)];
      if (mips && !texture.mips) {
        const int64_t more = bytes_of(texture.header, true) - texture.bytes();
        if (!fits(more, false, source, diagnostics)) return std::nullopt;
        texture.mips = true;
      }
      return known->second;
    }
  }
  std::optional<std::string> file;
  if (source.bytes == nullptr) file = scene::read_image_file(source.path, diagnostics, source.where);
  if (source.bytes == nullptr && !file) return std::nullopt;
  const std::string_view bytes = file ? *file : *source.bytes;
  const auto header = scene::read_header(source.path, bytes, diagnostics, source.where);
  if (!header || !fits(bytes_of(*header, mips), true, source, diagnostics)) return std::nullopt;
  auto image = scene::read_image(source.path, bytes, diagnostics, source.where);
  if (!image) return std::nullopt;
  const bool srgb = is_srgb(decoding, source, *header);
  const auto number = static_cast<int>(textures_.size());
  headers_[canonical] = *header;
  numbers_[{canonical, srgb}] = number;
  Texture& texture = textures_.emplace_back(Texture{source, srgb, mips, *header, {}});
  if (header->bytes)
    texture.largest = scene::ByteLevel{image->width, image->height, std::move(image->bytes)};
  else
    texture.largest = scene::linear_level(*std::move(image), srgb);
  return number;
}

namespace {

namespace word = lower::texture_word;

/// Adds the record of a level whose texels will come after those that are stored.
void add_record(size_t first, int width, int height, int smaller, int table, backends::Frame& frame) {
  int32_t record[word::stride];
  record[word::first] = static_cast<int32_t>(first);
  record[word::width] = width;
  record[word::height] = height;
  record[word::smaller] = smaller;
  record[word::table] = table;
  frame.textures.insert(frame.textures.end(), std::begin(record), std::end(record));
}

void add_level(const scene::ByteLevel& level, bool srgb, int smaller, backends::Frame& frame) {
  const int table = srgb ? lower::byte_table::srgb : lower::byte_table::linear;
  add_record(frame.texel_bytes.size(), level.width, level.height, smaller, table, frame);
  frame.texel_bytes.insert(frame.texel_bytes.end(), level.texels.begin(), level.texels.end());
}

void add_level(const scene::TextureLevel& level, int smaller, backends::Frame& frame) {
  add_record(frame.texels.size(), level.width, level.height, smaller, -1, frame);
  frame.texels.insert(frame.texels.end(), level.texels.begin(), level.texels.end());
}

int smaller_levels(const scene::ImageHeader& header) {
  return std::bit_width(static_cast<unsigned>(std::max(header.width, header.height))) - 1;
}

}  // namespace

int append_levels(const std::vector<scene::TextureLevel>& levels, backends::Frame& frame) {
  const auto first = static_cast<int>(frame.textures.size() / word::stride);
  for (size_t i = 0; i < levels.size(); ++i) add_level(levels[i], 0, frame);
  return first;
}

void TextureStore::store(backends::Frame& frame) {
  size_t byte_words = 0, float_words = 0;
  for (const Texture& texture : textures_)
    (texture.header.bytes ? byte_words : float_words) += static_cast<size_t>(texture.bytes()) / 4;
  frame.texel_bytes.reserve(1 + byte_words);
  if (!textures_.empty()) frame.texel_bytes.push_back(0);
  frame.texels.reserve(2 * lower::byte_table::size + float_words);
  if (byte_words > 0) {
    for (const bool srgb : {false, true})
      frame.texels.insert(frame.texels.end(), scene::byte_table(srgb).begin(), scene::byte_table(srgb).end());
  }
  for (Texture& texture : textures_) {
    records_.push_back(static_cast<int>(frame.textures.size() / word::stride));
    int smaller = texture.mips ? smaller_levels(texture.header) : 0;
    scene::TextureLevel next;
    if (const auto* bytes = std::get_if<scene::ByteLevel>(&texture.largest)) {
      add_level(*bytes, texture.srgb, smaller, frame);
      if (smaller > 0) next = scene::half_size(*bytes, texture.srgb);
    } else {
      next = std::get<scene::TextureLevel>(std::move(texture.largest));
      add_level(next, smaller, frame);
      if (smaller > 0) next = scene::half_size(next);
    }
    texture.largest = scene::ByteLevel{};
    // Each level of bytes is computed from floats before they are rounded to bytes, so that errors do not accumulate.
    while (smaller-- > 0) {
      if (texture.header.bytes)
        add_level(scene::byte_level(next, texture.srgb), texture.srgb, smaller, frame);
      else
        add_level(next, smaller, frame);
      if (smaller > 0) next = scene::half_size(next);
    }
  }
  const Texture* largest[] = {nullptr, nullptr};
  for (const Texture& texture : textures_) {
    const Texture*& known = largest[texture.header.bytes ? 1 : 0];
    if (known == nullptr || texture.bytes() > known->bytes()) known = &texture;
  }
  if (largest[0] != nullptr) frame.largest_in_texels = largest[0]->described();
  if (largest[1] != nullptr) frame.largest_in_texel_bytes = largest[1]->described();
}

}  // namespace isoshade::render
