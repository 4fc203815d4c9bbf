// SPDX-License-Identifier: Apache-2.0
// Documents that have the words of a chunk as names, compiled.
#pragma once

#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "compiler/driver/shader.h"
#include "tests/names/words.h"

namespace isoshade::names {

struct Made {
  std::vector<driver::Program> programs;  ///< none: it did not compile
  std::vector<driver::Shader> shaders;    ///< the same documents as pure shaders
  std::string messages;                   ///< then why
};

/// A function a word: its name, its file, its input and its only output are called so, a node in it by another; and one
/// that calls all of them, by nodes of their names.
Made functions_called(Chunk words);
/// A function whose inputs and outputs are called so, and one that calls it.
Made function_of_many(Chunk words);
/// A function and an effect whose nodes are called so; of the effect in the pixels and in moved vertices.
Made nodes_called(Chunk words);
/// An effect called by the first, whose parameters, passes and values of parameters are called so.
Made effect_with_parameters(Chunk words);
/// An effect whose image nodes and file names are called so, and one whose parameters for images are.
Made effect_with_images(Chunk words);
/// A post called by the first, whose parameters are called so, and one with sums over taps.
Made post_with_parameters(Chunk words);
/// A post that reads images of these names; at most 8.
Made post_with_images(Chunk words);

/// Both texts of programs that use much of what texts have: shipped documents of each kind.
std::vector<std::string> sample_texts();

}  // namespace isoshade::names
