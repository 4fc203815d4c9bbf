// SPDX-License-Identifier: Apache-2.0
// Properties that the library's forms have and those of the sources lack, counted.
#pragma once

#include <string>
#include <vector>

namespace isoshade::accuracy {

struct Comparison {
  std::string what;     ///< is counted or measured
  std::string library;  ///< of the library's form
  std::string source;   ///< of the form that it replaces
};

std::vector<Comparison> comparisons();

}  // namespace isoshade::accuracy
