// SPDX-License-Identifier: Apache-2.0
// Writes a folder that shows how two images differ.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "runtime/compare/compare.h"
#include "runtime/scene/encode.h"

namespace isoshade::compare {

struct NamedImage {
  std::string name;  ///< "cpu": the file name in the folder, without extension
  std::string description;
  const backends::Image* image = nullptr;
};

/// RGBA bytes: differing pixels are yellow (1 ULP) to red (2^31 ULP), on a logarithmic scale; the others show the image in
/// dark grey. Both images must have the same size.
std::vector<uint8_t> heat_map(const backends::Image& a, const backends::Image& b,
                              std::span<const uint8_t> encoded_a);

/// Writes both images as NAME.png and NAME.exr, report.txt, and, if the sizes are equal, the heat map difference.png.
/// Creates `folder` if needed.
bool write_report(const std::string& folder, const NamedImage& a, const NamedImage& b,
                  const Comparison& comparison, scene::Encoding encoding, float exposure,
                  support::Diagnostics& diagnostics);

}  // namespace isoshade::compare
