// SPDX-License-Identifier: Apache-2.0
// What `isoshade check` proves and refutes of the shipped graphs, held against a list, so that nothing that was
// proved is lost unseen. `proved_test --update` writes the list anew.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "compiler/analysis/document.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

const fs::path graphs = ISOSHADE_GRAPHS;
const fs::path list = ISOSHADE_PROVED;
bool update = false;

constexpr uint64_t most_work = 25'000'000;  ///< a second or so

/// "library/sky.json, sky" -> "proved", "refuted at node (division by zero)" or "open at node (...)".
std::map<std::string, std::string> outcomes() {
  std::map<std::string, std::string> all;
  for (const char* folder : {"library", "materials", "effects", "source_forms"}) {
    for (const auto& file : fs::recursive_directory_iterator(graphs / folder)) {
      if (file.path().extension() != ".json") continue;
      FrontEnd front_end(ISOSHADE_GRAPHS "/library");
      const auto graph = front_end.check_file(file.path().string());
      EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
      if (graph == nullptr) continue;
      const auto subjects = analysis::subjects_of(*graph, front_end.diagnostics);
      if (!subjects) continue;
      for (const analysis::Subject& subject : *subjects) {
        const analysis::Proof proof = analysis::prove(subject.tape);
        EXPECT_LE(proof.steps, most_work) << file.path() << " takes too long to prove";
        std::string outcome = proof.unproved.empty() ? "proved" : "";
        for (const analysis::Unproved& u : proof.unproved) {
          const analysis::Operation& operation = subject.tape.operations[u.operation];
          outcome += (outcome.empty() ? "" : "; ") +
                     std::string(u.counterexample.empty() ? "open at " : "refuted at ") +
                     subject.tape.places[operation.place].node + " (" + std::string(words(u.breach)) + ")";
        }
        all[fs::relative(file.path(), graphs).string() + ", " + subject.name] = outcome;
      }
    }
  }
  return all;
}

std::string text_of(const std::map<std::string, std::string>& outcomes) {
  std::string text;
  for (const auto& [subject, outcome] : outcomes) text += subject + ": " + outcome + "\n";
  return text;
}

TEST(ShippedGraphs, AreProvedAsTheListSays) {
  const std::string now = text_of(outcomes());
  if (update) std::ofstream(list, std::ios::binary) << now;
  const std::string listed = (std::stringstream() << std::ifstream(list).rdbuf()).str();
  EXPECT_EQ(now, listed) << "if nothing is lost, run proved_test --update";
}

TEST(ShippedGraphs, OfTheLibraryAreAllProved) {
  std::ifstream file(list);
  int proved = 0;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("library/")) continue;
    EXPECT_TRUE(line.ends_with(": proved")) << line;
    ++proved;
  }
  EXPECT_GE(proved, 9);
}

}  // namespace
}  // namespace isoshade

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  isoshade::update = argc > 1 && std::string(argv[1]) == "--update";
  return RUN_ALL_TESTS();
}
