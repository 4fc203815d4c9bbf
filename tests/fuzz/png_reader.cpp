// SPDX-License-Identifier: Apache-2.0
// PNG whose chunks are damaged and have right checksums, so that the damage gets to the decoder.
#include "runtime/scene/image_file.h"
#include "tests/fuzz/damage.h"
#include "tests/fuzz/reader.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

constexpr size_t signature = 8, around = 12;

struct Chunk {
  std::string type;
  std::string data;
};

size_t number_at(const std::string& bytes, size_t at) {
  size_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

/// The chunks; what follows the last whole one is left out.
std::vector<Chunk> chunks_of(const std::string& bytes) {
  std::vector<Chunk> chunks;
  for (size_t at = signature; at + around <= bytes.size();) {
    const size_t length = number_at(bytes, at);
    if (length > bytes.size() - at - around) break;
    chunks.push_back({bytes.substr(at + 4, 4), bytes.substr(at + 8, length)});
    at += around + length;
  }
  return chunks;
}

std::string file_of(const std::vector<Chunk>& chunks) {
  std::string bytes = "\x89PNG\r\n\x1a\n";
  for (const Chunk& chunk : chunks) bytes += png_chunk(chunk.type, chunk.data);
  return bytes;
}

/// Data as `stored` packs them, so that they can be damaged and packed again; else empty.
std::string unstored(const std::string& packed) {
  constexpr size_t before = 7, behind = 4;
  const bool is_stored = packed.size() > before + behind && packed.starts_with("\x78\x01\x01");
  return is_stored ? packed.substr(before, packed.size() - before - behind) : "";
}

std::vector<std::string> good() {
  std::vector<uint8_t> rgba;
  std::string colors, indices;
  for (int i = 0; i < 19 * 11; ++i)
    rgba.insert(rgba.end(), {static_cast<uint8_t>(i * 7), 3, 200, static_cast<uint8_t>(i)});
  for (int i = 0; i < 16; ++i) colors += {static_cast<char>(17 * i), 'b', 'c'};
  for (int i = 0; i < 16; ++i) indices += static_cast<char>(i);
  const std::string palette = png_chunk("PLTE", colors) + png_chunk("tRNS", "\x33\x44");
  const std::string profile = png_chunk("iCCP", std::string("p\0\0", 3) + stored("no profile")) +
                              png_chunk("zTXt", std::string("k\0\0", 3) + stored("text")) +
                              png_chunk("gAMA", big_endian(45455));
  const std::string gray = png_chunk("tRNS", std::string("\0\1", 2));
  return {scene::png(19, 11, rgba),
          png_file(3, 2, 16, 2, {std::string(18, 'a'), std::string(18, 'b')}, profile),
          png_file(2, 2, 16, 6, {std::string(16, 'a'), std::string(16, 'b')}),
          png_file(16, 2, 8, 3, {indices, indices}, palette),
          png_file(8, 3, 4, 3, {"\1\x23\x45\x67", "\x89\xab\xcd\xef", "abcd"}, palette),
          png_file(9, 1, 2, 0, {"abc"}, gray),
          png_file(9, 1, 1, 0, {"ab"}, gray),
          png_file(3, 3, 8, 0, {"a", "c", "ab", "b", "d", "def"}, "", true),
          png_file(3, 1, 8, 4, {"aAbBcC"})};
}

void damage_chunk(std::vector<Chunk>& chunks, Random& random) {
  // A third of the damage is to the header.
  Chunk& chunk = random.one_in(3) ? chunks[0] : chunks[random.below(chunks.size())];
  if (std::string pixels = unstored(chunk.data); !pixels.empty() && !random.one_in(4)) {
    damage_bytes(pixels, pixels.size(), random);
    chunk.data = stored(pixels);
  } else if (chunk.type == "IHDR" && chunk.data.size() == 13 && !random.one_in(4)) {
    // Small sizes, every depth and type.
    static const std::vector<int> values = {0, 1, 2, 3, 4, 6, 8, 16, 17, 32, 255};
    constexpr size_t fields[] = {2, 3, 6, 7, 8, 9, 9, 10, 11, 12, 12};
    chunk.data[fields[random.below(std::size(fields))]] = static_cast<char>(random.any(values));
  } else if (random.one_in(8) && chunk.type.size() == 4) {
    chunk.type[random.below(4)] ^= 32;
  } else {
    damage_bytes(chunk.data, chunk.data.size(), random);
  }
}

void insert_chunk(std::vector<Chunk>& chunks, Random& random) {
  static const std::vector<const char*> types = {"PLTE", "tRNS", "gAMA", "sRGB", "iCCP", "tEXt",
                                                 "zTXt", "iTXt", "bKGD", "sBIT", "cHRM", "hIST",
                                                 "sPLT", "tIME", "eXIf", "IDAT", "IEND", "acTL"};
  std::string data;
  for (size_t n = random.one_in(2) ? random.below(8) : random.below(800); n > 0; --n)
    data += static_cast<char>(random.below(256));
  chunks.insert(chunks.begin() + static_cast<ptrdiff_t>(random.below(chunks.size() + 1)),
                {random.any(types), data});
}

/// One IDAT as two.
void split_data(std::vector<Chunk>& chunks, Random& random) {
  for (size_t i = 0; i < chunks.size(); ++i) {
    if (chunks[i].type != "IDAT") continue;
    const size_t half = random.below(chunks[i].data.size() + 1);
    const Chunk rest{"IDAT", chunks[i].data.substr(half)};
    chunks[i].data.resize(half);
    chunks.insert(chunks.begin() + static_cast<ptrdiff_t>(i) + 1, rest);
    return;
  }
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  std::vector<Chunk> chunks = chunks_of(bytes);
  if (chunks.empty() || random.one_in(8)) {
    damage_file(bytes, random);
    return bytes;
  }
  for (size_t n = 1 + random.below(3); n > 0 && !chunks.empty(); --n) {
    switch (random.below(8)) {
      case 0: damage_order(chunks, 0, random); break;
      case 1: insert_chunk(chunks, random); break;
      case 2: split_data(chunks, random); break;
      default: damage_chunk(chunks, random); break;
    }
  }
  bytes = file_of(chunks);
  if (random.one_in(10)) bytes.resize(random.below(bytes.size()));
  return bytes;
}

void mend(std::string& bytes) {
  const std::vector<Chunk> chunks = chunks_of(bytes);
  if (!chunks.empty()) bytes = file_of(chunks);
}

}  // namespace

const Reader png_reader = {"png", good, damaged, mend, read_image};

}  // namespace isoshade
