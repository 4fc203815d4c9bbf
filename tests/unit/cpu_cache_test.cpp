// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <set>
#include <sys/resource.h>
#include <sys/stat.h>

#include "backends/cache.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::cpu {
namespace {

using backends::Cache;
using backends::CacheContents;
using backends::CacheLimit;
using backends::write_file;
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

TEST(Cache, FindsStoredEntries) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(cache);
  EXPECT_FALSE(cache->find("entry"));
  EXPECT_TRUE(store(*cache, "entry", "the contents", diagnostics));
  EXPECT_TRUE(holds(*cache, "entry", "the contents"));
  EXPECT_EQ(count_files(folder.path()), 1);  // no workshop is left
}

TEST(Cache, IgnoresTruncatedAndModifiedEntries) {
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

TEST(Cache, DeletesEntriesLargerThanTheWholeCacheWithoutReadingThem) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(store(*cache, "entry", "some contents", diagnostics));
  std::filesystem::resize_file(folder / "entry", CacheLimit{}.bytes + 1);  // sparse: it takes no room on the disk
  EXPECT_FALSE(cache->find("entry"));
  EXPECT_EQ(count_files(folder.path()), 0);
  EXPECT_TRUE(store(*cache, "entry", "some contents", diagnostics));
  EXPECT_TRUE(holds(*cache, "entry", "some contents"));
}

TEST(Cache, IgnoresEntriesUnderAnotherName) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  ASSERT_TRUE(store(*cache, "first", "the first", diagnostics));
  ASSERT_TRUE(store(*cache, "second", "the second", diagnostics));
  write_text(folder / "second", read_text(folder / "first"));
  EXPECT_TRUE(cache->find("first"));
  EXPECT_FALSE(cache->find("second"));
}

TEST(Cache, StoresEntriesAtomicallyAcrossProcesses) {
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

TEST(Cache, CreatesAFolderPrivateToTheUser) {
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

/// Opens the folder and finds that it is not used, with a warning.
void expect_unsafe(const std::string& folder) {
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder, diagnostics);
  ASSERT_TRUE(cache) << "work goes on without a cache";
  EXPECT_NE(cache->folder(), folder);
  EXPECT_TRUE(store(*cache, "entry", "contents", diagnostics));
  EXPECT_TRUE(holds(*cache, "entry", "contents"));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::unsafe_cache);
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST(Cache, RejectsFoldersWritableByOthers) {
  const TestFolder folder;
  for (const mode_t mode : {0777, 0770, 0702, 01777}) {
    ASSERT_EQ(chmod(folder.path().c_str(), mode), 0);
    expect_unsafe(folder.path());
    EXPECT_EQ(count_files(folder.path()), 0);
  }
  ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
  Diagnostics diagnostics;
  EXPECT_EQ(Cache::open(folder.path(), diagnostics)->folder(), folder.path());
}

TEST(Cache, RejectsFoldersThatOthersCanReplace) {
  const TestFolder folder;
  const std::string inner = folder / "open/to/all/cache";
  std::filesystem::create_directories(inner);
  ASSERT_EQ(chmod((folder / "open").c_str(), 0777), 0);
  expect_unsafe(inner);
  ASSERT_EQ(chmod((folder / "open").c_str(), 01777),
            0);  // in a sticky folder only owners replace what is theirs
  Diagnostics diagnostics;
  EXPECT_EQ(Cache::open(inner, diagnostics)->folder(), inner);
}

TEST(Cache, RejectsFoldersOwnedByOthers) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  const TestFolder folder;
  ASSERT_EQ(chown(folder.path().c_str(), 65534, 65534), 0);
  expect_unsafe(folder.path());
}

TEST(Cache, DoesNotFollowSymlinks) {
  const TestFolder folder;
  ASSERT_EQ(mkdir((folder / "precious").c_str(), 0700), 0);
  const std::string key(64, 'a');
  write_text(folder / "precious/" + Cache::entry_name(key), "something");
  std::filesystem::create_symlink("precious", folder / "link");
  expect_unsafe(folder / "link");
  // Nor as an entry, nor as a workshop.
  Diagnostics diagnostics;
  ASSERT_EQ(mkdir((folder / "cache").c_str(), 0700), 0);
  const auto cache = Cache::open(folder / "cache", diagnostics);
  const std::string name = Cache::entry_name(std::string(64, 'b'));
  ASSERT_TRUE(store(*cache, name, "contents", diagnostics));
  std::filesystem::rename(folder / "cache/" + name, folder / "elsewhere");
  std::filesystem::create_symlink("../elsewhere", folder / "cache/" + name);
  EXPECT_FALSE(cache->find(name));
  std::filesystem::create_symlink("../precious", folder / "cache/isoshade-AbCdEf");
  const timespec long_ago[2] = {{1000000000, 0}, {1000000000, 0}};
  ASSERT_EQ(utimensat(AT_FDCWD, (folder / "precious").c_str(), long_ago, 0), 0);
  { const auto workshop = cache->workshop(diagnostics, {0, 0}); }
  cache->clear();
  EXPECT_TRUE(std::filesystem::exists(folder / "elsewhere"));
  EXPECT_EQ(count_files(folder / "precious"), 1);
  EXPECT_TRUE(store(*cache, name, "contents", diagnostics)) << diagnostics.text();
  EXPECT_TRUE(holds(*cache, name, "contents"));
}

TEST(Cache, DeletesOnlyItsOwnFiles) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  const std::string key = std::string(63, '0');
  for (const std::string& other : {std::string("photo.jpg"), std::string("a.so"), key + ".so", key + "0.sow",
                                   key + "G.so", key + "0.txt", std::string("isoshade-AbCdEf")})
    write_text(folder / other, "precious");
  std::filesystem::create_directories(folder / "isoshade-notes of mine");
  const timespec long_ago[2] = {{1000000000, 0}, {1000000000, 0}};
  utimensat(AT_FDCWD, (folder / "isoshade-notes of mine").c_str(), long_ago, 0);
  for (const char last : {'1', '2', '3'})
    ASSERT_TRUE(store(*cache, Cache::entry_name(key + last), "contents", diagnostics));
  EXPECT_EQ(cache->contents().entries, 3u);
  { const auto workshop = cache->workshop(diagnostics, {2, 1000000}); }
  EXPECT_EQ(cache->contents().entries, 1u);
  EXPECT_EQ(cache->clear().entries, 0u);
  EXPECT_EQ(count_files(folder.path()), 8);
}

TEST(Cache, StaysWithinItsSizeLimit) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  for (const char last : {'1', '2', '3', '4'})
    ASSERT_TRUE(
        store(*cache, Cache::entry_name(std::string(63, '0') + last), std::string(1000, 'x'), diagnostics));
  EXPECT_GT(cache->contents().bytes, 4000u);
  { const auto workshop = cache->workshop(diagnostics, {1000, 3000}); }
  EXPECT_EQ(cache->contents().entries, 1u);
}

TEST(Cache, CountsItsEntriesByKind) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  std::set<std::string_view> names;
  for (size_t k = 0; k < backends::entry_kinds; ++k) {
    const auto kind = static_cast<backends::EntryKind>(k);
    EXPECT_TRUE(names.insert(backends::name(kind)).second) << "two kinds have one name";
    for (size_t i = 0; i <= k; ++i)
      cache->keep(Cache::entry_name(std::string(64, static_cast<char>('0' + i)), kind), "contents");
  }
  const CacheContents held = cache->contents();
  size_t sum = 0;
  for (size_t k = 0; k < backends::entry_kinds; ++k) {
    EXPECT_EQ(held.of_kind[k], k + 1);
    sum += held.of_kind[k];
  }
  EXPECT_EQ(held.entries, sum);
  EXPECT_EQ(cache->clear().entries, 0u);
}

TEST(Cache, ReplacesPipesAndFoldersInPlaceOfEntries) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  const std::string name = Cache::entry_name(std::string(64, 'a')), path = folder / name;
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_FALSE(cache->find(name));
  EXPECT_TRUE(store(*cache, name, "contents", diagnostics));
  EXPECT_TRUE(holds(*cache, name, "contents"));
  std::filesystem::remove(path);
  std::filesystem::create_directories(path + "/full/of");
  EXPECT_FALSE(cache->find(name));
  EXPECT_TRUE(store(*cache, name, "contents", diagnostics)) << diagnostics.text();
  EXPECT_TRUE(holds(*cache, name, "contents"));
  ASSERT_EQ(chmod(path.c_str(), 0666), 0);
  EXPECT_FALSE(cache->find(name)) << "others may have written it";
  EXPECT_EQ(count_files(folder.path()), 1);
}

TEST(Cache, UsesATemporaryFolderWithoutAHome) {
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

TEST(Cache, ReportsFoldersThatCannotBeCreated) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Cache::open("/dev/null/nowhere", diagnostics));
  EXPECT_EQ(diagnostics.all().at(0).id, Id::unwritable_cache);
}

TEST(Cache, ReportsAFullDiskAndKeepsNoPartialEntry) {
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

TEST(Cache, RemovesLeftoversOfACrash) {
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

std::string entry_number(int i) {
  const std::string digits = std::to_string(i);
  return Cache::entry_name(std::string(64 - digits.size(), '0') + digits);
}

TEST(Cache, EvictsLeastRecentlyUsedEntries) {
  const TestFolder folder;
  Diagnostics diagnostics;
  const auto cache = Cache::open(folder.path(), diagnostics);
  const std::string used = Cache::entry_name(std::string(64, 'a'));
  ASSERT_TRUE(store(*cache, used, "contents", diagnostics));
  const timespec long_ago[2] = {{1000000000, 0}, {1000000000, 0}};
  utimensat(AT_FDCWD, (folder / used).c_str(), long_ago, 0);
  for (int i = 0; i < 1200; ++i) {
    const std::string other = folder / entry_number(i);
    write_text(other, "");
    const timespec later[2] = {{1000000001 + i, 0}, {1000000001 + i, 0}};
    utimensat(AT_FDCWD, other.c_str(), later, 0);
  }
  EXPECT_TRUE(cache->find(used));
  { const auto workshop = cache->workshop(diagnostics); }
  EXPECT_TRUE(cache->find(used));
  EXPECT_FALSE(std::filesystem::exists(folder / entry_number(0)));
  EXPECT_TRUE(std::filesystem::exists(folder / entry_number(1199)));
  EXPECT_LE(count_files(folder.path()), 1000);
}

}  // namespace
}  // namespace isoshade::cpu
