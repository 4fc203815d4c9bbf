// SPDX-License-Identifier: Apache-2.0
// Every function, effect and post under graphs/ is proved by `isoshade check`. The textbook forms of source_forms may
// be refuted: what is wrong with them is why they are there.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "compiler/prove/document.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

const fs::path graphs = ISOSHADE_GRAPHS;

constexpr uint64_t most_work = 25'000'000;  ///< a second or so

bool is_graph(const fs::path& path) {
  const std::string text = (std::stringstream() << std::ifstream(path).rdbuf()).str();
  return text.find("\"scene\":") == std::string::npos && text.find("\n  \"image\":") == std::string::npos;
}

/// Paths below graphs/, in order.
std::vector<std::string> documents() {
  std::vector<std::string> paths;
  for (const auto& file : fs::recursive_directory_iterator(graphs)) {
    const fs::path path = fs::relative(file.path(), graphs);
    if (path.extension() == ".json" && *path.begin() != "schema" && is_graph(file.path()))
      paths.push_back(path.string());
  }
  std::ranges::sort(paths);
  return paths;
}

class ShippedGraph : public testing::TestWithParam<std::string> {};

/// "proved", "refuted at node (division by zero)" or "open at node (...)".
std::string outcome_of(const prove::Subject& subject) {
  const prove::Proof proof = prove::prove(subject.tape);
  EXPECT_LE(proof.steps, most_work) << subject.name << " takes too long to prove";
  if (proof.vacuous) return "vacuous";
  std::string outcome = proof.unproved.empty() ? "proved" : "";
  for (const prove::Unproved& u : proof.unproved) {
    const prove::Operation& operation = subject.tape.operations[u.operation];
    outcome += (outcome.empty() ? "" : "; ") +
               std::string(u.counterexample.empty() ? "open at " : "refuted at ") +
               subject.tape.places[operation.place].node + " (" + std::string(words(u.breach)) + ")";
  }
  return outcome;
}

TEST_P(ShippedGraph, IsProved) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  const auto graph = front_end.check_file((graphs / GetParam()).string());
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics);
  ASSERT_TRUE(subjects) << front_end.diagnostics.text();
  for (const prove::Subject& subject : *subjects) {
    const std::string outcome = outcome_of(subject);
    if (GetParam().starts_with("source_forms/"))
      EXPECT_EQ(outcome.find("open at"), std::string::npos) << subject.name << ": " << outcome;
    else
      EXPECT_EQ(outcome, "proved") << subject.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Graphs, ShippedGraph, testing::ValuesIn(documents()), [](const auto& info) {
  std::string name = fs::path(info.param).replace_extension().string();
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

TEST(ShippedGraphs, SourceFormOfGgxIsRefutedAtItsDivision) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  const auto graph = front_end.check_file((graphs / "source_forms/ggx_d.json").string());
  ASSERT_NE(graph, nullptr);
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics);
  EXPECT_EQ(outcome_of(subjects->front()), "refuted at d (division by zero)");
}

}  // namespace
}  // namespace isoshade
