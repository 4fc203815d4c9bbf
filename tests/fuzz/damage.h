// SPDX-License-Identifier: Apache-2.0
// Damage that needs to know nothing of a format.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace isoshade {

class Random {
 public:
  explicit Random(uint32_t seed) : bits_(seed) {}

  /// From 0 to end - 1; 0 if end is 0.
  size_t below(size_t end) { return end == 0 ? 0 : bits_() % end; }
  bool one_in(size_t n) { return below(n) == 0; }
  template <class T>
  const T& any(const std::vector<T>& values) {
    return values[below(values.size())];
  }

 private:
  std::mt19937 bits_;
};

/// Damages one place among the first `end` bytes.
inline void damage_bytes(std::string& bytes, size_t end, Random& random) {
  if (bytes.empty()) bytes = "a";
  const size_t at = random.below(std::min(bytes.size(), std::max<size_t>(end, 1)));
  switch (random.below(6)) {
    case 0: bytes[at] ^= static_cast<char>(1u << random.below(8)); break;
    case 1: bytes[at] = static_cast<char>(random.one_in(2) ? 255 : random.below(256)); break;
    case 2: bytes[at] = static_cast<char>(bytes[at] + (random.one_in(2) ? 1 : -1)); break;
    case 3: bytes.resize(at); break;
    case 4: bytes.insert(at, bytes.substr(random.below(bytes.size()), random.below(40))); break;
    default: bytes.erase(at, 1 + random.below(8)); break;
  }
}

/// Damages one to four places; half of the damage is where sizes and formats stand.
inline void damage_file(std::string& bytes, Random& random) {
  for (size_t n = 1 + random.below(4); n > 0; --n)
    damage_bytes(bytes, random.one_in(2) ? 400 : bytes.size(), random);
}

/// Takes out, repeats or moves one part of a file. `keep` parts at the front stay.
template <class Part>
void damage_order(std::vector<Part>& parts, size_t keep, Random& random) {
  if (parts.size() <= keep) return;
  const size_t from = keep + random.below(parts.size() - keep), to = keep + random.below(parts.size() - keep);
  switch (random.below(3)) {
    case 0: parts.erase(parts.begin() + static_cast<ptrdiff_t>(from)); break;
    case 1: parts.insert(parts.begin() + static_cast<ptrdiff_t>(to), Part(parts[from])); break;
    default: std::swap(parts[from], parts[to]); break;
  }
}

}  // namespace isoshade
