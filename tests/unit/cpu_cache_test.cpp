// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "backends/cpu/cache.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::cpu {
namespace {

using support::Diagnostics;
using support::Id;

bool store(const Cache& cache, const std::string& name, const std::string& contents,
           Diagnostics& diagnostics) {
  const auto workshop = cache.workshop(diagnostics);
  if (!workshop) return false;
  const std::string file = workshop->path() + "/made";
  return write_file(file, contents, diagnostics) && cache.store(name, file, diagnostics);
}

bool holds(const Cache& cache, const std::string& name, const std::string& contents) {
  const auto found = cache.find(name);
  return found && read_text(*found).starts_with(contents);
}

TEST(Cache, FindsWhatWasStored) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(cache);
  EXPECT_FALSE(cache->find("entry"));
  EXPECT_TRUE(store(*cache, "entry", "the contents", diagnostics));
  EXPECT_TRUE(holds(*cache, "entry", "the contents"));
  EXPECT_EQ(count_files(folder.path()), 1);  // no workshop is left
}

TEST(Cache, DoesNotFindAnEntryThatWasCutShortOrChanged) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(store(*cache, "entry", "some contents", diagnostics));
  const std::string whole = read_text(folder / "entry");
  for (size_t length = 0; length < whole.size(); ++length) {
    write_text(folder / "entry", whole.substr(0, length));
    EXPECT_FALSE(cache->find("entry")) << length << " of " << whole.size() << " bytes";
  }
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] ^= 1;
    write_text(folder / "entry", changed);
    EXPECT_FALSE(cache->find("entry")) << "byte " << at;
  }
  EXPECT_TRUE(store(*cache, "entry", "some contents", diagnostics));
  EXPECT_TRUE(holds(*cache, "entry", "some contents"));
}

TEST(Cache, IsNeverSeenHalfWrittenByAnotherProcess) {
  const TestFolder folder;
  const std::string contents(200000, 'x');
  const auto race = [&] {
    Diagnostics diagnostics;
    const auto cache = Cache::open(folder.path(), diagnostics);
    for (int i = 0; i < 100; ++i)
      if (!store(*cache, "entry", contents, diagnostics) || !holds(*cache, "entry", contents)) return false;
    return true;
  };
  const pid_t first = start_child(race), second = start_child(race);
  EXPECT_TRUE(succeeded(first));
  EXPECT_TRUE(succeeded(second));
  EXPECT_EQ(count_files(folder.path()), 1);
}

TEST(Cache, MakesAFolderThatOnlyTheUserCanEnter) {
  const TestFolder folder;
  const TestVariable caches("XDG_CACHE_HOME", (folder / "deep/er").c_str());
  Diagnostics diagnostics;
  const auto cache = Cache::open("", diagnostics);
  ASSERT_TRUE(cache);
  EXPECT_EQ(cache->folder(), folder / "deep/er/isoshade");
  struct stat facts;
  ASSERT_EQ(stat(cache->folder().c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0700u);
}

TEST(Cache, RefusesAFolderThatOthersCanWriteTo) {
  const TestFolder folder;
  for (const mode_t mode : {0777, 0770, 0702, 01777}) {
    ASSERT_EQ(chmod(folder.path().c_str(), mode), 0);
    Diagnostics diagnostics;
    EXPECT_FALSE(Cache::open(folder.path(), diagnostics));
    ASSERT_EQ(diagnostics.all().size(), 1u);
    EXPECT_EQ(diagnostics.all()[0].id, Id::unsafe_cache);
  }
  ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
  Diagnostics diagnostics;
  EXPECT_TRUE(Cache::open(folder.path(), diagnostics));
}

TEST(Cache, RefusesAFolderOfSomeoneElse) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  const TestFolder folder;
  ASSERT_EQ(chown(folder.path().c_str(), 65534, 65534), 0);
  Diagnostics diagnostics;
  EXPECT_FALSE(Cache::open(folder.path(), diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::unsafe_cache);
}

TEST(Cache, RefusesTheUsualFolderRatherThanReplaceItWhereItIsUnsafe) {
  const TestFolder folder;
  ASSERT_EQ(mkdir((folder / "isoshade").c_str(), 0700), 0);
  ASSERT_EQ(chmod((folder / "isoshade").c_str(), 0777), 0);
  const TestVariable caches("XDG_CACHE_HOME", folder.path().c_str());
  Diagnostics diagnostics;
  EXPECT_FALSE(Cache::open("", diagnostics));
  EXPECT_EQ(diagnostics.all().at(0).id, Id::unsafe_cache);
}

TEST(Cache, WithoutAHomeIsATemporaryFolder) {
  const TestFolder folder;
  const TestVariable caches("XDG_CACHE_HOME", "relative/is/to/be/ignored"),
      temporary("TMPDIR", folder.path().c_str());
  for (const char* home : {static_cast<const char*>(nullptr), "", "/dev/null/nowhere"}) {
    const TestVariable home_variable("HOME", home);
    Diagnostics diagnostics;
    {
      const auto cache = Cache::open("", diagnostics);
      ASSERT_TRUE(cache);
      EXPECT_TRUE(cache->folder().starts_with(folder.path()));
      EXPECT_TRUE(store(*cache, "entry", "contents", diagnostics));
      EXPECT_TRUE(holds(*cache, "entry", "contents"));
    }
    EXPECT_EQ(count_files(folder.path()), 0);
  }
}

TEST(Cache, ReportsAFolderThatCannotBeMade) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Cache::open("/dev/null/nowhere", diagnostics));
  EXPECT_EQ(diagnostics.all().at(0).id, Id::unwritable_cache);
}

TEST(Cache, ReportsAFullDiskAndKeepsNothing) {
  const TestFolder folder;
  const auto run_out_of_space = [&] {
    Diagnostics diagnostics;
    const auto cache = Cache::open(folder.path(), diagnostics);
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};  // bytes of a file: writing beyond fails as a full disk does
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return false;
    // What is made fits; the checksum after it does not.
    const bool cut_in_the_seal = !store(*cache, "entry", std::string(980, 'x'), diagnostics);
    const bool cut_before = !store(*cache, "entry", std::string(2000, 'x'), diagnostics);
    return cut_in_the_seal && cut_before && !cache->find("entry") && diagnostics.all().size() == 2 &&
           diagnostics.all()[0].id == Id::unwritable_cache && diagnostics.all()[1].id == Id::unwritable_cache;
  };
  EXPECT_TRUE(succeeded(start_child(run_out_of_space)));
  EXPECT_EQ(count_files(folder.path()), 0);
}

TEST(Cache, ClearsAwayWhatACrashLeft) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  std::filesystem::create_directories(folder / "isoshade-AbCdEf/runtime");
  std::filesystem::create_directories(folder / "isoshade-ghijkl");
  const timespec long_ago[2] = {{1000000000, 0}, {1000000000, 0}};
  ASSERT_EQ(utimensat(AT_FDCWD, (folder / "isoshade-AbCdEf").c_str(), long_ago, 0), 0);
  { const auto workshop = cache->workshop(diagnostics); }
  EXPECT_FALSE(std::filesystem::exists(folder / "isoshade-AbCdEf"));
  EXPECT_TRUE(std::filesystem::exists(folder / "isoshade-ghijkl"));
}

TEST(Cache, ForgetsWhatWasUsedLongestAgo) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(store(*cache, "used", "contents", diagnostics));
  const timespec long_ago[2] = {{1000000000, 0}, {1000000000, 0}};
  utimensat(AT_FDCWD, (folder / "used").c_str(), long_ago, 0);
  for (int i = 0; i < 1200; ++i) {
    const std::string other = folder / ("other" + std::to_string(i));
    write_text(other, "");
    const timespec later[2] = {{1000000001 + i, 0}, {1000000001 + i, 0}};
    utimensat(AT_FDCWD, other.c_str(), later, 0);
  }
  EXPECT_TRUE(cache->find("used"));
  { const auto workshop = cache->workshop(diagnostics); }
  EXPECT_TRUE(cache->find("used"));
  EXPECT_FALSE(std::filesystem::exists(folder / "other0"));
  EXPECT_TRUE(std::filesystem::exists(folder / "other1199"));
  EXPECT_LE(count_files(folder.path()), 1000);
}

}  // namespace
}  // namespace isoshade::cpu
