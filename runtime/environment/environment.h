// SPDX-License-Identifier: Apache-2.0
// The environment of a scene, ready for a frame. Its maps are kept in the cache of compiled C++ (backends/cache.h), under a
// hash of all that they depend on.
#pragma once

#include <optional>
#include <string>

#include "compiler/check/library.h"
#include "runtime/environment/prefilter.h"
#include "runtime/scene/scene.h"

namespace isoshade::environment {

/// Of the floats of an image: 8192 x 4096 pixels. Checked before it is decompressed.
inline constexpr int64_t max_image_bytes = int64_t{1} << 29;

struct Options {
  check::Library* library = nullptr;  ///< that has the function of the sky; required
  /// A folder for the maps; empty: the usual one. Without a folder that can be used, nothing is kept.
  std::string cache;
  PrefilterOptions prefilter;
  /// Makes the map for a roughness of 0 alone. The others are black and have one texel: what reads them with a weight of 0
  /// gets the same bits.
  bool sharp_only = false;
};

struct Made {
  Maps maps;
  bool cached = false;  ///< they were found in the cache
};

/// Reports a file that is missing, damaged, too large or not an image. The caller has checked that the scene may read it.
std::optional<Made> make_environment(const scene::Environment& environment, const Options& options,
                                     support::Diagnostics& diagnostics);

}  // namespace isoshade::environment
