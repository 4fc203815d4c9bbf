// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "compiler/support/visible.h"

namespace isoshade::scene {
namespace {

namespace fs = std::filesystem;

bool write_all(int descriptor, std::string_view bytes) {
  constexpr size_t most_at_once = size_t{1} << 30;
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), most_at_once));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

/// What the file would have been made with: mkstemp gives it to its owner alone.
mode_t usual_mode(const fs::path& target) {
  struct stat old {};
  if (::stat(target.c_str(), &old) == 0) return old.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

/// 0, or the errno of what failed.
int write_directly(const char* path, std::string_view bytes) {
  const int descriptor = ::open(path, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int failure = write_all(descriptor, bytes) ? 0 : errno;
  return ::close(descriptor) == 0 || failure != 0 ? failure : errno;
}

int write_through_temporary(const fs::path& target, std::string_view bytes) {
  // Not the target's name and an ending: that may be too long for a name, or for a path.
  std::string temporary = (target.parent_path() / ".isoshade-XXXXXX").string();
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) return errno;
  int failure = write_all(descriptor, bytes) ? 0 : errno;
  if (failure == 0 && ::fchmod(descriptor, usual_mode(target)) != 0) failure = errno;
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
  if (failure != 0) ::unlink(temporary.c_str());
  return failure;
}

}  // namespace

bool write_file(const std::string& path, std::string_view bytes, support::Diagnostics& diagnostics) {
  int failure = 0;
  if (path == "-") {
    std::fflush(stdout);
    failure = write_all(STDOUT_FILENO, bytes) ? 0 : errno;
  } else {
    std::error_code error;
    fs::path target(path);
    struct stat status {};
    // A link is kept, and the file that it names replaced; but /dev/stdout may name a pipe, which has no path.
    const bool special = ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
    if (!special && fs::is_symlink(target, error)) target = fs::weakly_canonical(target, error);
    const bool exists = ::stat(target.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
      failure = EISDIR;
    } else if (exists && !S_ISREG(status.st_mode)) {
      failure = write_directly(target.c_str(), bytes);
    } else if (exists && ::access(target.c_str(), W_OK) != 0) {
      failure = errno;
    } else {
      failure = write_through_temporary(target, bytes);
    }
  }
  if (failure == 0) return true;
  const std::string name = path == "-" ? "standard output" : support::quote(path);
  support::Diagnostic& report = diagnostics.report(
      support::Id::unwritable_file, "cannot write " + name + ": " + std::generic_category().message(failure));
  if (failure == ENOENT) report.note("the folder does not exist");
  return false;
}

}  // namespace isoshade::scene
