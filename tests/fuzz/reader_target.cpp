// SPDX-License-Identifier: Apache-2.0
// libFuzzer's way into one reader, FUZZ_READER, with clang and its runtime (Debian: clang, libclang-rt-dev):
// scripts/build.sh fuzz && build/fuzz/tests/fuzz_png FOLDER tests/fuzz/corpus/png
// Half of the mutations are those of the tests, which know the format.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/reader.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  isoshade::FUZZ_READER.read({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  static const std::vector<std::string> good = isoshade::FUZZ_READER.good();
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (seed % 2 == 0) {
    bytes = isoshade::FUZZ_READER.damaged(size == 0 ? good : std::vector{std::move(bytes)}, seed);
  } else {
    bytes.resize(LLVMFuzzerMutate(data, size, most));
    if (!bytes.empty()) std::memcpy(bytes.data(), data, bytes.size());
    if (isoshade::FUZZ_READER.mend != nullptr) isoshade::FUZZ_READER.mend(bytes);
  }
  if (bytes.size() > most) bytes.resize(most);
  if (!bytes.empty()) std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}
