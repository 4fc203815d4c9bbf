// SPDX-License-Identifier: Apache-2.0
// All files that a document is compiled to: what `isoshade compile` writes and the library returns.
#pragma once

#include <cstdint>
#include <isoshade/compiler.h>
#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"

namespace isoshade::api {

struct ArtifactOptions {
  std::vector<std::string> targets;  ///< names of languages and of their binary forms; empty: the usual ones
  Wrapper wrapper = Wrapper::none;
  bool hardware_samplers = false;  ///< forward pairs read images by samplers
  bool prove = false;              ///< adds to the reflection what `isoshade check` finds
  std::string prefix;              ///< of names; empty: the document's name
  driver::Division division = driver::Division::native;
};

struct Artifacts {
  std::vector<File> files;  ///< the reflection, NAME.json, comes first
  /// Paths of the document, of the functions that it uses and of its images; for an image that is missing, the folder in
  /// which it would appear.
  std::vector<std::string> read;
};

/// Reports targets that do not exist or do not have what is wanted.
std::optional<Artifacts> make_artifacts(const driver::Checked& document, const driver::CompileOptions& compile,
                                        const ArtifactOptions& options, support::Diagnostics& diagnostics);

}  // namespace isoshade::api
