// SPDX-License-Identifier: Apache-2.0
// What is left of a document's reads when its programs are compiled: for the values of parameters that are fixed, and
// after all passes.
#pragma once

#include <cstddef>
#include <vector>

#include "compiler/driver/driver.h"

namespace isoshade::driver {

/// By word of the record of an effect or a post (ParameterBlock): whether a program reads it.
std::vector<bool> words_read(const Effect& effect);
std::vector<bool> words_read(const Post& post);

/// What programs read of the texture whose number lies in a word of the record.
struct ImageReads {
  bool any = false;  ///< at least whether there is one
  bool levels =
      false;  ///< smaller mip levels; always true where a layer is chosen, because layers lie behind these
};
/// By image of the block: what the programs of those passes read that fixed values of parameters do not switch off.
std::vector<ImageReads> images_read(const Effect& effect);

}  // namespace isoshade::driver
