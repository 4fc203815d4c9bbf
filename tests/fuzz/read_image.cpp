// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/support/assert.h"
#include "runtime/scene/texture.h"
#include "tests/fuzz/reader.h"

namespace isoshade {

using support::assert_that;

bool read_image(const std::string& bytes) {
  const auto header = scene::read_header(bytes);
  assert_that(header.found.has_value() == header.reason.empty(), "neither a header nor a reason");
  auto decoded = scene::decode_image(bytes);
  assert_that(decoded.found.has_value() == decoded.reason.empty(), "neither an image nor a reason");
  if (!decoded.found) return false;
  scene::FileImage& image = *decoded.found;
  assert_that(header.found.has_value(), "an image without a header");
  assert_that(header.found->width == image.width && header.found->height == image.height,
        "an image of another size");
  assert_that(header.found->bytes == image.has_bytes(), "an image of another kind");
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  assert_that(4 * image.bytes.size() + image.rgba.size() == 4 * pixels, "an image of odd size");
  assert_that(image.depth.empty() || image.depth.size() == pixels, "a depth of odd size");
  size_t ends = 0;  // a condition on each value
  for (const float depth : image.depth) ends += depth == 0;
  assert_that(ends <= pixels, "impossible");
  if (pixels > 1'000'000) return true;
  const scene::TextureLevel level = scene::linear_level(std::move(image), bytes.size() % 2 == 0);
  for (const float value : level.texels)
    assert_that(std::isnormal(value) || value == 0, "a texel that is no number");
  for (const float value : scene::half_size(level).texels)
    assert_that(std::isnormal(value) || value == 0, "a mean of texels that is no number");
  return true;
}

std::span<const Reader> readers() {
  static const Reader all[] = {png_reader, jpeg_reader, hdr_reader, exr_reader, netpbm_reader, gltf_reader};
  return all;
}

std::vector<std::string> corpus(const Reader& reader) {
  namespace fs = std::filesystem;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(ISOSHADE_CORPUS) / reader.name))
    paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<std::string> files;
  for (const fs::path& path : paths) {
    std::ifstream file(path, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return files;
}

}  // namespace isoshade
