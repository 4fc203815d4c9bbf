// SPDX-License-Identifier: Apache-2.0
// `--set` of compile and draw: values of parameters for which a document is compiled.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"

namespace isoshade::cli {

/// The words of the record that the settings fix; nothing after an error.
std::optional<driver::FixedWords> fixed_words(const support::Source& source, const std::vector<std::string>& settings,
                                              const driver::CompileOptions& options, support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
