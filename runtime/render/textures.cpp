// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/textures.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <iterator>
#include <type_traits>

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

/// Of files that wait to be decoded together.
constexpr size_t most_waiting_bytes = size_t{1} << 28;

bool is_srgb(lower::Decoding decoding, const ImageSource& source, const scene::ImageHeader& header) {
  const bool by_itself = header.bytes || (source.srgb && header.integers);
  return decoding == lower::Decoding::srgb || (decoding == lower::Decoding::srgb_if_bytes && by_itself);
}

}  // namespace

std::vector<Skipped> unread_images(const std::vector<driver::Effect>& effects) {
  std::vector<Skipped> skips;
  for (const driver::Effect& effect : effects) {
    for (const driver::Field& field : effect.parameters.fields) {
      const bool read = std::ranges::any_of(effect.parameters.images, [&](const driver::Image& image) {
        return image.slot.parameter == field.name;
      });
      if (field.type != graph::type_name(graph::Type::filename) || read) continue;
      // An effect that is compiled several times is one to its readers.
      const std::string what = "the images of " + field.name + " of the effect " + effect.name;
      if (std::ranges::find(skips, what, &Skipped::what) == skips.end()) skips.push_back({{}, what, "no pass reads them"});
    }
  }
  return skips;
}

int64_t TextureStore::Texture::texel_count() const {
  return part.texels ? render::texel_count(shape, stores_mips()) : 0;
}
int64_t TextureStore::Texture::bytes() const { return part.texels ? bytes_of(shape, stores_mips()) : 0; }

backends::Largest TextureStore::Texture::described() const {
  return {"the image " + support::quote(source.path) + ", " + std::to_string(shape.header.width) + " x " +
              std::to_string(shape.header.height) +
              (shape.layers > 1 ? ", " + std::to_string(shape.layers) + " layers" : "") +
              (stores_mips() ? " with mip levels: " : ": ") + std::to_string(bytes()) + " bytes",
          source.where};
}

int64_t TextureStore::count() const {
  return std::ranges::count_if(textures_, [](const Texture& texture) { return texture.part.texels; });
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
        if (is_stored_) return std::nullopt;
        const int64_t more = bytes_of(texture.shape, true) - texture.bytes();
        if (!fits(more, false, source, diagnostics)) return std::nullopt;
        texture.mips = true;
      }
      return known->second;
    }
  }
  if (is_stored_) return std::nullopt;
  auto image = LayeredImage::open(source, rule_, diagnostics);
  if (!image || !fits(bytes_of(image->shape(), mips), true, source, diagnostics)) return std::nullopt;
  const ImageShape shape = image->shape();
  const bool srgb = is_srgb(decoding, source, shape.header);
  const auto number = static_cast<int>(textures_.size());
  shapes_[canonical] = shape;
  numbers_[{canonical, srgb}] = number;
  const Texture& texture =
      textures_.emplace_back(Texture{source, srgb, mips, shape, std::move(image), {}, {}});
  // The files wait in memory until it is known which images programs read. When they are too many, all are decoded.
  waiting_bytes_ += texture.image->file_bytes();
  if (waiting_bytes_ > most_waiting_bytes && !decode_all(diagnostics)) return std::nullopt;
  return number;
}

int64_t TextureStore::store_only(int number, Part part) {
  Texture& texture = textures_[static_cast<size_t>(number)];
  const int64_t before = texture.bytes();
  texture.part = part;
  if (!part.texels) {
    texture.image.reset();
    texture.layers.clear();
  }
  return before - texture.bytes();
}

bool TextureStore::Texture::decode(support::Diagnostics& diagnostics) {
  auto decoded = image->decode(part.levels, diagnostics);
  image.reset();
  if (!decoded) return false;
  for (std::vector<scene::FileImage>& layer : *decoded) {
    Levels& levels = layers.emplace_back();
    for (scene::FileImage& level : layer) {
      if (shape.header.bytes)
        levels.emplace_back(scene::ByteLevel{level.width, level.height, std::move(level.bytes)});
      else
        levels.emplace_back(scene::linear_level(std::move(level), srgb));
    }
  }
  return true;
}

bool TextureStore::decode_all(support::Diagnostics& diagnostics) {
  std::vector<Texture*> waiting;
  for (Texture& texture : textures_)
    if (texture.image && texture.shape.header.bytes) waiting.push_back(&texture);
  waiting_bytes_ = 0;
  std::vector<support::Diagnostics> reports(waiting.size());
  std::atomic<bool> good = true;
  workers_.for_each(waiting.size(), [&](size_t i) {
    if (!waiting[i]->decode(reports[i])) good = false;
  });
  for (const support::Diagnostics& report : reports) {
    for (const support::Diagnostic& one : report.all()) {
      support::Diagnostic& added = diagnostics.report(one.id, one.where, one.message);
      added.notes = one.notes;
      added.fix = one.fix;
    }
  }
  // Here, because decoding computes floats in the mode of this thread.
  for (Texture& texture : textures_)
    if (texture.image && !texture.decode(diagnostics)) good = false;
  return good;
}

int TextureStore::Texture::smaller_levels() const {
  const auto side = static_cast<unsigned>(std::max(shape.header.width, shape.header.height));
  return stores_mips() ? std::bit_width(side) - 1 : 0;
}

namespace {

namespace word = lower::texture_word;

/// What the record of a level says beside its size.
struct Follow {
  int smaller = 0;  ///< levels after it
  int layers = 1;
};

/// Adds the record of a level. `table`: of bytes; -1 for floats.
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

/// Writes the texels of a level, and returns where those of the next one belong.
uint32_t* write_level(const scene::ByteLevel& level, uint32_t* to) { return std::ranges::copy(level.texels, to).out; }
float* write_level(const scene::TextureLevel& level, float* to) { return std::ranges::copy(level.texels, to).out; }

}  // namespace

int append_levels(const std::vector<scene::TextureLevel>& levels, backends::Frame& frame) {
  const auto first = static_cast<int>(frame.textures.size() / word::stride);
  size_t floats = frame.texels.size();
  for (const scene::TextureLevel& level : levels) floats += level.texels.size();
  frame.texels.reserve(floats);
  for (const scene::TextureLevel& level : levels) {
    add_record(frame.texels.size(), level.width, level.height, {}, -1, frame);
    frame.texels.insert(frame.texels.end(), level.texels.begin(), level.texels.end());
  }
  return first;
}

bool TextureStore::store(backends::Frame& frame, support::Diagnostics& diagnostics) {
  if (!decode_all(diagnostics)) return false;
  is_stored_ = true;
  const bool has_bytes = std::ranges::any_of(
      textures_, [](const Texture& texture) { return texture.part.texels && texture.shape.header.bytes; });
  size_t bytes = count() == 0 ? 0 : 1, floats = has_bytes ? 2 * lower::byte_table::size : 0;
  struct Job {
    Texture* texture;
    size_t layer, first;  ///< word
  };
  std::vector<Job> jobs;
  for (Texture& texture : textures_) {
    records_.push_back(texture.part.texels ? static_cast<int>(frame.textures.size() / word::stride) : -1);
    if (!texture.part.texels) continue;
    const scene::ImageHeader& header = texture.shape.header;
    const int smaller = texture.smaller_levels();
    const int table = texture.srgb ? lower::byte_table::srgb : lower::byte_table::linear;
    for (size_t layer = 0; layer < texture.layers.size(); ++layer) {
      size_t& next = header.bytes ? bytes : floats;
      jobs.push_back({&texture, layer, next});
      for (int level = 0; level <= smaller; ++level) {
        const int width = std::max(1, header.width >> level), height = std::max(1, header.height >> level);
        add_record(next, width, height, {smaller - level, texture.shape.layers}, header.bytes ? table : -1, frame);
        next += static_cast<size_t>(width) * static_cast<size_t>(height) * (header.bytes ? 1 : 4);
      }
    }
  }
  frame.texel_bytes.resize(bytes);
  frame.texels.resize(floats);
  if (has_bytes) {
    float* to = frame.texels.data();
    for (const bool srgb : {false, true}) to = std::ranges::copy(scene::byte_table(srgb), to).out;
  }
  workers_.for_each(jobs.size(), [&](size_t j) {
    const Job& job = jobs[j];
    Levels levels = std::exchange(job.texture->layers[job.layer], {});
    if (job.texture->shape.header.bytes)
      store_layer(*job.texture, std::move(levels), frame.texel_bytes.data() + job.first);
    else
      store_layer(*job.texture, std::move(levels), frame.texels.data() + job.first);
  });
  const Texture* largest[] = {nullptr, nullptr};
  for (const Texture& texture : textures_) {
    if (!texture.part.texels) continue;
    const Texture*& known = largest[texture.shape.header.bytes ? 1 : 0];
    if (known == nullptr || texture.bytes() > known->bytes()) known = &texture;
  }
  if (largest[0] != nullptr) frame.largest_in_texels = largest[0]->described();
  if (largest[1] != nullptr) frame.largest_in_texel_bytes = largest[1]->described();
  return true;
}

/// Writes the levels of files, then those that are computed from the last of them.
template <class Word>
void TextureStore::store_layer(const Texture& texture, Levels levels, Word* to) const {
  using Level = std::conditional_t<std::is_same_v<Word, float>, scene::TextureLevel, scene::ByteLevel>;
  constexpr bool is_float = std::is_same_v<Word, float>;
  int smaller = texture.smaller_levels();
  scene::TextureLevel next;
  for (size_t i = 0; i < levels.size(); ++i) {
    const auto& level = std::get<Level>(levels[i]);
    to = write_level(level, to);
    const bool is_last = i + 1 == levels.size();
    if (is_last && smaller > 0) {
      if constexpr (is_float)
        next = scene::half_size(level, &workers_);
      else
        next = scene::half_size(level, texture.srgb, &workers_);
    }
    levels[i] = scene::ByteLevel{};
    if (is_last || smaller == 0) break;
    --smaller;
  }
  // Each level of bytes is computed from floats before they are rounded to bytes, so that errors do not accumulate.
  while (smaller-- > 0) {
    if constexpr (is_float)
      to = write_level(next, to);
    else
      to = write_level(scene::byte_level(next, texture.srgb), to);
    if (smaller > 0) next = scene::half_size(next, &workers_);
  }
}

}  // namespace isoshade::render
