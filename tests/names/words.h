// SPDX-License-Identifier: Apache-2.0
// What documents are given as names.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace isoshade::names {

/// All words, each once: those of words.def and of compiler/emit, every identifier of runtime/lanes and of the texts that
/// we emit, forms that only look like words, and names as long as may be.
const std::vector<std::string>& words();

using Chunk = std::span<const std::string>;
std::vector<Chunk> chunks(const std::vector<std::string>& all, size_t size);

}  // namespace isoshade::names
