// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/read_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/magic.h>
#include <mutex>
#include <new>
#include <set>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>
#include <utility>

namespace isoshade::support {
namespace {

using Identity = std::pair<dev_t, ino_t>;

struct FilesRead {
  std::mutex mutex;
  std::set<Identity> files;
};

/// One set for the process, so that every writer knows what any reader has read.
FilesRead& files_read() {
  static FilesRead only;
  return only;
}

FileBytes failed(int failure) {
  const bool missing = failure == ENOENT || failure == ENOTDIR || failure == ENAMETOOLONG;
  return {{}, missing ? Id::missing_file : Id::unreadable_file, std::strerror(failure)};
}

/// What kind of file it is if it may not be read ("a folder"); empty if it may.
std::string_view refuse(const std::string& path, const struct stat& facts, Pipes pipes) {
  if (S_ISREG(facts.st_mode)) return "";
  if (S_ISFIFO(facts.st_mode)) {
    struct statfs system;
    const bool nameless = statfs(path.c_str(), &system) == 0 && system.f_type == PIPEFS_MAGIC;
    if (nameless && pipes == Pipes::nameless) return "";
  }
  if (S_ISDIR(facts.st_mode)) return "a folder";
  if (S_ISFIFO(facts.st_mode)) return "a pipe";
  if (S_ISSOCK(facts.st_mode)) return "a socket";
  return "a device";
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

FileBytes read_open_file(int descriptor, size_t most_bytes) {
  try {
    std::string bytes;
    struct stat facts;
    if (fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode)) {
      if (static_cast<uint64_t>(facts.st_size) <= most_bytes)
        bytes.reserve(static_cast<size_t>(facts.st_size));
    }
    // Read to the end instead of trusting the size: pipes have none, and files grow.
    char part[1 << 16];
    while (bytes.size() <= most_bytes) {
      const ssize_t n = read(descriptor, part, sizeof part);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return failed(errno);
      if (n == 0) return {std::move(bytes), {}, {}};
      bytes.append(part, static_cast<size_t>(n));
    }
  } catch (const std::bad_alloc&) { return {{}, Id::too_large, "there is not enough memory"}; }
  return {{}, Id::too_large, "it has more than " + std::to_string(most_bytes >> 20) + " MiB"};
}

FileBytes read_file(const std::string& path, size_t most_bytes, Pipes pipes) {
  // The system would open the path up to the NUL.
  if (path.find('\0') != std::string::npos) return {{}, Id::missing_file, "the name has a NUL byte"};
  struct stat facts;
  if (stat(path.c_str(), &facts) != 0) return failed(errno);
  const auto refused = [&]() -> FileBytes {
    const std::string_view what = refuse(path, facts, pipes);
    if (what.empty()) return {};
    return {{}, Id::unreadable_file, "it is not a regular file but " + std::string(what)};
  };
  if (FileBytes answer = refused(); !answer.reason.empty()) return answer;
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (file.number() < 0 || fstat(file.number(), &facts) != 0) return failed(errno);
  if (FileBytes answer = refused(); !answer.reason.empty()) return answer;  // replaced since stat()
  fcntl(file.number(), F_SETFL, O_RDONLY);  // reads must wait for a pipe's writer
  if (S_ISREG(facts.st_mode)) {
    const std::lock_guard lock(files_read().mutex);
    files_read().files.insert({facts.st_dev, facts.st_ino});
  }
  return read_open_file(file.number(), most_bytes);
}

bool was_read(const std::string& path) {
  struct stat facts;
  if (stat(path.c_str(), &facts) != 0) return false;
  const std::lock_guard lock(files_read().mutex);
  return files_read().files.contains({facts.st_dev, facts.st_ino});
}

}  // namespace isoshade::support
