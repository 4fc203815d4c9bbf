// SPDX-License-Identifier: Apache-2.0
// The headers of runtime/lanes, in the program itself: an installed isoshade needs no source tree.
#pragma once

#include <span>
#include <string_view>

namespace isoshade::cpu {

struct Header {
  std::string_view path;  ///< as generated code includes it: "runtime/lanes/lanes.h"
  std::string_view text;
};

std::span<const Header> lanes_headers();

}  // namespace isoshade::cpu
