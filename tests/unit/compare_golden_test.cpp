// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "runtime/compare/golden.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
using compare::Golden;
using compare::Goldens;
using support::Diagnostics;

class GoldenFile : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }

  const std::string path_ =
      (fs::path(::testing::TempDir()) / ("isoshade_hashes" + std::to_string(::getpid()) + ".json")).string();
};

Golden golden(char digit, int width = 640) {
  return {width, 360, std::string(64, digit), std::string(64, 'f')};
}

TEST_F(GoldenFile, ReadsBackWhatItWrites) {
  Goldens goldens;
  goldens["b/\"scene\".json"]["default"] = golden('1');
  goldens["a.json"]["precise"] = golden('2');
  goldens["a.json"]["default"] = golden('3');
  Diagnostics diagnostics;
  ASSERT_TRUE(compare::update_goldens(path_, goldens, diagnostics));
  const auto read = compare::read_goldens(path_, diagnostics);
  ASSERT_TRUE(read) << diagnostics.text();
  EXPECT_EQ(*read, goldens);
}

TEST_F(GoldenFile, ConcurrentUpdatesLoseNoEntry) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 16; ++i) {
    threads.emplace_back([this, i] {
      Goldens goldens;
      goldens["scene" + std::to_string(i)]["default"] = golden('1');
      Diagnostics diagnostics;
      EXPECT_TRUE(compare::update_goldens(path_, goldens, diagnostics)) << diagnostics.text();
    });
  }
  for (std::thread& thread : threads) thread.join();
  Diagnostics diagnostics;
  EXPECT_EQ(compare::read_goldens(path_, diagnostics)->size(), 16u);
}

TEST_F(GoldenFile, IsSortedAndIndented) {
  Goldens goldens;
  goldens["b.json"]["default"] = golden('1');
  goldens["a.json"]["default"] = golden('2');
  const std::string ones(64, '1'), twos(64, '2'), fs(64, 'f');
  EXPECT_EQ(compare::goldens_text(goldens),
            "{\n  \"a.json\": {\n    \"default\": {\n      \"size\": [640, 360],\n      \"image\": \"" +
                twos + "\",\n      \"encoded\": \"" + fs +
                "\"\n    }\n  },\n  \"b.json\": {\n    \"default\": {\n      \"size\": [640, 360],\n" +
                "      \"image\": \"" + ones + "\",\n      \"encoded\": \"" + fs + "\"\n    }\n  }\n}\n");
}

TEST_F(GoldenFile, MismatchNamesTheDifference) {
  Goldens goldens;
  goldens["a.json"]["default"] = golden('1');
  const auto mismatch = [&](const std::string& key, const std::string& tier, const Golden& found) {
    return compare::golden_mismatch(goldens, key, tier, found);
  };
  EXPECT_EQ(mismatch("a.json", "default", golden('1')), "");
  EXPECT_NE(mismatch("a.json", "default", golden('2')).find("the image is"), std::string::npos);
  EXPECT_NE(mismatch("a.json", "default", golden('1', 64)).find("640 x 360, not at 64 x 360"),
            std::string::npos);
  EXPECT_NE(mismatch("a.json", "fast", golden('1')).find("precision \"fast\""), std::string::npos);
  EXPECT_NE(mismatch("b.json", "default", golden('1')).find("\"b.json\""), std::string::npos);
  Golden encoded = golden('1');
  encoded.encoded = std::string(64, '0');
  EXPECT_NE(mismatch("a.json", "default", encoded).find("encoded"), std::string::npos);
}

TEST_F(GoldenFile, RejectsMalformedFiles) {
  for (const char* text : {"[]", "{\"a\": 1}", "{\"a\": {\"default\": {}}}",
                           R"({"a": {"default": {"size": [1, 1], "image": "xyz", "encoded": "xyz"}}})",
                           R"({"a": {"default": {"size": [1, 1], "image": 1, "encoded": 2}}})", "{"}) {
    write(text);
    Diagnostics diagnostics;
    EXPECT_FALSE(compare::read_goldens(path_, diagnostics)) << text;
    EXPECT_TRUE(diagnostics.has_errors());
  }
  Diagnostics diagnostics;
  EXPECT_FALSE(compare::read_goldens(path_ + ".missing", diagnostics));
  EXPECT_EQ(diagnostics.all()[0].id, support::Id::missing_file);
}

TEST(GoldenKey, DoesNotDependOnTheWorkingDirectory) {
  const std::string key = "../../graphs/scenes/a.json";
  EXPECT_EQ(compare::golden_key("./graphs/scenes/../scenes/a.json", "tests/golden/hashes.json"), key);
  const fs::path here = fs::current_path();
  EXPECT_EQ(compare::golden_key((here / "graphs/scenes/a.json").string(), "tests/golden/hashes.json"), key);
  EXPECT_EQ(compare::golden_key("graphs/scenes/a.json", (here / "tests/golden/hashes.json").string()), key);
  EXPECT_EQ(compare::golden_key("../a.json", "../hashes.json"), "a.json");
}

}  // namespace
}  // namespace isoshade
