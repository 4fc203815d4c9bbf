// SPDX-License-Identifier: Apache-2.0
// The values for which a document is compiled, given as text: `--set` of compile, check and draw.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"

namespace isoshade::driver {

/// The words of the record that the settings fix, `PARAMETER=VALUE` each, of which the last one for a parameter counts; none
/// if there are no settings. Reports what is malformed, names nothing or does not fit, or that the document is no effect and no
/// post, and returns nothing.
std::optional<FixedWords> fixed_words(const check::TypedGraph& document, const std::vector<std::string>& settings,
                                      support::Diagnostics& diagnostics);

}  // namespace isoshade::driver
