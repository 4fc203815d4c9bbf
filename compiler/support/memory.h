// SPDX-License-Identifier: Apache-2.0
// How much memory is available, how to report that it is too little, and how to free it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

/// Bytes that this process can still allocate: the minimum of the machine's free memory and swap, the limit of the
/// control group (a container's), and what is left of the limits on address space and data (ulimit -v, -d).
uint64_t available_memory();

/// Whether this process is so close to its limit on address space or data that a fault in a library is most likely a
/// failed allocation. Async-signal-safe.
bool is_memory_exhausted();

/// Whether `what` ("the image"), which is about to be allocated, fits; otherwise reports it and suggests `fix`.
bool check_memory(uint64_t bytes, const std::string& what, const std::string& fix, Diagnostics& diagnostics);

/// "1.3 GiB", "20 MiB".
std::string memory_text(uint64_t bytes);

/// Leaves new elements uninitialised unless they are given a value.
template <class T>
struct Uninitialised : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Uninitialised<U>;
  };
  template <class U>
  void construct(U* place) noexcept {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Values>
  void construct(U* place, Values&&... values) {
    ::new (static_cast<void*>(place)) U(std::forward<Values>(values)...);
  }
};

/// A vector whose resize() does not write the new elements: for arrays that are then written whole, whose memory is so
/// touched only once.
template <class T>
using Array = std::vector<T, Uninitialised<T>>;

/// Asks the system for large pages where this memory has none yet: fewer faults when it is first written.
void use_huge_pages(void* begin, size_t bytes);

/// Frees the memory of a vector. (`v = {}` assigns an empty list and keeps the capacity.)
template <class T, class Allocator>
void release(std::vector<T, Allocator>& vector) {
  std::vector<T, Allocator>().swap(vector);
}

}  // namespace isoshade::support
