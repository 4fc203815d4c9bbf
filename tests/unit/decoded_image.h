// SPDX-License-Identifier: Apache-2.0
// Images decoded from bytes, and the reasons why others are not.
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "runtime/scene/image_file.h"

namespace isoshade::testing {

using Floats = std::vector<float>;

/// The numbers of an image, whose header says what it is.
inline Floats rgba_of(const std::string& bytes, bool has_bytes) {
  const auto header = scene::read_header(bytes);
  const auto decoded = scene::decode_image(bytes);
  if (!header.found || !decoded.found) {
    ADD_FAILURE() << decoded.reason;
    return {};
  }
  EXPECT_EQ(decoded.found->has_bytes(), has_bytes);
  EXPECT_EQ(header.found->bytes, has_bytes);
  EXPECT_EQ(header.found->width, decoded.found->width);
  EXPECT_EQ(header.found->height, decoded.found->height);
  return scene::numbers_of(*decoded.found);
}

/// Why there is no image; empty if there is one.
inline std::string reason_of(const std::string& bytes) { return scene::decode_image(bytes).reason; }

}  // namespace isoshade::testing
