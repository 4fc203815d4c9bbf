// SPDX-License-Identifier: Apache-2.0
// Programs that are run, and what is left of them and of temporary files.
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "compiler/support/leftovers.h"
#include "compiler/support/process.h"
#include "compiler/support/temporary.h"

namespace isoshade::support {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Processes : public testing::Test {
 protected:
  // No TemporaryFolder: a process that a test forks off would clean it up, too.
  void SetUp() override {
    std::string pattern = temporary_parent() + "/isoshade-process-XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  size_t file_count() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }
  /// The number of a process that a script wrote to the file.
  pid_t process_in(const std::string& name) const {
    pid_t process = 0;
    for (int i = 0; i < 500 && !(std::ifstream(path(name)) >> process); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return process;
  }
  /// A process that was killed is gone when whoever inherited it has waited for it.
  static bool ends(pid_t process) {
    for (int i = 0; i < 500; ++i) {
      std::string state;
      std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
      if (!(stat >> state >> state >> state) || state == "Z") return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  std::string folder_;
};

TEST_F(Processes, AreKilledWithTheirChildrenAtTheTimeout) {
  const std::string script = "sleep 100 & echo $! >" + path("child") + "; echo words; wait";
  const auto begin = Clock::now();
  const auto end = run_process({"/bin/sh", "-c", script}, {}, Seconds(0.5));
  ASSERT_TRUE(end);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(20));
  EXPECT_TRUE(end->late);
  EXPECT_EQ(end->output, "words\n");
  EXPECT_TRUE(ends(process_in("child")));
}

TEST_F(Processes, DoNotWaitForBackgroundChildren) {
  const auto begin = Clock::now();
  const auto end = run_process({"/bin/sh", "-c", "sleep 10 & echo $! >" + path("child") + "; echo words"});
  ASSERT_TRUE(end);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(8)) << "the child holds the output open";
  EXPECT_FALSE(end->late);
  EXPECT_EQ(end->status, 0);
  EXPECT_EQ(end->output, "words\n");
  kill(process_in("child"), SIGKILL);
}

TEST_F(Processes, MayCloseTheirOutputEarly) {
  const auto end = run_process({"/bin/sh", "-c", "exec >&- 2>&-; sleep 0.2; exit 7"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 7);
  EXPECT_TRUE(run_process({"/bin/sh", "-c", "exec >&- 2>&-; sleep 100"}, {}, Seconds(0.2))->late);
}

TEST_F(Processes, EndTheirChildrenAndRemoveFoldersOnSignals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    fs::remove(path("child"));
    const pid_t process = fork();
    if (process == 0) {
      clean_up_on_signals();
      const auto folder = TemporaryFolder::make(folder_);
      std::ofstream(folder->path() + "/file") << "text";
      run_process({"/bin/sh", "-c", "sleep 100 & echo $! >" + path("child") + "; wait"});
      _exit(0);
    }
    const pid_t child = process_in("child");
    kill(process, signal);
    int status = 0;
    ASSERT_EQ(waitpid(process, &status, 0), process);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_TRUE(ends(child)) << signal;
    EXPECT_EQ(file_count(), 1u) << "only what the script wrote";
  }
}

TEST_F(Processes, KeepIgnoringIgnoredSignals) {
  const pid_t process = fork();
  if (process == 0) {
    std::signal(SIGHUP, SIG_IGN);
    clean_up_on_signals();
    kill(getpid(), SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    _exit(7);
  }
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, 0), process);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
}

TEST_F(Processes, LeaveNoPartialFileWhenKilled) {
  {
    const TemporaryFile probe(folder_);
    if (file_count() != 0) GTEST_SKIP() << "this file system has no nameless files";
  }
  const pid_t process = fork();
  if (process == 0) {
    TemporaryFile file(folder_);
    (void)!write(file.descriptor(), "half", 4);
    kill(getpid(), SIGKILL);
  }
  waitpid(process, nullptr, 0);
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(Processes, ReplaceFilesAtomically) {
  std::ofstream(path("f")) << "old";
  {
    TemporaryFile file(folder_);
    ASSERT_TRUE(file.is_open());
    ASSERT_EQ(write(file.descriptor(), "new", 3), 3);
    std::string text;
    EXPECT_TRUE(std::ifstream(path("f")) >> text && text == "old");
    EXPECT_TRUE(file.rename_to(path("f"))) << errno;
    EXPECT_TRUE(std::ifstream(path("f")) >> text && text == "new");
  }
  EXPECT_EQ(file_count(), 1u);
  const std::string longest(255, 'x');
  TemporaryFile file(folder_);
  EXPECT_TRUE(file.rename_to(path(longest))) << errno;
}

TEST(TemporaryFolders, HaveRecognizableNames) {
  const auto folder = TemporaryFolder::make(temporary_parent());
  ASSERT_TRUE(folder);
  EXPECT_TRUE(TemporaryFolder::is_name(fs::path(folder->path()).filename()));
  for (const char* other :
       {"isoshade-", "isoshade-old", "isoshade-abc.ef", "isoshade-abcdefg", "xsoshade-abcdef"})
    EXPECT_FALSE(TemporaryFolder::is_name(other)) << other;
}

}  // namespace
}  // namespace isoshade::support
