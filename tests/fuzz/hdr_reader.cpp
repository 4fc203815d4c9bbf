// SPDX-License-Identifier: Apache-2.0
// Radiance HDR: lines of text, then rows.
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

std::vector<std::string> good() {
  std::vector<float> floats;
  for (int i = 0; i < 19 * 11; ++i)
    floats.insert(floats.end(), {0.5f * static_cast<float>(i), 1, i % 7 == 0 ? 3e5f : 1e-20f});
  const std::string packed = hdr_file(19, 11, floats);
  // A run of one value for each channel.
  const std::string run = "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n" +
                          std::string("\2\2\0\x09\x89\x80\x89\x40\x89\x20\x89\x81", 12);
  // The pixel before, 3 times and 258 times.
  const std::string old = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 -X 263\n";
  const std::string line = std::string("\x80\x40\x20\x81\1\1\1\3\x40\x80\x20\x81\1\1\1\2\1\1\1\1", 20);
  const std::string wide =
      "#?RADIANCE\nPRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\nCOLORCORR=1 2 4\n"
      "FORMAT=32-bit_rle_rgbe\n\n+X 1 -Y 2\n\x80\x40\x20\x81\x80\x40\x20\x81";
  return {packed, run, hdr_file(3, 5, floats), old + line + line, wide};
}

void damage_number(std::string& bytes, Random& random) {
  static const std::vector<std::string> numbers = {
      "0",    "1",    "-1",  "7",           "8",          "9", "32767", "32768",
      "8192", "8193", "1e9", "99999999999", "4294967297", "",  " 3",    "+3"};
  const size_t first = bytes.find_first_of("0123456789", random.below(120));
  if (first == std::string::npos) return;
  const size_t end = std::min(bytes.find_first_not_of("0123456789", first), bytes.size());
  bytes.replace(first, end - first, random.any(numbers));
}

void insert_line(std::string& bytes, Random& random) {
  static const std::vector<std::string> lines = {"EXPOSURE=2\n",
                                                 "EXPOSURE=0\n",
                                                 "EXPOSURE=1e99\n",
                                                 "EXPOSURE=x\n",
                                                 "COLORCORR=1 2 3\n",
                                                 "COLORCORR=1 nan\n",
                                                 "GAMMA=2.2\n",
                                                 "# text\n",
                                                 "FORMAT=32-bit_rle_xyze\n",
                                                 "FORMAT=32-bit_rle_rgbe\n",
                                                 "\n",
                                                 "PRIMARIES=1 0 0 1 0 0 .3 .3\n",
                                                 "PIXASPECT=0\n"};
  const size_t line = bytes.find('\n', random.below(60));
  if (line != std::string::npos) bytes.insert(line + 1, random.any(lines));
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  for (size_t n = 1 + random.below(3); n > 0; --n) {
    switch (random.below(6)) {
      case 0: damage_number(bytes, random); break;
      case 1: insert_line(bytes, random); break;
      case 2: {  // the rows of another file
        const std::string& other = random.any(files);
        const size_t from = std::min(other.find("\n\n"), other.size());
        bytes = bytes.substr(0, bytes.find("\n\n")) + other.substr(from);
        break;
      }
      default: damage_bytes(bytes, random.one_in(3) ? 60 : bytes.size(), random); break;
    }
  }
  return bytes;
}

}  // namespace

const Reader hdr_reader = {"hdr", good, damaged, nullptr, read_image};

}  // namespace isoshade
