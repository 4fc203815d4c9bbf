// SPDX-License-Identifier: Apache-2.0
// OpenEXR: attributes by name, then offsets and chunks.
#include "runtime/scene/image_file.h"
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"

namespace isoshade {
namespace {

std::vector<std::string> good() {
  scene::FileImage image{19, 11, {}, {}, std::vector<float>(19 * 11, 0.5f)};
  for (int i = 0; i < 19 * 11 * 4; ++i) image.rgba.push_back(static_cast<float>(i));
  return {scene::exr(image.view())};
}

/// A byte of an attribute: name, type, size, value.
void damage_attribute(std::string& bytes, Random& random) {
  static const std::vector<std::string> names = {"channels",   "compression",
                                                 "dataWindow", "displayWindow",
                                                 "lineOrder",  "tiles",
                                                 "type",       "version",
                                                 "chunkCount", "R",
                                                 "G",          "B",
                                                 "A",          "Z"};
  const std::string name = random.any(names) + '\0';
  const size_t at = bytes.find(name);
  if (at == std::string::npos) return;
  const size_t place = at + random.below(name.size() + 40);
  if (place < bytes.size())
    bytes[place] = static_cast<char>(random.one_in(2) ? random.below(10) : random.below(256));
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  for (size_t n = 1 + random.below(3); n > 0; --n) {
    if (random.one_in(2))
      damage_attribute(bytes, random);
    else
      damage_bytes(bytes, random.one_in(2) ? 400 : bytes.size(), random);
  }
  return bytes;
}

}  // namespace

const Reader exr_reader = {"exr", good, damaged, nullptr, read_image};

}  // namespace isoshade
