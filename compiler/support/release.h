// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace isoshade::support {

/// Frees the memory of a vector. `v = {}` assigns an empty list and keeps the capacity.
template <class T>
void release(std::vector<T>& vector) {
  std::vector<T>().swap(vector);
}

}  // namespace isoshade::support
