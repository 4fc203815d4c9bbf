// SPDX-License-Identifier: Apache-2.0
// The readers of files from outside, and how their files are damaged: for libFuzzer and for tests alike.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade {

struct Reader {
  std::string_view name;  ///< also that of its folder in tests/fuzz/corpus
  /// Files that it reads.
  std::vector<std::string> (*good)();
  /// A file made from one of these; the same for the same seed.
  std::string (*damaged)(const std::vector<std::string>& files, uint32_t seed);
  /// Makes checksums right again after bytes were changed. May be null.
  void (*mend)(std::string& bytes);
  /// Whether the reader takes this file. Aborts where it breaks a promise: what it reads must be whole and finite, and
  /// what it refuses have a reason. Every value of the result is used, so that valgrind sees those that nobody wrote.
  bool (*read)(const std::string& bytes);
};

/// All of them.
std::span<const Reader> readers();

extern const Reader png_reader, jpeg_reader, hdr_reader, exr_reader, netpbm_reader, gltf_reader;

/// Files in tests/fuzz/corpus for the reader: what the fuzzers and people found.
std::vector<std::string> corpus(const Reader& reader);

/// read of the readers of images.
bool read_image(const std::string& bytes);

}  // namespace isoshade
