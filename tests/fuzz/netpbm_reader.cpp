// SPDX-License-Identifier: Apache-2.0
// PPM, PGM and PFM: a few words, then numbers.
#include "runtime/scene/image_file.h"
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"

namespace isoshade {
namespace {

std::vector<std::string> good() {
  std::vector<float> rgba;
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 4 * 19 * 11; ++i) {
    rgba.push_back(0.25f * static_cast<float>(i % 37) - 1);
    bytes.push_back(static_cast<uint8_t>(i * 7));
  }
  const std::string numbers(bytes.begin(), bytes.end());
  return {scene::ppm({19, 11, bytes}), scene::pfm({19, 11, rgba, {}}), "P5 # grey\n3 2 200\n" + std::string(6, 'a'),
          "P6\n7 3\n# wide\n65535\n" + numbers.substr(0, 126), "Pf\n5 4\n1.0\n" + std::string(80, '\x3f')};
}

void damage_word(std::string& bytes, Random& random) {
  static const std::vector<std::string> words = {"0",     "1",     "-1",  "255",         "256", "65535",
                                                 "65536", "8193",  "1e9", "99999999999", "",    "nan",
                                                 "-1.0",  "-1e-9", "inf", "#"};
  const size_t first = bytes.find_first_of("0123456789", 1 + random.below(12));
  if (first == std::string::npos) return;
  const size_t end = std::min(bytes.find_first_of(" \n", first), bytes.size());
  bytes.replace(first, end - first, random.any(words));
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  static const std::string kinds = "56Ff3";
  for (size_t n = 1 + random.below(3); n > 0; --n) {
    switch (random.below(4)) {
      case 0: damage_word(bytes, random); break;
      case 1:
        if (bytes.size() > 1) bytes[1] = kinds[random.below(kinds.size())];
        break;
      default: damage_bytes(bytes, random.one_in(2) ? 24 : bytes.size(), random); break;
    }
  }
  return bytes;
}

}  // namespace

const Reader netpbm_reader = {"netpbm", good, damaged, nullptr, read_image};

}  // namespace isoshade
