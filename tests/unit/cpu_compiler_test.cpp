// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "backends/cpu/compiler.h"
#include "compiler/support/process.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::cpu {
namespace {

using support::Diagnostics;
using support::Id;

void write_script(const std::string& path, const std::string& commands) {
  write_text(path, "#!/bin/sh\n" + commands + "\n");
  ASSERT_EQ(chmod(path.c_str(), 0755), 0);
}

TEST(Process, PassesArgumentsVerbatim) {
  const auto end = support::run_process({"/bin/echo", "a b", "$(exit)", ";", "*", "'\"", ""});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 0);
  EXPECT_EQ(end->output, "a b $(exit) ; * '\" \n");
}

TEST(Process, ReportsExitStatusAndOutput) {
  EXPECT_EQ(support::run_process({"/bin/sh", "-c", "echo words >&2; exit 3"})->status, 3);
  EXPECT_EQ(support::run_process({"/bin/sh", "-c", "echo words >&2; exit 3"})->output, "words\n");
  EXPECT_EQ(support::run_process({"/bin/sh", "-c", "kill -9 $$"})->status, 128 + 9);
  EXPECT_EQ(support::run_process({"/bin/sh", "-c", "echo $NAME"}, {{"NAME", "value"}})->output, "value\n");
  EXPECT_FALSE(support::run_process({"/no/such/program"}));
}

TEST(Process, DoesNotBlockOnInputOrLargeOutput) {
  const auto end = support::run_process({"/bin/sh", "-c", "cat; head -c 1000000 /dev/zero; echo end >&2"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 0);
  EXPECT_EQ(end->output.size(), 64u * 1024);
}

TEST(Compiler, IsTheNamedOne) {
  const TestFolder folder;
  write_script(folder / "named", "echo named compiler 1.0");
  write_script(folder / "c++", "echo first compiler 1.0");
  const TestVariable path("PATH", folder.path().c_str());
  {
    const TestVariable variable("ISOSHADE_CXX", nullptr);
    Diagnostics diagnostics;
    EXPECT_EQ(Compiler::find("", diagnostics)->version(), "first compiler 1.0");
    EXPECT_EQ(Compiler::find("named", diagnostics)->version(), "named compiler 1.0");
    EXPECT_EQ(Compiler::find(folder / "named", diagnostics)->path(), folder / "named");
  }
  const TestVariable variable("ISOSHADE_CXX", "named");
  Diagnostics diagnostics;
  EXPECT_EQ(Compiler::find("", diagnostics)->version(), "named compiler 1.0");
  EXPECT_EQ(Compiler::find("c++", diagnostics)->version(), "first compiler 1.0");
}

TEST(Compiler, ReportsAMissingCompiler) {
  const TestFolder folder;
  const TestVariable variable("ISOSHADE_CXX", nullptr), path("PATH", folder.path().c_str());
  write_text(folder / "c++", "not a program");
  write_script(folder / "broken", "exit 1");
  for (const std::string& name :
       {std::string(), std::string("g++"), folder / "absent", folder.path(), folder / "broken"}) {
    Diagnostics diagnostics;
    EXPECT_FALSE(Compiler::find(name, diagnostics)) << name;
    ASSERT_EQ(diagnostics.all().size(), 1u);
    EXPECT_EQ(diagnostics.all()[0].id, Id::no_compiler);
  }
}

TEST(Compiler, IsNotSearchedInTheWorkingDirectory) {
  const TestFolder folder;
  write_script(folder / "c++", "echo compiler 1.0");
  const std::string here = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const TestVariable variable("ISOSHADE_CXX", nullptr), path("PATH", ":.:");
  Diagnostics diagnostics;
  EXPECT_FALSE(Compiler::find("", diagnostics));
  std::filesystem::current_path(here);
}

TEST(Compiler, IdentityChangesWhenReplaced) {
  const TestFolder folder;
  Diagnostics diagnostics;
  write_script(folder / "c++", "echo compiler 1.0");
  const std::string first = Compiler::find(folder / "c++", diagnostics)->identity();
  EXPECT_EQ(Compiler::find(folder / "c++", diagnostics)->identity(), first);
  write_script(folder / "c++", "echo compiler 1.1");
  EXPECT_NE(Compiler::find(folder / "c++", diagnostics)->identity(), first);
}

TEST(Compiler, ReportsCompileErrors) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto compiler = Compiler::find("", diagnostics);
  ASSERT_TRUE(compiler) << diagnostics.text();
  write_text(folder / "program.cpp", "this is no program\n");
  EXPECT_FALSE(compiler->compile(folder.path(), "the program", *lane_count("4"), diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::compiler_failed);
  EXPECT_NE(diagnostics.text().find("program.cpp:1:1"), std::string::npos) << diagnostics.text();
}

TEST(Compiler, FailureIsReportedWithItsOutputAndAFix) {
  const TestFolder folder;
  const std::pair<const char*, const char*> endings[] = {{"echo first; echo second; exit 1", "second"},
                                                         {"kill -9 $$", "signal 9"},
                                                         {"exit 0", "wrote no program"}};
  for (const auto& [commands, words] : endings) {
    write_script(folder / "c++",
                 std::string("[ \"$1\" = --version ] && echo compiler 1.0 && exit\n") + commands);
    Diagnostics diagnostics;
    const auto compiler = Compiler::find(folder / "c++", diagnostics);
    ASSERT_TRUE(compiler) << diagnostics.text();
    EXPECT_FALSE(compiler->compile(folder.path(), "the program", *lane_count("4"), diagnostics));
    const std::string text = diagnostics.text();
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_NE(text.find("ISOSHADE_CXX"), std::string::npos) << text;
    EXPECT_EQ(text.find("\\x0a"), std::string::npos) << "lines stand on lines of their own: " << text;
  }
}

TEST(Compiler, IsEndedAfterTheTimeout) {
  const TestFolder folder;
  write_script(folder / "c++", "[ \"$1\" = --version ] && echo compiler 1.0 && exit\nsleep 100 & sleep 100");
  Diagnostics diagnostics;
  const auto compiler = Compiler::find(folder / "c++", diagnostics, support::Seconds(0.5));
  ASSERT_TRUE(compiler) << diagnostics.text();
  EXPECT_FALSE(
      compiler->compile(folder.path(), "the pixel program of \"a.json\"", *lane_count("4"), diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::compiler_failed);
  EXPECT_NE(diagnostics.text().find("did not compile the pixel program of \"a.json\" within 0.5 seconds"),
            std::string::npos)
      << diagnostics.text();
  write_script(folder / "c++", "sleep 100");
  EXPECT_FALSE(Compiler::find(folder / "c++", diagnostics, support::Seconds(0.5)));
  EXPECT_EQ(diagnostics.all().back().id, Id::no_compiler);
}

TEST(Compiler, ReportsAFullDisk) {
  const TestFolder folder;
  write_script(
      folder / "c++",
      "[ \"$1\" = --version ] && echo compiler 1.0 && exit\necho 'a.s: No space left on device'; exit 1");
  Diagnostics diagnostics;
  const auto compiler = Compiler::find(folder / "c++", diagnostics);
  EXPECT_FALSE(compiler->compile(folder.path(), "the program", *lane_count("4"), diagnostics));
  EXPECT_NE(diagnostics.text().find("free space on the disk"), std::string::npos) << diagnostics.text();
}

TEST(LaneCount, WidestIsAvailableAndUnknownNamesAreRejected) {
  EXPECT_TRUE(widest_lane_count().available());
  for (const LaneCount& lanes : lane_counts()) {
    EXPECT_EQ(lane_count(lanes.name)->name, lanes.name);
    if (lanes.available()) {
      EXPECT_LE(lanes.lanes * lanes.registers, widest_lane_count().lanes * widest_lane_count().registers);
    }
  }
  EXPECT_TRUE(lane_count("1")->available());
  EXPECT_TRUE(lane_count("4")->available());
  for (const char* wrong : {"", "0", "2", "32", "4x2", "16x", "x2", " 8"})
    EXPECT_FALSE(lane_count(wrong)) << wrong;
}

}  // namespace
}  // namespace isoshade::cpu
