// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <sstream>
#include <string>

namespace {

/// The last docstring before each function of compiler/functions, by the function's name.
std::map<std::string, std::string> docstrings() {
  std::map<std::string, std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(ISOSHADE_SOURCE_DIR "/compiler/functions")) {
    if (entry.path().extension() != ".h") continue;
    std::ifstream file(entry.path());
    std::string doc, line;
    const std::regex signature("(?:[A-Za-z_]+|[a-z]+<F, [N234]>) ([a-z_0-9]+)\\(.*");
    bool in_doc = false;
    while (std::getline(file, line)) {
      std::smatch match;
      const bool comment = line.starts_with("///");
      if (comment) doc = in_doc ? doc + line + '\n' : line + '\n';
      in_doc = comment;
      if (!doc.empty() && std::regex_match(line, match, signature))
        found.emplace(match[1], std::exchange(doc, ""));
    }
  }
  return found;
}

TEST(Docstrings, SayDomainAndTheErrorThatTheTableHas) {
  const std::map<std::string, std::string> docs = docstrings();
#define FUNCTION(row, signature, ulp, domain, reference, unit)                                          \
  {                                                                                                     \
    std::ostringstream error;                                                                           \
    error << "\n/// Error: " << ulp << " ULP";                                                          \
    ASSERT_TRUE(docs.contains(#row)) << #row;                                                           \
    EXPECT_NE(docs.at(#row).find(error.str()), std::string::npos) << #row << ":" << docs.at(#row);      \
    EXPECT_NE(docs.at(#row).find("\n/// Domain: "), std::string::npos) << #row << ":" << docs.at(#row); \
  }
#include "compiler/functions/functions.def"
}

}  // namespace
