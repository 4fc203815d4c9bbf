// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "compiler/support/temporary.h"
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

/// Returns 0, or the errno of what failed.
int write_directly(const char* path, std::string_view bytes) {
  const int descriptor = ::open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) return errno;
  const int failure = write_all(descriptor, bytes) ? 0 : errno;
  return ::close(descriptor) == 0 || failure != 0 ? failure : errno;
}

/// `old`: the status of the file that is replaced; null if there is none.
int write_through_temporary(const fs::path& target, std::string_view bytes, const struct stat* old) {
  support::TemporaryFile file(target.parent_path().string());
  if (!file.is_open() || !write_all(file.descriptor(), bytes)) return errno;
  if (old != nullptr && ::fchmod(file.descriptor(), old->st_mode & 07777) != 0) return errno;
  return file.rename_to(target.string()) ? 0 : errno;
}

/// Follows symbolic links to a file, which need not exist. Returns 0, or an errno.
int follow_links(fs::path& target) {
  constexpr int most_links = 40;  // the system's limit
  std::error_code error;
  for (int i = 0; fs::is_symlink(fs::symlink_status(target, error)); ++i) {
    if (i == most_links) return ELOOP;
    const fs::path next = fs::read_symlink(target, error);
    if (error) return error.value();
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return 0;
}

int write_to(const std::string& path, std::string_view bytes) {
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  // The system may forbid following another user's link.
  if (!exists && errno != ENOENT) return errno;
  if (exists && S_ISDIR(status.st_mode)) return EISDIR;
  // Done before following links: /dev/stdout may be a pipe, which has no path.
  if (exists && !S_ISREG(status.st_mode)) return write_directly(path.c_str(), bytes);
  if (exists && ::access(path.c_str(), W_OK) != 0) return errno;
  fs::path target(path);
  if (const int failure = follow_links(target); failure != 0) return failure;
  if (!target.has_filename()) return ENOENT;
  return write_through_temporary(target, bytes, exists ? &status : nullptr);
}

}  // namespace

bool write_file(const std::string& path, std::string_view bytes, support::Diagnostics& diagnostics) {
  int failure = 0;
  if (path == "-") {
    std::fflush(stdout);
    failure = write_all(STDOUT_FILENO, bytes) ? 0 : errno;
  } else {
    failure = write_to(path, bytes);
  }
  if (failure == 0) return true;
  const std::string name = path == "-" ? "standard output" : support::quote(path);
  support::Diagnostic& report = diagnostics.report(
      support::Id::unwritable_file, "cannot write " + name + ": " + std::generic_category().message(failure));
  if (failure == ENOENT) report.note("the folder does not exist");
  report.suggest(std::string(support::write_failure_fix(failure)));
  return false;
}

}  // namespace isoshade::scene
