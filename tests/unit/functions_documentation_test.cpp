// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <sstream>
#include <string>

namespace {

using Docstrings = std::map<std::string, std::string>;

/// The last docstring before each function of compiler/functions, by the function's name: "exp2", "fast::exp2".
Docstrings docstrings() {
  Docstrings found;
  for (const auto& entry : std::filesystem::directory_iterator(ISOSHADE_SOURCE_DIR "/compiler/functions")) {
    if (entry.path().extension() != ".h") continue;
    std::ifstream file(entry.path());
    std::string doc, line, tier;
    const std::regex signature("(?:[A-Za-z_]+|[a-z]+<F, [N234]>) ([a-z_0-9]+)\\(.*");
    bool in_doc = false;
    while (std::getline(file, line)) {
      std::smatch match;
      for (const char* name : {"fast", "precise"})
        if (line == "namespace isoshade::functions::" + std::string(name) + " {")
          tier = std::string(name) + "::";
      const bool comment = line.starts_with("///");
      if (comment) doc = in_doc ? doc + line + '\n' : line + '\n';
      in_doc = comment;
      if (!doc.empty() && std::regex_match(line, match, signature))
        found.emplace(tier + match[1].str(), std::exchange(doc, ""));
    }
  }
  return found;
}

void expect_told(const Docstrings& docs, const std::string& name, double ulp) {
  std::ostringstream error;
  error << "\n/// Error: " << ulp << " ULP";
  ASSERT_TRUE(docs.contains(name)) << name;
  EXPECT_NE(docs.at(name).find(error.str()), std::string::npos) << name << ":" << docs.at(name);
  EXPECT_NE(docs.at(name).find("\n/// Domain: "), std::string::npos) << name << ":" << docs.at(name);
}

TEST(Docstrings, StateTheDomainAndTheErrorOfTheTable) {
  const Docstrings docs = docstrings();
#define FUNCTION(row, signature, ulp, domain, reference, unit) expect_told(docs, #row, ulp);
#include "compiler/functions/functions.def"
#define TIER(tier, row, ulp, domain, unit) expect_told(docs, #tier "::" #row, ulp);
#include "compiler/functions/functions.def"
}

}  // namespace
