// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "runtime/scene/output_file.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AcceptsTheLongestFileName) {
  std::string pattern = (fs::temp_directory_path() / "isoshade-output-XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  constexpr size_t most = 255;  // bytes of a name, on all usual file systems
  support::Diagnostics diagnostics;
  for (const size_t size : {size_t{248}, size_t{252}, most}) {
    const fs::path path = folder / (std::string(size - 4, 'x') + ".exr");
    EXPECT_TRUE(scene::write_file(path.string(), "some bytes", diagnostics)) << diagnostics.text();
    EXPECT_EQ(fs::file_size(path), 10u);
  }
  EXPECT_FALSE(scene::write_file((folder / std::string(most + 1, 'x')).string(), "some bytes", diagnostics));
  EXPECT_NE(diagnostics.text().find("File name too long"), std::string::npos) << diagnostics.text();
  size_t files = 0;
  for ([[maybe_unused]] const fs::directory_entry& entry : fs::directory_iterator(folder)) ++files;
  EXPECT_EQ(files, 3u) << "no temporary file is left";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace isoshade
