// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/compare/report.h"
#include "runtime/scene/image_file.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
using backends::Image;
using support::Diagnostics;

Image image_of(float value) {
  Image image;
  image.width = 2;
  image.height = 2;
  image.rgba.assign(16, value);
  image.depth.assign(4, 0.5f);
  return image;
}

TEST(Report, HasBothImagesTheHeatMapAndAText) {
  const fs::path folder =
      fs::path(::testing::TempDir()) / ("isoshade_report" + std::to_string(::getpid())) / "deep";
  const Image a = image_of(1.0f);
  Image b = a;
  b.rgba[4] = 1.0f + 0x1p-23f;
  b.depth[3] = 0.25f;
  Diagnostics diagnostics;
  const auto comparison = compare::compare(a, b);
  ASSERT_TRUE(compare::write_report(folder.string(), {"cpu", "16 lanes", &a}, {"vulkan", "llvmpipe", &b},
                                    comparison, scene::Encoding::srgb, 1, diagnostics))
      << diagnostics.text();
  for (const char* name : {"cpu.png", "cpu.exr", "vulkan.png", "vulkan.exr"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  const auto map = scene::read_image((folder / "difference.png").string(), diagnostics);
  ASSERT_TRUE(map);
  const std::vector<float> rgba = scene::numbers_of(*map);
  const auto pixel = [&](size_t i) {
    return std::vector<float>(rgba.begin() + static_cast<ptrdiff_t>(4 * i),
                              rgba.begin() + static_cast<ptrdiff_t>(4 * i + 3));
  };
  EXPECT_EQ(pixel(0)[0], pixel(0)[2]);                 // grey: identical
  EXPECT_EQ(pixel(1), (std::vector<float>{1, 1, 0}));  // yellow: 1 ULP
  EXPECT_LT(pixel(3)[1], pixel(1)[1]);                 // redder: half the depth
  std::ifstream file(folder / "report.txt");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  EXPECT_NE(text.find("2 of 4 pixels differ"), std::string::npos) << text;
  EXPECT_NE(text.find(compare::image_hash(b)), std::string::npos) << text;
  EXPECT_NE(text.find("vulkan: llvmpipe"), std::string::npos) << text;
  fs::remove_all(folder.parent_path());
}

TEST(Report, ReportsAnUnwritableFolder) {
  const Image a = image_of(0);
  Diagnostics diagnostics;
  EXPECT_FALSE(compare::write_report("/dev/null/folder", {"a", "", &a}, {"b", "", &a}, compare::compare(a, a),
                                     scene::Encoding::srgb, 1, diagnostics));
  EXPECT_EQ(diagnostics.error_count(), 1u);
}

}  // namespace
}  // namespace isoshade
