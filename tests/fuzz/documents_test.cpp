// SPDX-License-Identifier: Apache-2.0
// Damaged documents through the whole compiler: each ends in a diagnostic or in programs, soon, in little memory.
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/resource.h>

#include "tests/fuzz/feed.h"
#include "tests/fuzz/mutate.h"

#if defined(__SANITIZE_ADDRESS__)
#define WITH_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITH_ASAN 1
#endif
#endif
#ifndef WITH_ASAN
#define WITH_ASAN 0
#endif

namespace isoshade {
namespace {

namespace fs = std::filesystem;

/// Shipped documents and broken ones.
std::vector<std::string> documents() {
  std::vector<fs::path> paths;
  for (const char* root : {ISOSHADE_GRAPHS, ISOSHADE_DIAGNOSTICS})
    for (const auto& entry : fs::recursive_directory_iterator(root))
      if (entry.path().extension() == ".json" && entry.file_size() < 50'000) paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<std::string> texts;
  for (const fs::path& path : paths) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    texts.push_back(text.str());
  }
  return texts;
}

double seconds_of_this_thread() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TEST(Documents, MutatedDocumentsYieldADiagnosticOrAProgram) {
  const bool full = std::getenv("ISOSHADE_FULL") != nullptr;
  const int count = full ? 100'000 : 2'000;
  Mutator mutator(documents(), 1);
  int programs = 0;
  double slowest = 0;
  for (int i = 0; i < count; ++i) {
    const std::string text = mutator.next();
    const double before = seconds_of_this_thread();
    programs += !feed(text).has_errors();
    const double took = seconds_of_this_thread() - before;
    slowest = std::max(slowest, took);
    // A hang, not a speed: the sanitizers alone make everything some ten times slower.
    ASSERT_LT(took, WITH_ASAN ? 10 : 1) << "document " << i << ":\n" << text.substr(0, 2000);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%d of %d compiled; the slowest took %.3f s; %ld MiB at most\n", programs, count, slowest,
              usage.ru_maxrss / 1024);
  if (!WITH_ASAN) {
    EXPECT_LT(usage.ru_maxrss / 1024, 500);
  }
  // The damage is of some use: some documents survive it, most do not.
  EXPECT_GT(programs, count / 100);
  EXPECT_LT(programs, count / 2);
}

}  // namespace
}  // namespace isoshade
