// SPDX-License-Identifier: Apache-2.0
// libFuzzer's way into the compiler, with clang and its runtime (Debian: clang, libclang-rt-dev):
// scripts/build.sh fuzz && build/fuzz/fuzz_documents CORPUS
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/feed.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  isoshade::feed({reinterpret_cast<const char*>(data), size});
  return 0;
}
