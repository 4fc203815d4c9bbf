// SPDX-License-Identifier: Apache-2.0
// Where the numbers of textures go in a module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::driver {

/// What a value may be: one of some numbers of textures, or computed from some. Of a function the numbers are called by its
/// parameters. Ascending.
struct TextureNumbers {
  std::vector<uint32_t> of, from;
  bool operator==(const TextureNumbers&) const = default;
};

/// What is read of the record of each texture (lower::texture_word), by its number or by what is computed from that.
struct TextureReads {
  std::vector<bool> own;     ///< of the record with this number
  std::vector<bool> levels;  ///< how many mip levels follow, or records that may be those of levels
  std::vector<TextureNumbers> results;
};

/// Follows numbers of textures through the calls of a module that has been optimised. What it says of a texture may be more
/// than what is read, and never less.
class TextureFlow {
 public:
  /// The module must outlive this.
  explicit TextureFlow(const ir::Module& module) : module_(module) {}

  /// A value of a function that is the number of a texture, or is computed from some.
  using Known = std::pair<ir::ValueId, TextureNumbers>;
  /// Follows these values of a function, which have `count` numbers in all, to all of its results.
  TextureReads follow(uint32_t function, size_t count, std::span<const Known> known);

 private:
  class Walk;
  /// Of a function called for these of its results.
  const TextureReads& reads_of(uint32_t function, std::vector<bool> results);

  const ir::Module& module_;
  std::map<std::pair<uint32_t, std::vector<bool>>, TextureReads> known_;
};

}  // namespace isoshade::driver
