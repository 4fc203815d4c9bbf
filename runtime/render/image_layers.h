// SPDX-License-Identifier: Apache-2.0
// An image as effects name it: a file, or layers and mip levels of several files that an image document names.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/graph/image_document.h"
#include "runtime/scene/image_file.h"

namespace isoshade::render {

/// Where an image comes from.
struct ImageSource {
  std::string path;                          ///< of its file, or another name that identifies it
  std::shared_ptr<const std::string> bytes;  ///< of the image, if it is not a file on disk
  support::Span where;                       ///< the text that names it
  /// Whether integers that are read as a colour are sRGB, also those of 16 bits.
  bool srgb = false;
};

/// What is known of an image before it is decompressed.
struct ImageShape {
  scene::ImageHeader header;  ///< of the largest level of each layer
  int layers = 1;
};

/// The files of an image. All are of one form: 8 bits per channel, or floats.
class LayeredImage {
 public:
  /// Reads the files, not their pixels. Reports what is no image, what `rule` does not let an image document read, and
  /// files whose sizes or forms do not fit each other. `rule`: null for none.
  static std::optional<LayeredImage> open(const ImageSource& source, const graph::FileRule* rule,
                                          support::Diagnostics& diagnostics);

  const ImageShape& shape() const { return shape_; }
  /// Of all files together.
  size_t file_bytes() const;
  /// By layer: the levels that files hold, from the largest on; without `smaller` the largest alone. Reports damaged files.
  std::optional<std::vector<std::vector<scene::FileImage>>> decode(bool smaller,
                                                                   support::Diagnostics& diagnostics) const;

 private:
  struct File {
    std::string name;
    support::Span where;
    std::shared_ptr<const std::string> bytes;
    scene::ImageHeader header;
  };
  struct Layers {
    std::vector<File> levels;
    int count = 1;
  };
  static std::optional<File> open_file(const ImageSource& source, support::Diagnostics& diagnostics);
  bool check(support::Diagnostics& diagnostics);

  std::vector<Layers> layers_;
  ImageShape shape_;
};

}  // namespace isoshade::render
