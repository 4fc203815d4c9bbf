// SPDX-License-Identifier: Apache-2.0
// What isoshade says of documents that are wrong, one for each diagnostic: ID.json, or ID.sh where it takes more
// than a document, and in ID.txt the message. `diagnostics_test --update` rewrites the messages and the page of
// them in docs/.
#include "compiler/support/diagnostics.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace isoshade {
namespace {

namespace fs = std::filesystem;

const fs::path folder = ISOSHADE_SOURCE "/tests/diagnostics";
const fs::path page = ISOSHADE_SOURCE "/docs/diagnostics.md";
bool update = false;

/// Diagnostics that no single document or command brings about on every machine, and the test that does.
struct Elsewhere {
  support::Id id;
  const char* test;  ///< null: it takes a device that is broken
};
constexpr Elsewhere elsewhere[] = {
    {support::Id::unfit_device, nullptr},
    {support::Id::device_failed, nullptr},
    {support::Id::broken_function, "tests/unit/check_library_test.cpp"},
    {support::Id::unproven_device, "tests/unit/vulkan_probe_test.cpp"},
    {support::Id::device_limit, "tests/unit/backend_array_limit_test.cpp"},
    {support::Id::bad_shader, "tests/unit/emit_spirv_test.cpp"},
    {support::Id::validation, "tests/unit/vulkan_backend_test.cpp"},
    {support::Id::unwritable_cache, "tests/unit/cpu_cache_test.cpp"},
    {support::Id::unloadable_code, "tests/unit/cpu_kernel_test.cpp"},
    {support::Id::not_compiled, "tests/unit/cpu_builds_test.cpp"},
    {support::Id::bad_lanes, "tests/unit/cpu_backend_test.cpp"},
    {support::Id::bad_image, "tests/unit/scene_image_file_test.cpp"},
};

std::string read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// What `isoshade check` finds out: no mistake in a document, and an exit code of its own.
bool is_finding(const std::string& id) {
  return id == support::id_text(support::Id::refuted) || id == support::id_text(support::Id::unproved);
}

/// The shell line that is to report `id`; empty if there is none.
std::string command_for(const std::string& id) {
  if (fs::exists(folder / (id + ".sh"))) return "sh ./" + id + ".sh";
  const fs::path document = folder / (id + ".json");
  if (!fs::exists(document)) return "";
  if (is_finding(id)) return "\"$ISOSHADE\" check " + id + ".json";
  const bool is_scene = read(document).find("\"scene\":") != std::string::npos;
  return is_scene ? "\"$ISOSHADE\" render " + id + ".json --backend interpreter -o \"$OUT/a.png\""
                  : "\"$ISOSHADE\" compile " + id + ".json -q -o \"$OUT\"";
}

/// What the command of `id` writes to stderr, with paths of this machine left out.
std::string message_of(const std::string& id, int& exit) {
  std::string out = (fs::temp_directory_path() / "isoshade-diagnostics-XXXXXX").string();
  if (mkdtemp(out.data()) == nullptr) return "";
  const std::string line = "cd '" + folder.string() + "' && ISOSHADE='" ISOSHADE_COMMAND "' OUT='" + out +
                           "' " + "sh -c '" +
                           [&] {
                             std::string quoted;
                             for (const char c : command_for(id))
                               quoted += c == '\'' ? "'\\''" : std::string(1, c);
                             return quoted;
                           }() +
                           "' 2>&1 >/dev/null";
  FILE* pipe = popen(line.c_str(), "r");
  std::string text;
  char buffer[4096];
  for (size_t got; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, got);
  exit = WEXITSTATUS(pclose(pipe));
  const auto hide = [&](const std::string& path, const std::string& with) {
    for (size_t at; (at = text.find(path)) != std::string::npos;) text.replace(at, path.size(), with);
  };
  hide(out, "OUT");
  hide(ISOSHADE_SOURCE "/", "");
  std::error_code error;
  fs::remove_all(out, error);
  return text;
}

support::Id id_of(const std::string& text) {
  for (const support::Id id : support::all_ids())
    if (support::id_text(id) == text) return id;
  return {};
}

std::vector<std::string> ids_here() {
  std::vector<std::string> ids;
  for (const support::Id id : support::all_ids())
    if (std::ranges::find(elsewhere, id, &Elsewhere::id) == std::end(elsewhere))
      ids.emplace_back(support::id_text(id));
  return ids;
}

class DiagnosticExample : public testing::TestWithParam<std::string> {};

TEST_P(DiagnosticExample, PrintsTheRecordedMessage) {
  const std::string& id = GetParam();
  ASSERT_NE(command_for(id), "") << "no document for " << id << ": write tests/diagnostics/" << id
                                 << ".json that is wrong in this way, then run diagnostics_test --update";
#ifndef ISOSHADE_VULKAN
  if (id == support::id_text(support::Id::no_device)) GTEST_SKIP() << "without Vulkan the message is another";
#endif
  int exit = 0;
  const std::string text = message_of(id, exit);
  EXPECT_NE(text.find("[" + id + "]"), std::string::npos) << text;
  const bool is_error = support::default_severity(id_of(id)) == support::Severity::error;
  EXPECT_EQ(exit, is_finding(id) ? 1 : is_error ? 2 : 0);
  const fs::path expected = folder / (id + ".txt");
  if (update) std::ofstream(expected, std::ios::binary) << text;
  EXPECT_EQ(text, read(expected));
}

INSTANTIATE_TEST_SUITE_P(Ids, DiagnosticExample, testing::ValuesIn(ids_here()), [](const auto& id) {
  std::string name = id.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(Diagnostics, IdsWithoutAnExampleAreTestedElsewhere) {
  for (const Elsewhere& row : elsewhere) {
    if (row.test == nullptr) continue;
    const std::string id(support::id_text(row.id));
    std::string enumerator = id;
    std::ranges::replace(enumerator, '-', '_');
    const std::string text = read(fs::path(ISOSHADE_SOURCE) / row.test);
    const bool named =
        text.find("Id::" + enumerator) != std::string::npos || text.find("[" + id + "]") != std::string::npos;
    EXPECT_TRUE(named) << row.test << " does not test " << id;
  }
}

/// Every broken document with what is said of it.
std::string page_text() {
  std::string text =
      "<!-- Made by `diagnostics_test --update` from tests/diagnostics. -->\n"
      "# Diagnostics\n\n"
      "A message names the file, line and column, shows the line, and suggests a fix. Its id, in brackets, is the\n"
      "same in all versions: scripts may match it, and `-Wno-ID` suppresses a warning. `--diagnostics json` prints\n"
      "the messages as JSON. Each section shows a broken document and its message.\n";
  for (const std::string& id : ids_here()) {
    const std::string document = read(folder / (id + ".json"));
    const bool shown = !document.empty() && document.find("\xfc") == std::string::npos;
    if (!shown || fs::exists(folder / (id + ".sh"))) continue;
    text += "\n## " + id + "\n\n" + std::string(support::meaning(id_of(id))) + "\n\n```json\n" + document +
            "```\n\n```text\n" + read(folder / (id + ".txt")) + "```\n";
  }
  return text;
}

TEST(Diagnostics, PageIsUpToDate) {
  EXPECT_TRUE(update || read(page) == page_text()) << "run diagnostics_test --update";
}

}  // namespace
}  // namespace isoshade

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  isoshade::update = argc > 1 && std::string(argv[1]) == "--update";
  const int result = RUN_ALL_TESTS();
  if (isoshade::update) std::ofstream(isoshade::page, std::ios::binary) << isoshade::page_text();
  return result;
}
