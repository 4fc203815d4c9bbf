// SPDX-License-Identifier: Apache-2.0
// A folder that shows how two images differ.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "runtime/compare/compare.h"
#include "runtime/scene/encode.h"

namespace isoshade::compare {

struct NamedImage {
  std::string name;  ///< "cpu": of its files in the folder, without their endings
  std::string description;
  const backends::Image* image = nullptr;
};

/// RGBA bytes: pixels that differ glow from yellow (1 ULP) to red (2^31 ULP), by the logarithm; the others
/// show the image dimmed and grey. The images have one size.
std::vector<uint8_t> heat_map(const backends::Image& a, const backends::Image& b,
                              std::span<const uint8_t> encoded_a);

/// Writes into `folder`, which is made if needed: both images as NAME.png and NAME.exr; report.txt; and, if
/// they have one size, difference.png, the heat map.
bool write_report(const std::string& folder, const NamedImage& a, const NamedImage& b,
                  const Comparison& comparison, scene::Encoding encoding, float exposure,
                  support::Diagnostics& diagnostics);

}  // namespace isoshade::compare
