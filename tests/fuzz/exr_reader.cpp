// SPDX-License-Identifier: Apache-2.0
// OpenEXR: attributes by name, then offsets and chunks.
#include "runtime/scene/image_file.h"
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"
#include "tests/unit/exr_files.h"

namespace isoshade {
namespace {

using testing::ExrPart;

/// Every compression in rows and tiles, of all types, with samples of every second pixel, in one part and in two.
std::vector<std::string> good() {
  scene::FileImage image{19, 11, {}, {}, std::vector<float>(19 * 11, 0.5f)};
  for (int i = 0; i < 19 * 11 * 4; ++i) image.rgba.push_back(static_cast<float>(i));
  std::vector<std::string> files = {scene::exr(image.view())};
  const auto value = [](size_t channel, int x, int y) {
    return static_cast<float>((x * 7 + y * 13 + static_cast<int>(channel) * 5) % 17) / 4;
  };
  for (int i = 0; i < Imf::NUM_COMPRESSION_METHODS; ++i) {
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
      ExrPart part;
      part.display = {{0, 0}, {36, 39}};
      part.compression = static_cast<Imf::Compression>(i);
      part.channels = {{"A", type}, {"B", type}, {"G", type}, {"R", type}};
      part.value = value;
      files.push_back(testing::exr_file(part));
      const Imf::LevelMode mode = type == Imf::HALF    ? Imf::ONE_LEVEL
                                  : type == Imf::FLOAT ? Imf::MIPMAP_LEVELS
                                                       : Imf::RIPMAP_LEVELS;
      part.tiles = Imf::TileDescription(16, 16, mode);
      files.push_back(testing::exr_file(part));
    }
    ExrPart sparse, second;
    sparse.display = {{0, 0}, {15, 7}};
    sparse.data = Imath::Box2i({-2, 2}, {13, 9});
    sparse.compression = second.compression = static_cast<Imf::Compression>(i);
    sparse.channels = {{"Y"}, {"sparse", Imf::HALF, 2}, {"Z", Imf::FLOAT}, {"id", Imf::UINT}};
    sparse.value = value;
    sparse.chromaticities = Imf::Chromaticities({0.7f, 0.3f}, {0.2f, 0.7f}, {0.1f, 0.05f}, {0.31f, 0.33f});
    files.push_back(testing::exr_file(sparse));
    sparse.chromaticities.reset();  // the library leaks those of several parts
    sparse.channels.erase(sparse.channels.begin());
    sparse.name = "depth";
    second.name = "color";
    second.display = sparse.display;
    if (i % 2 == 1) second.tiles = Imf::TileDescription(4, 4);
    files.push_back(testing::exr_file(std::vector{sparse, second}));
  }
  return files;
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
