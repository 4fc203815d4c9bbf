// SPDX-License-Identifier: Apache-2.0
// Telling what was left out because it could not change a bit: of programs, and (runtime/render) of frames.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "compiler/interface/skips.h"

namespace isoshade::driver {

struct Shader;

/// Something that was left out because it could not change a bit of the image.
struct Skipped {
  std::optional<interface::Skip> skip;  ///< none: the document asks for it, and it cannot be switched off
  std::string what;    ///< "12 of 50 copies of balls"
  std::string reason;  ///< "outside of the view"
  /// The object, light, effect, image or node with whose name `what` ends; what is alike is told together.
  std::string of = {};
  // What that saved, where it is known.
  int64_t operations = 0;  ///< of each pixel, or of each draw if it has no pixels
  int64_t pixels = 0;      ///< of the frame
  int64_t bytes = 0;       ///< of memory
};

/// What the programs of an effect or a post leave out: code for other values than the fixed ones, and what is the same for
/// all pixels of a draw (Program::draw).
std::vector<Skipped> skipped_in(const Effect& effect);
std::vector<Skipped> skipped_in(const Post& post);

/// Functions of more operations are not looked at node by node: that takes up to three times as long as to compile them.
inline constexpr uint64_t most_told_by_node = 100'000;

/// What the functions of a document leave out: code for other values than the fixed ones, node by node what these leave of
/// the graph, and what ranges and branches save. Whoever calls the functions decides what is computed once for a draw.
std::vector<Skipped> skipped_in(const Shader& shader);

}  // namespace isoshade::driver
