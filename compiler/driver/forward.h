// SPDX-License-Identifier: Apache-2.0
// The forward pairs of a document: ordinary vertex and fragment shaders (emit/forward.h).
#pragma once

#include <string>
#include <vector>

#include "compiler/driver/shader.h"
#include "compiler/emit/forward.h"

namespace isoshade::driver {

/// The pair of a pass, or of a post.
struct ForwardPair {
  std::string stem;  ///< of its files: "NAME" or, if the effect has several passes, "NAME.PASS"
  emit::ForwardText text;
  emit::ForwardLayout layout;
};

/// Reports an effect that reads the picture, of which a pair has none.
bool can_be_forward(const Shader& shader, support::Diagnostics& diagnostics);

/// The pairs of an effect or a post in a language that has them (emit::Target::forward); none of a function.
std::vector<ForwardPair> forward_pairs(const Shader& shader, const emit::Target& target,
                                       emit::ForwardSampling sampling = emit::ForwardSampling::fetch);

}  // namespace isoshade::driver
