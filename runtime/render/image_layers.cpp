// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/image_layers.h"

#include <algorithm>
#include <span>

#include "compiler/support/visible.h"

namespace isoshade::render {
namespace {

using scene::FileImage;
using scene::ImageHeader;
using support::Diagnostics;
using support::Id;
using support::quote;

/// Of the files of an image document, which all stay in memory until they are decoded.
constexpr size_t most_file_bytes = size_t{1} << 30;

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

/// The part of an image between two rows.
FileImage rows(const FileImage& image, int first, int count) {
  FileImage part;
  part.width = image.width;
  part.height = count;
  const auto copy = [&]<class T>(const std::vector<T>& from, std::vector<T>& to, int per_pixel) {
    const auto row = static_cast<std::ptrdiff_t>(image.width) * per_pixel;
    if (!from.empty()) to.assign(from.begin() + first * row, from.begin() + (first + count) * row);
  };
  copy(image.bytes, part.bytes, 1);
  copy(image.rgba, part.rgba, 4);
  return part;
}

}  // namespace

std::optional<LayeredImage::File> LayeredImage::open_file(const ImageSource& source, Diagnostics& diagnostics) {
  std::shared_ptr<const std::string> bytes = source.bytes;
  if (bytes == nullptr) {
    auto read = scene::read_image_file(source.path, diagnostics, source.where);
    if (!read) return std::nullopt;
    bytes = std::make_shared<const std::string>(*std::move(read));
  }
  const auto header = scene::read_header(source.path, *bytes, diagnostics, source.where);
  if (!header) return std::nullopt;
  return File{source.path, source.where, std::move(bytes), *header};
}

std::optional<LayeredImage> LayeredImage::open(const ImageSource& source, const graph::FileRule* rule,
                                               Diagnostics& diagnostics) {
  LayeredImage image;
  if (source.bytes != nullptr || !graph::is_image_document(source.path)) {
    auto file = open_file(source, diagnostics);
    if (!file) return std::nullopt;
    image.shape_.header = file->header;
    image.layers_.push_back({{*std::move(file)}, 1});
    return image;
  }
  const graph::FileRule any{"", true};
  const graph::FileRule& files = rule != nullptr ? *rule : any;
  const auto document = graph::read_image_document(source.path, files, diagnostics, source.where);
  if (!document) return std::nullopt;
  size_t bytes = 0;
  for (const graph::ImageLayers& layers : document->layers) {
    Layers& made = image.layers_.emplace_back();
    made.count = layers.count;
    for (const graph::ImageFile& named : layers.levels) {
      if (!graph::may_read(named.path, named.where, files, diagnostics)) return std::nullopt;
      auto file = open_file({named.path, nullptr, named.where}, diagnostics);
      if (!file) return std::nullopt;
      bytes += file->bytes->size();
      if (bytes > most_file_bytes) {
        diagnostics.report(Id::too_large, named.where,
                           "with " + quote(named.path) + " the files of the image have more than " +
                               std::to_string(most_file_bytes) + " bytes")
            .suggest("use smaller files");
        return std::nullopt;
      }
      made.levels.push_back(*std::move(file));
    }
  }
  if (!image.check(diagnostics)) return std::nullopt;
  return image;
}

/// Whether the files fit each other; finds the shape.
bool LayeredImage::check(Diagnostics& diagnostics) {
  const File& first = layers_.front().levels.front();
  shape_.header = first.header;
  shape_.header.height /= layers_.front().count;
  shape_.layers = 0;
  for (const Layers& layers : layers_) {
    shape_.layers += layers.count;
    for (size_t level = 0; level < layers.levels.size(); ++level) {
      const File& file = layers.levels[level];
      const int width = std::max(1, shape_.header.width >> level), height = std::max(1, shape_.header.height >> level);
      if (file.header.width != width || file.header.height != height * layers.count) {
        diagnostics
            .report(Id::bad_image, file.where,
                    "the image " + quote(file.name) + " is " + size_text(file.header.width, file.header.height) +
                        "; as level " + std::to_string(level) + " of " + std::to_string(layers.count) +
                        (layers.count == 1 ? " layer" : " layers") + " it must be " +
                        size_text(width, height * layers.count))
            .note(first.where, "a layer has the size that this file gives the first");
        return false;
      }
      if (file.header.bytes != first.header.bytes || file.header.integers != first.header.integers) {
        diagnostics
            .report(Id::bad_image, file.where,
                    "the image " + quote(file.name) + " has another number of bits per channel than " + quote(first.name))
            .note("all files of an image have 8 bits per channel, or all have 16 or floats");
        return false;
      }
      if (width == 1 && height == 1 && level + 1 < layers.levels.size()) {
        diagnostics.report(Id::bad_image, layers.levels[level + 1].where, "no level is smaller than 1 x 1")
            .suggest("remove this file and those after it");
        return false;
      }
    }
  }
  return true;
}

size_t LayeredImage::file_bytes() const {
  size_t bytes = 0;
  for (const Layers& layers : layers_)
    for (const File& file : layers.levels) bytes += file.bytes->size();
  return bytes;
}

std::optional<std::vector<std::vector<FileImage>>> LayeredImage::decode(bool smaller,
                                                                        Diagnostics& diagnostics) const {
  std::vector<std::vector<FileImage>> all;
  for (const Layers& layers : layers_) {
    const size_t first = all.size();
    all.resize(first + static_cast<size_t>(layers.count));
    for (const File& file : std::span(layers.levels).first(smaller ? layers.levels.size() : 1)) {
      auto image = scene::read_image(file.name, *file.bytes, diagnostics, file.where);
      if (!image) return std::nullopt;
      if (layers.count == 1) {
        all[first].push_back(*std::move(image));
        continue;
      }
      const int height = image->height / layers.count;
      for (int i = 0; i < layers.count; ++i) all[first + static_cast<size_t>(i)].push_back(rows(*image, i * height, height));
    }
  }
  return all;
}

}  // namespace isoshade::render
