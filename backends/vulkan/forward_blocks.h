// SPDX-License-Identifier: Apache-2.0
// The contents of the uniform blocks of a forward pair.
#pragma once

#include <cstddef>
#include <span>

#include "backends/backend.h"
#include "compiler/driver/forward.h"

namespace isoshade::vulkan {

/// Where a block's words come from.
struct ForwardSource {
  const backends::Frame& frame;
  std::span<const float> parameters;      ///< of the draw or the post
  const backends::Draw* draw = nullptr;   ///< null: of a post
  int width = 0, height = 0;              ///< of the image that a post makes
};

/// How many words of a record of parameters a member of the block has.
int words_of(const emit::ForwardMember& member);

/// Writes the whole block; `bytes` has its size.
void fill(const emit::ForwardLayout& layout, const emit::ForwardLayout::Block& block, const ForwardSource& source,
          std::span<std::byte> bytes);

}  // namespace isoshade::vulkan
