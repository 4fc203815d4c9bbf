// SPDX-License-Identifier: Apache-2.0
// Documents of the kind `image`: images of several layers, or with mip levels of their own. Wherever a document names an
// image file, it may name one of these.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/graph/files.h"

namespace isoshade::graph {

inline constexpr int max_image_layers = 64;
inline constexpr int max_image_levels = 14;  ///< of 8192 x 8192: down to 1 x 1

/// An image file that a document names.
struct ImageFile {
  std::string path;
  support::Span where;
};

/// Layers from the same files.
struct ImageLayers {
  /// Of each mip level from the largest on, at least one; the levels after the last are computed.
  std::vector<ImageFile> levels;
  int count = 1;  ///< how many layers stand in each file, one below the other
};

struct ImageDocument {
  support::Source source;
  std::vector<ImageLayers> layers;  ///< at least one
};

/// Whether a path names such a document and not an image file: it ends in ".json".
bool is_image_document(std::string_view path);

/// Reads the document; not the files that it names, which may_read() may refuse. Reports what is wrong.
std::optional<ImageDocument> read_image_document(const std::string& path, const FileRule& files,
                                                 support::Diagnostics& diagnostics, const support::Span& where);

}  // namespace isoshade::graph
