// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "compiler/support/read_file.h"
#include "compiler/support/temporary.h"

namespace isoshade::support {
namespace {

constexpr size_t most = 1 << 20;

TEST(ReadFile, RejectsNonRegularFilesWithoutOpeningThem) {
  const auto folder = TemporaryFolder::make(temporary_parent());
  ASSERT_TRUE(folder);
  const std::string pipe = folder->path() + "/pipe", link = folder->path() + "/link",
                    socket_path = folder->path() + "/socket";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink("pipe", link);
  const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  close(listener);
  const std::pair<std::string, const char*> files[] = {
      {pipe, "a pipe"},          {link, "a pipe"},
      {socket_path, "a socket"}, {folder->path(), "a folder"},
      {"/dev/zero", "a device"}, {"/dev/null", "a device"}};
  for (const auto& [path, what] : files) {
    for (const Pipes pipes : {Pipes::refused, Pipes::nameless}) {
      const FileBytes read = read_file(path, most, pipes);
      EXPECT_FALSE(read.bytes) << path;
      EXPECT_EQ(read.id, Id::unreadable_file) << path;
      EXPECT_NE(read.reason.find(what), std::string::npos) << path << ": " << read.reason;
    }
  }
}

TEST(ReadFile, ReadsNamelessPipesOnlyIfAllowed) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "text", 4), 4);
  close(ends[1]);
  const std::string path = "/dev/fd/" + std::to_string(ends[0]);
  EXPECT_FALSE(read_file(path, most).bytes);
  EXPECT_EQ(read_file(path, most, Pipes::nameless).bytes, "text");
  close(ends[0]);
}

TEST(ReadFile, RecognizesFilesItHasRead) {
  const auto folder = TemporaryFolder::make(temporary_parent());
  ASSERT_TRUE(folder);
  const std::string read = folder->path() + "/read", other = folder->path() + "/other";
  std::ofstream(read) << "text";
  std::ofstream(other) << "text";
  EXPECT_FALSE(was_read(read));
  EXPECT_EQ(read_file(read, most).bytes, "text");
  std::filesystem::create_symlink("read", folder->path() + "/link");
  std::filesystem::create_hard_link(read, folder->path() + "/second");
  for (const char* name : {"/read", "/link", "/second", "/./read"})
    EXPECT_TRUE(was_read(folder->path() + name)) << name;
  EXPECT_FALSE(was_read(other));
  EXPECT_FALSE(was_read(folder->path() + "/absent"));
}

TEST(ReadFile, ReportsWhyReadingFails) {
  EXPECT_EQ(read_file("no/such/file", most).id, Id::missing_file);
  EXPECT_EQ(read_file(std::string("a\0b", 3), most).id, Id::missing_file);
  EXPECT_EQ(read_file("/proc/self/exe", 1000).id, Id::too_large);
}

}  // namespace
}  // namespace isoshade::support
