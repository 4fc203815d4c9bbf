// SPDX-License-Identifier: Apache-2.0
// The command, run in a folder of its own.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <sys/wait.h>

namespace isoshade::testing {

namespace fs = std::filesystem;

struct Outcome {
  int exit = -1;
  std::string text;  ///< standard output and standard error
};

inline Outcome run_command(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  char buffer[4096];
  for (size_t got; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.text.append(buffer, got);
  outcome.exit = WEXITSTATUS(pclose(pipe));
  return outcome;
}

inline Outcome run(const std::string& arguments) {
  return run_command(std::string(ISOSHADE_COMMAND) + " " + arguments);
}

class Cli : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "isoshade-cli-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text = "") const {
    if (!text.empty()) std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  static std::string read(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  fs::path folder_;
};

inline const std::string graphs = ISOSHADE_GRAPHS;
inline const std::string scene = graphs + "/scenes/borders.json";
inline const std::string ggx = graphs + "/library/brdf/ggx_d.json";

}  // namespace isoshade::testing
