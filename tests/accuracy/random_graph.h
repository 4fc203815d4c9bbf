// SPDX-License-Identifier: Apache-2.0
// Documents made at random: functions, effects and posts of every node, expression and library document.
#pragma once

#include <cstdint>
#include <string>

namespace isoshade::accuracy {

/// The text of a document; the same for the same seed. Nearly all are valid: what a node demands beyond its types is
/// mostly heeded. `library`: the folder of the library documents that it may call.
std::string random_document(uint64_t seed, const std::string& library);

}  // namespace isoshade::accuracy
