// SPDX-License-Identifier: Apache-2.0
// Makes the reflection of a shader.
#pragma once

#include <optional>
#include <span>

#include "compiler/driver/forward.h"
#include "compiler/driver/shader.h"
#include "compiler/graph/files.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::reflect {

/// The words of a record that hold a block, which begins at word `first`.
List<RecordWords> record_of(const driver::ParameterBlock& block, size_t first);

struct ReflectOptions {
  graph::FileRule files;  ///< which images may be read, to hash them
  bool prove = false;  ///< adds what `isoshade check` finds, which takes seconds where much is left to prove
  std::span<const driver::ForwardPair> pairs = {};  ///< of the shader, if they are written
};

/// Reports a document that is too large to prove, and returns nothing.
std::optional<Reflection> reflect(const driver::Shader& shader, const ReflectOptions& options,
                                  support::Diagnostics& diagnostics);

}  // namespace isoshade::reflect
