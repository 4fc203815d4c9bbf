// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/temporary.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "compiler/support/leftovers.h"

namespace isoshade::support {
namespace {

constexpr std::string_view folder_prefix = "isoshade-";
constexpr std::string_view filler = "XXXXXX";

/// The bits of a mode that new files do not get. Other threads may create files: umask() would change theirs too.
mode_t mode_mask() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "Umask:") {
      unsigned mask = 0;
      if (status >> std::oct >> mask) return static_cast<mode_t>(mask);
    }
  return 077;
}

void forget(const std::string& path) {
  const auto lock = Leftovers::lock();
  Leftovers::remove_path(path);
}

}  // namespace

std::string temporary_parent() {
  const char* parent = std::getenv("TMPDIR");
  return parent != nullptr && *parent == '/' ? parent : "/tmp";
}

std::string_view write_failure_fix(int failure) {
  switch (failure) {
    case ENOSPC: return "free space on the disk, or choose a folder on another one";
    case EDQUOT: return "your disk quota is used up: free space, or choose a folder on another disk";
    case EFBIG: return "the file exceeds the limit on file sizes: raise it (ulimit -f)";
    case EROFS: return "the disk is mounted read-only: choose a folder on another one";
    case EACCES:
    case EPERM: return "you have no permission to write there: choose another folder, or change its permissions";
    case ENAMETOOLONG: return "choose a shorter name";
    case ELOOP: return "the symbolic links form a loop: give the path of the file itself";
    default: return {};
  }
}

std::optional<TemporaryFolder> TemporaryFolder::make(const std::string& parent) {
  std::string path = parent + "/" + std::string(folder_prefix) + std::string(filler);
  const auto lock = Leftovers::lock();
  if (mkdtemp(path.data()) == nullptr) return std::nullopt;
  Leftovers::add_path(path);
  return TemporaryFolder(std::move(path));
}

TemporaryFolder::~TemporaryFolder() {
  if (!path_) return;
  std::error_code ignored;
  std::filesystem::remove_all(*path_, ignored);
  forget(*path_);
}

bool TemporaryFolder::is_name(const std::string& name) {
  return name.size() == folder_prefix.size() + filler.size() && name.starts_with(folder_prefix) &&
         std::all_of(name.begin() + folder_prefix.size(), name.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
         });
}

TemporaryFile::TemporaryFile(const std::string& folder) : folder_(folder.empty() ? "." : folder) {
  if (access("/proc/self/fd", X_OK) == 0) {  // take_name() links the file through it
    descriptor_ = open(folder_.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) return;
  }
  // Some file systems lack O_TMPFILE, with various errors; mkostemp meets a genuine error again.
  std::string path = folder_ + "/.isoshade-" + std::string(filler);
  const mode_t mask = mode_mask();
  const auto lock = Leftovers::lock();
  descriptor_ = mkostemp(path.data(), O_CLOEXEC);
  if (descriptor_ < 0) return;
  Leftovers::add_path(path);
  name_ = std::move(path);
  (void)fchmod(descriptor_, 0666 & ~mask);  // mkostemp creates it with mode 0600
}

TemporaryFile::~TemporaryFile() {
  close_file();
  if (name_.empty()) return;
  unlink(name_.c_str());
  forget(name_);
}

bool TemporaryFile::close_file() {
  const int descriptor = std::exchange(descriptor_, -1);
  return descriptor < 0 || close(descriptor) == 0;
}

/// Gives a nameless file an unused name.
bool TemporaryFile::take_name() {
  if (!name_.empty()) return true;
  const std::string open_file = "/proc/self/fd/" + std::to_string(descriptor_);
  constexpr int most_attempts = 100;
  const auto lock = Leftovers::lock();
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    // Not mkstemp: it would create the file, and linkat fails if the name exists.
    std::string path = folder_ + "/.isoshade-" + std::to_string(getpid()) + "-" + std::to_string(attempt);
    if (linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      Leftovers::add_path(path);
      name_ = std::move(path);
      return true;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

bool TemporaryFile::rename_to(const std::string& path) {
  if (!take_name() || !close_file() || rename(name_.c_str(), path.c_str()) != 0) return false;
  forget(name_);
  name_.clear();
  return true;
}

}  // namespace isoshade::support
