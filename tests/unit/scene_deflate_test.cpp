// SPDX-License-Identifier: Apache-2.0
// Streams that are compressed here, decompressed by zlib.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <zlib.h>

#include "compiler/support/sha256.h"
#include "runtime/scene/deflate.h"

namespace isoshade::scene {
namespace {

std::string inflated(const std::string& stream, size_t size) {
  std::string bytes(size + 1, '\0');
  auto count = static_cast<uLongf>(bytes.size());
  const int result = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &count,
                                reinterpret_cast<const Bytef*>(stream.data()), static_cast<uLong>(stream.size()));
  EXPECT_EQ(result, Z_OK);
  bytes.resize(count);
  return bytes;
}

/// The same stream in two parts.
std::string in_two_parts(std::string_view bytes, size_t cut) {
  std::string stream(zlib_head);
  append_deflated(bytes.substr(0, cut), false, stream);
  append_deflated(bytes.substr(cut), true, stream);
  append_big_endian(stream, static_cast<uint32_t>(adler32(1, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()))));
  return stream;
}

/// Bytes of one of several kinds: noise, few values, runs, one value mostly, repetitions.
std::string random_bytes(std::mt19937& random, size_t size) {
  std::string bytes;
  const unsigned kind = random() % 6;
  while (bytes.size() < size) {
    // One after the other: compilers may compute operands in any order.
    const auto any = static_cast<char>(random());
    const unsigned number = random();
    switch (kind) {
      case 0: bytes += any; break;
      case 1: bytes += static_cast<char>(number % 3); break;
      case 2: bytes.append(1 + number % 700, any); break;
      case 3: bytes += static_cast<char>(__builtin_ctz(number | 1u << 30)); break;
      case 4: bytes += number % 50 == 0 ? any : '\7'; break;
      default: bytes += bytes.substr(bytes.empty() ? 0 : number % bytes.size(), 600) + any;
    }
  }
  bytes.resize(size);
  return bytes;
}

TEST(Deflate, ZlibDecompressesEveryKindOfBytes) {
  std::mt19937 random(1);
  for (size_t i = 0; i < 1500; ++i) {
    const size_t large = random() % 300'000;
    const std::string bytes = random_bytes(random, i < 300 ? i : i % 20 == 0 ? large : large % 3000);
    ASSERT_EQ(inflated(zlib_stream(bytes), bytes.size()), bytes) << i;
    const size_t cut = random() % (bytes.size() + 1);
    ASSERT_EQ(inflated(in_two_parts(bytes, cut), bytes.size()), bytes) << i << " in parts at " << cut;
  }
}

TEST(Deflate, BlocksMayEndAnywhere) {
  std::mt19937 random(2);
  for (const size_t size : {65534u, 65535u, 65536u, 65537u, 131070u, 131071u}) {
    const std::string noise = random_bytes(random, size), zeros(size, '\0');
    EXPECT_EQ(inflated(zlib_stream(noise), size), noise) << size;
    EXPECT_EQ(inflated(zlib_stream(zeros), size), zeros) << size;
  }
}

TEST(Deflate, MatchesOfEveryLengthAndDistanceAreCopied) {
  std::mt19937 random(3);
  std::string noise(40'000, '\0');
  for (char& c : noise) c = static_cast<char>(random());
  for (const size_t distance : {1u, 2u, 3u, 4u, 5u, 8u, 257u, 4097u, 24'577u, 32'767u, 32'768u, 32'769u}) {
    for (const size_t length : {3u, 4u, 5u, 11u, 257u, 258u, 259u, 260u, 261u, 516u, 517u, 518u}) {
      std::string bytes = noise.substr(0, distance);
      for (size_t i = 0; i < length; ++i) bytes += bytes[bytes.size() - distance];
      bytes += "end";
      ASSERT_EQ(inflated(zlib_stream(bytes), bytes.size()), bytes) << distance << " " << length;
    }
  }
}

TEST(Deflate, WordsOfRareBytesAreNotTooLong) {
  // Frequencies of Fibonacci numbers would have words of 22 bits.
  std::string bytes;
  for (size_t value = 0, a = 1, b = 1; value < 22; ++value, std::swap(a, b), b += a) bytes.append(a, static_cast<char>(value * 11));
  std::mt19937 random(4);
  std::shuffle(bytes.begin(), bytes.end(), random);
  const std::string stream = zlib_stream(bytes);
  EXPECT_EQ(inflated(stream, bytes.size()), bytes);
  EXPECT_LT(stream.size(), bytes.size() / 2);
}

TEST(Deflate, CompressesRunsAndRepetitionsAndStoresNoise) {
  EXPECT_LT(zlib_stream(std::string(1 << 20, 'a')).size(), 5500u);
  std::string noise(1 << 16, '\0'), repeated;
  std::mt19937 random(5);
  for (char& c : noise) c = static_cast<char>(random());
  for (int i = 0; i < 64; ++i) repeated += noise.substr(0, 1024);
  EXPECT_LT(zlib_stream(repeated).size(), 3000u);
  EXPECT_LE(zlib_stream(noise).size(), noise.size() + 32);
  EXPECT_EQ(zlib_stream("").size(), 2 + 5 + 4u);
}

TEST(Deflate, BytesAreTheSameOnEveryMachine) {
  std::mt19937 random(6);
  std::string streams;
  for (int i = 0; i < 40; ++i) {
    const size_t size = random() % 100'000;
    streams += zlib_stream(random_bytes(random, size));
  }
  EXPECT_EQ(support::sha256(streams).substr(0, 16), "23d505290b86b34f");
}

}  // namespace
}  // namespace isoshade::scene
