// SPDX-License-Identifier: Apache-2.0
// JPEG: that its pixels are the same everywhere, and that no damaged file gives any.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "compiler/support/sha256.h"
#include "tests/unit/decoded_image.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;

constexpr int width = 61, height = 45;

std::vector<uint8_t> pixels(size_t channels) {
  std::vector<uint8_t> all;
  for (size_t i = 0; i < size_t{width} * height * channels; ++i)
    all.push_back(static_cast<uint8_t>(i / channels % width * 4 + i / channels / width * (1 + i % channels)));
  return all;
}

std::string rgb_file(const JpegOptions& options = {}) { return jpeg_file(width, height, pixels(3), options); }

/// The segments of this marker and where each begins, with its marker.
std::vector<size_t> segments(const std::string& bytes, int marker) {
  std::vector<size_t> found;
  const std::string begin = {'\xff', static_cast<char>(marker)};
  for (size_t at = bytes.find(begin); at != std::string::npos; at = bytes.find(begin, at + 2))
    found.push_back(at);
  return found;
}

size_t segment_size(const std::string& bytes, size_t at) {
  return 2 + (size_t{static_cast<uint8_t>(bytes[at + 2])} << 8 | static_cast<uint8_t>(bytes[at + 3]));
}

std::string without(std::string bytes, int marker) {
  for (std::vector<size_t> all = segments(bytes, marker); !all.empty(); all = segments(bytes, marker))
    bytes.erase(all[0], segment_size(bytes, all[0]));
  return bytes;
}

constexpr int sof0 = 0xc0, dht = 0xc4, eoi = 0xd9, sos = 0xda, dqt = 0xdb;

TEST(Jpeg, DecodesCloseToTheOriginal) {
  for (const bool progressive : {false, true}) {
    std::vector<uint8_t> rgb;
    for (int y = 0; y < 13; ++y)
      for (int x = 0; x < 21; ++x) rgb.insert(rgb.end(), {uint8_t(10 * x), uint8_t(15 * y), 128});
    const Floats read = rgba_of(jpeg_file(21, 13, rgb, {.progressive = progressive}), true);
    ASSERT_EQ(read.size(), size_t{4 * 21 * 13});
    for (size_t i = 0; i < rgb.size() / 3; ++i) {
      EXPECT_NEAR(read[4 * i], rgb[3 * i] / 255.0, 0.05);
      EXPECT_NEAR(read[4 * i + 1], rgb[3 * i + 1] / 255.0, 0.05);
      EXPECT_EQ(read[4 * i + 3], 1.0f);
    }
  }
}

TEST(Jpeg, GreyBecomesThreeEqualColours) {
  const Floats read = rgba_of(
      jpeg_file(8, 8, std::vector<uint8_t>(64, 102), {.across = 1, .down = 1, .colors = JCS_GRAYSCALE}),
      true);
  EXPECT_EQ(Floats(read.begin(), read.begin() + 4), (Floats{0.4f, 0.4f, 0.4f, 1}));
}

TEST(Jpeg, WrittenPicturesAreCloseToTheOriginal) {
  std::vector<uint8_t> rgba;
  for (int y = 0; y < 45; ++y)
    for (int x = 0; x < 61; ++x) rgba.insert(rgba.end(), {uint8_t(4 * x), uint8_t(5 * y), uint8_t(230 - 3 * x), 255});
  size_t before = 0;
  for (const auto& [quality, error] : {std::pair(20, 0.2), {75, 0.1}, {90, 0.05}, {100, 0.02}}) {
    const std::string file = scene::jpeg({61, 45, rgba}, quality);
    EXPECT_GT(file.size(), before) << quality;
    before = file.size();
    const Floats read = rgba_of(file, true);
    ASSERT_EQ(read.size(), rgba.size());
    double sum = 0;
    for (size_t i = 0; i < rgba.size(); ++i) {
      EXPECT_NEAR(read[i], rgba[i] / 255.0, error) << quality << " " << i;
      sum += std::abs(static_cast<double>(read[i]) - rgba[i] / 255.0);
    }
    EXPECT_LT(sum / static_cast<double>(rgba.size()), error / 4) << quality;
  }
}

TEST(Jpeg, ColoursHaveTheFullResolutionFromAQualityOfNinetyOn) {
  const std::vector<uint8_t> rgba(4 * 16 * 16, 90);
  const auto samplings = [&](int quality) {
    const std::string file = scene::jpeg({16, 16, rgba}, quality);
    return static_cast<int>(file[segments(file, sof0).at(0) + 11]);
  };
  EXPECT_EQ(samplings(89), 0x22);
  EXPECT_EQ(samplings(90), 0x11);
}

std::string decoded_hash(const std::string& name) {
  std::ifstream file(std::string(ISOSHADE_CORPUS) + "/jpeg/" + name, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const auto decoded = scene::decode_image(bytes);
  if (!decoded.found) return decoded.reason;
  std::string texels;
  for (const uint32_t word : decoded.found->bytes)
    for (int shift = 0; shift < 32; shift += 8) texels += static_cast<char>(word >> shift & 255);
  return support::sha256(texels).substr(0, 16);
}

TEST(Jpeg, DecodesToTheRecordedBytes) {
  const std::pair<const char*, const char*> recorded[] = {
      {"410.jpg", "7c02675601121026"},     {"411.jpg", "4941195835ca63ac"},
      {"420.jpg", "ae7f7d64fb11ef0c"},     {"422.jpg", "f9e3e97e6b69b9e2"},
      {"440.jpg", "87f37a742787dfe7"},     {"444.jpg", "c053157985b14664"},
      {"grey.jpg", "edaf1b8d3a49a71b"},    {"progressive.jpg", "ae7f7d64fb11ef0c"},
      {"restart.jpg", "ae7f7d64fb11ef0c"}, {"rough.jpg", "9d600770b1f3701b"}};
  for (const auto& [name, hash] : recorded) EXPECT_EQ(decoded_hash(name), hash) << name;
}

// Each kind of vector instructions has its own code in libjpeg-turbo, which asks for its variables once in a process.
// The last two are glibc's: what is allocated holds such bytes before it is written.
TEST(Jpeg, DecodesIdenticallyWithAnyInstructionSetAndMemory) {
  for (const char* variable : {"JSIMD_FORCENONE=1", "JSIMD_FORCESSE2=1", "JSIMD_FORCEAVX2=1",
                               "MALLOC_PERTURB_=165", "MALLOC_PERTURB_=90"}) {
    const std::string command = std::string("exec env ") + variable + " /proc/" + std::to_string(getpid()) +
                                "/exe --gtest_filter=Jpeg.DecodesToTheRecordedBytes >/dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0) << variable;
  }
}

TEST(Jpeg, TruncatedFilesAreRefused) {
  for (const bool progressive : {false, true}) {
    const std::string bytes = rgb_file({.quality = 40, .progressive = progressive});
    ASSERT_EQ(reason_of(bytes), "");
    for (size_t length = 0; length < bytes.size(); ++length)
      ASSERT_NE(reason_of(bytes.substr(0, length)), "") << length << " of " << bytes.size();
    // With the end of a whole file, too.
    const std::string end = bytes.substr(bytes.size() - 2);
    for (size_t length = segments(bytes, sos)[0]; length < bytes.size() - 8; ++length)
      ASSERT_NE(reason_of(bytes.substr(0, length) + end), "") << length << " of " << bytes.size();
  }
}

TEST(Jpeg, FilesWithoutAScanAreRefused) {
  const std::string bytes = rgb_file({.progressive = true});
  std::vector<size_t> scans = segments(bytes, sos);
  scans.push_back(segments(bytes, eoi).back());
  ASSERT_GT(scans.size(), 8u);
  for (size_t i = 0; i + 1 < scans.size(); ++i) {
    std::string missing = bytes;
    missing.erase(scans[i], scans[i + 1] - scans[i]);
    EXPECT_NE(reason_of(missing), "") << "scan " << i;
  }
}

/// Of three channels; a scan for each, those that are listed.
std::string scan_by_scan(const std::vector<int>& channels) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &memory, &size);
  info.image_width = info.image_height = 8;
  info.in_color_space = JCS_RGB;
  info.input_components = 3;
  jpeg_set_defaults(&info);
  jpeg_scan_info scans[3] = {};
  for (int c = 0; c < 3; ++c) scans[c] = {1, {c, 0, 0, 0}, 0, 63, 0, 0};
  info.scan_info = scans;
  info.num_scans = 3;
  jpeg_start_compress(&info, TRUE);
  std::vector<uint8_t> row(24, 90);
  JSAMPROW rows = row.data();
  while (info.next_scanline < 8) jpeg_write_scanlines(&info, &rows, 1);
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const std::string bytes(reinterpret_cast<const char*>(memory), size);
  std::free(memory);
  std::vector<size_t> begins = segments(bytes, sos);
  begins.push_back(bytes.size() - 2);
  std::string chosen = bytes.substr(0, begins[0]);
  for (const int c : channels) {
    const auto i = static_cast<size_t>(c);
    chosen += bytes.substr(begins[i], begins[i + 1] - begins[i]);
  }
  return chosen + bytes.substr(bytes.size() - 2);
}

TEST(Jpeg, FilesWithoutAChannelAreRefused) {
  EXPECT_EQ(reason_of(scan_by_scan({0, 1, 2})), "");
  EXPECT_EQ(reason_of(scan_by_scan({0})), "scans are missing");
  EXPECT_NE(reason_of(scan_by_scan({1, 2})), "");
  EXPECT_EQ(reason_of(scan_by_scan({0, 1})), "scans are missing");
  EXPECT_EQ(reason_of(scan_by_scan({0, 1, 1})), "a channel has two scans");
  EXPECT_NE(reason_of(scan_by_scan({})), "");
}

TEST(Jpeg, FilesWithoutTablesAreRefusedEvenAfterAFileWithTables) {
  for (const bool progressive : {false, true}) {
    const std::string whole = rgb_file({.progressive = progressive});
    for (const int marker : {dht, dqt}) {
      EXPECT_NE(reason_of(without(whole, marker)), "") << marker;
      EXPECT_EQ(reason_of(whole), "");
      EXPECT_NE(reason_of(without(whole, marker)), "") << marker;
    }
  }
  EXPECT_EQ(reason_of(without(rgb_file(), dht)), "it has no Huffman tables");
  std::string beyond = rgb_file();
  beyond[segments(beyond, sos).at(0) + 6] = '\x5f';  // tables 5 and 15 of 4
  EXPECT_EQ(reason_of(beyond), "it has no Huffman tables");
  // The tables of the first scan are there; those of the second are not.
  std::string second = scan_by_scan({0, 1, 2});
  const std::vector<size_t> tables = segments(second, dht);
  ASSERT_EQ(tables.size(), 4u);
  second.erase(tables[3], segment_size(second, tables[3]));
  EXPECT_NE(reason_of(second), "");
}

TEST(Jpeg, FilesWithTooManyScansAreRefusedBeforeDecoding) {
  // 8192 x 8192 pixels, 500 scans that do nothing.
  std::string bytes = rgb_file({.progressive = true});
  const std::vector<size_t> sizes = segments(bytes, sof0 + 2);
  ASSERT_EQ(sizes.size(), 1u);
  for (const size_t at : {size_t{5}, size_t{7}}) bytes.replace(sizes[0] + at, 2, std::string("\x20\0", 2));
  const std::vector<size_t> scans = segments(bytes, sos);
  const std::string scan = bytes.substr(scans[1], scans[2] - scans[1]);
  bytes.resize(scans[1]);
  for (int i = 0; i < 499; ++i) bytes += scan;
  bytes += "\xff\xd9";
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(reason_of(bytes).rfind("it has 500 scans; at most 64", 0), 0u) << reason_of(bytes);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(1));
}

TEST(Jpeg, FilesTooShortForTheirSizeAllocateNoMemory) {
  for (const bool progressive : {false, true}) {
    std::string bytes = rgb_file({.progressive = progressive});
    const size_t size = segments(bytes, progressive ? sof0 + 2 : sof0).at(0);
    for (const size_t at : {size_t{5}, size_t{7}}) bytes.replace(size + at, 2, std::string("\x20\0", 2));
    EXPECT_NE(reason_of(bytes).find("are too few for its size"), std::string::npos) << reason_of(bytes);
    bytes.replace(size + 5, 2, "\x20\1");
    EXPECT_EQ(reason_of(bytes), "a side is not from 1 to 8192 pixels");
    bytes.replace(size + 5, 2, std::string(2, '\0'));
    EXPECT_NE(reason_of(bytes), "");
  }
}

TEST(Jpeg, UnsupportedKindsAreRefusedWithASuggestion) {
  EXPECT_EQ(
      reason_of(jpeg_file(8, 8, std::vector<uint8_t>(256), {.across = 1, .down = 1, .colors = JCS_CMYK})),
      "it is CMYK: convert it to RGB");
  EXPECT_EQ(reason_of(rgb_file({.arithmetic = true})),
            "it uses arithmetic coding: save it with Huffman coding");
  std::string deep = rgb_file();
  deep[segments(deep, sof0).at(0) + 4] = 12;
  EXPECT_EQ(reason_of(deep), "Unsupported JPEG data precision 12");
}

TEST(Jpeg, IgnoresTheOrientation) {
  // An EXIF of one entry: the first row is the right side.
  const std::string exif = std::string(
      "\xff\xe1\0\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0",
      36);
  std::string bytes = rgb_file();
  const Floats plain = rgba_of(bytes, true);
  bytes.insert(2, exif);
  EXPECT_EQ(rgba_of(bytes, true), plain);
}

TEST(Jpeg, UnusedBytesAreIgnored) {
  std::string bytes = rgb_file();
  const Floats plain = rgba_of(bytes, true);
  bytes.insert(segments(bytes, dqt).at(0), "abc");
  EXPECT_EQ(rgba_of(bytes + "behind the end", true), plain);
}

}  // namespace
}  // namespace isoshade
