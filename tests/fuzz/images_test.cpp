// SPDX-License-Identifier: Apache-2.0
// Damaged pictures and meshes: each is read or refused, and what is read keeps its promises (reader.h). 2,000 of each
// kind; with ISOSHADE_FULL 50,000, or as many as ISOSHADE_DAMAGED says.
#include <chrono>
#include <cstdlib>
#include <gtest/gtest.h>
#include <ostream>

#include "tests/fuzz/reader.h"

namespace isoshade {

void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

namespace {

int count() {
  if (const char* told = std::getenv("ISOSHADE_DAMAGED"); told != nullptr) return std::atoi(told);
  return std::getenv("ISOSHADE_FULL") != nullptr ? 50'000 : 2'000;
}

class DamagedFiles : public ::testing::TestWithParam<Reader> {};

TEST_P(DamagedFiles, AreReadOrRejected) {
  const Reader& reader = GetParam();
  std::vector<std::string> files = reader.good();
  for (size_t i = 0; i < files.size(); ++i) ASSERT_TRUE(reader.read(files[i])) << "good file " << i;
  for (std::string& found : corpus(reader)) {
    reader.read(found);
    files.push_back(std::move(found));
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  int read = 0;
  for (int i = 0; i < count(); ++i) {
    const std::string bytes = reader.damaged(files, static_cast<uint32_t>(i));
    const Clock::time_point before = Clock::now();
    read += reader.read(bytes);
    ASSERT_LT(Clock::now() - before, std::chrono::seconds(10)) << "seed " << i;
  }
  std::printf("%d of %d read in %.1f s\n", read, count(),
              std::chrono::duration<double>(Clock::now() - start).count());
  EXPECT_GT(read, count() / 50);  // else the damage is too great to get beyond the headers
  EXPECT_LT(read, count());
}

INSTANTIATE_TEST_SUITE_P(Readers, DamagedFiles, ::testing::ValuesIn(readers().begin(), readers().end()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace isoshade
