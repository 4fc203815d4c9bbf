// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/cache.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

#include "compiler/support/sha256.h"
#include "compiler/support/visible.h"

namespace isoshade::cpu {
namespace {

namespace fs = std::filesystem;
using support::Diagnostics;
using support::Id;
using support::quote;

// After the contents of an entry: this and their SHA-256 in hex.
constexpr std::string_view seal_mark = "\nisoshade:";
constexpr size_t seal_bytes = seal_mark.size() + 64;

constexpr size_t most_entries = 1000;
constexpr auto oldest_workshop = std::chrono::hours(24);

class File {
 public:
  File(const std::string& path, int flags) : descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }

  bool read_all(std::string& text) const {
    text.clear();
    char part[65536];
    while (true) {
      const ssize_t n = ::read(descriptor_, part, sizeof part);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return n == 0;
      text.append(part, static_cast<size_t>(n));
    }
  }

  bool write_all(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t n = ::write(descriptor_, text.data(), text.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return false;
      text.remove_prefix(static_cast<size_t>(n));
    }
    return true;
  }

  bool sync() const { return fsync(descriptor_) == 0; }

  /// Some disks tell only now that they are full.
  bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

std::string reason() { return std::strerror(errno); }

bool report_unwritable(const std::string& path, Diagnostics& diagnostics) {
  const std::string why = reason();
  diagnostics.report(Id::unwritable_cache, "cannot write " + quote(path) + ": " + why);
  return false;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Empty where the user has no place of their own.
std::string usual_folder() {
  // The XDG base directory specification: a relative path is to be ignored.
  const std::string caches = variable("XDG_CACHE_HOME");
  if (caches.starts_with('/')) return caches + "/isoshade";
  const std::string home = variable("HOME");
  if (home.starts_with('/')) return home + "/.cache/isoshade";
  return "";
}

/// Makes the folder and its parents; only the owner can enter what is made.
bool make_folders(const std::string& path) {
  for (size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
    if (mkdir(path.substr(0, slash).c_str(), 0700) != 0 && errno != EEXIST) return false;
  return mkdir(path.c_str(), 0700) == 0 || errno == EEXIST;
}

enum class Folder { fit, absent, unsafe };

Folder examine(const std::string& path) {
  struct stat facts;
  if (stat(path.c_str(), &facts) != 0 || !S_ISDIR(facts.st_mode)) return Folder::absent;
  if (facts.st_uid != geteuid() || (facts.st_mode & (S_IWGRP | S_IWOTH)) != 0) return Folder::unsafe;
  return access(path.c_str(), W_OK | X_OK) == 0 ? Folder::fit : Folder::absent;
}

std::string temporary_parent() {
  const std::string parent = variable("TMPDIR");
  return parent.starts_with('/') ? parent : "/tmp";
}

/// Workshops whose process must be gone, and entries beyond the limit, oldest first. Losing an entry is
/// harmless.
void tidy(const std::string& folder) {
  std::error_code ignored;
  const fs::file_time_type now = fs::file_time_type::clock::now();
  std::vector<std::pair<fs::file_time_type, fs::path>> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const fs::file_time_type used = entry.last_write_time(ignored);
    if (entry.is_regular_file(ignored)) {
      entries.emplace_back(used, entry.path());
    } else if (entry.path().filename().string().starts_with("isoshade-") && now - used > oldest_workshop) {
      fs::remove_all(entry.path(), ignored);
    }
  }
  if (entries.size() <= most_entries) return;
  std::sort(entries.begin(), entries.end());
  entries.resize(entries.size() - most_entries / 2);
  for (const auto& [used, path] : entries) fs::remove(path, ignored);
}

}  // namespace

std::optional<TemporaryFolder> TemporaryFolder::make(const std::string& parent) {
  std::string path = parent + "/isoshade-XXXXXX";
  if (!mkdtemp(path.data())) return std::nullopt;
  return TemporaryFolder(std::move(path));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (path_) fs::remove_all(*path_, ignored);
}

std::optional<Cache> Cache::open(const std::string& folder, Diagnostics& diagnostics) {
  const std::string wanted = folder.empty() ? usual_folder() : folder;
  if (!wanted.empty() && make_folders(wanted)) {
    const Folder found = examine(wanted);
    if (found == Folder::fit) return Cache(wanted, std::nullopt);
    if (found == Folder::unsafe) {
      diagnostics
          .report(Id::unsafe_cache,
                  "the cache folder " + quote(wanted) +
                      " belongs to someone else, or others may write to it; code in it could be theirs")
          .suggest("make it yours alone (chmod go-w), or set XDG_CACHE_HOME to a folder of your own");
      return std::nullopt;
    }
  }
  if (!folder.empty()) {
    report_unwritable(folder, diagnostics);
    return std::nullopt;
  }
  std::optional<TemporaryFolder> temporary = TemporaryFolder::make(temporary_parent());
  if (!temporary) {
    report_unwritable(temporary_parent(), diagnostics);
    return std::nullopt;
  }
  std::string path = temporary->path();
  return Cache(std::move(path), std::move(temporary));
}

std::optional<std::string> Cache::find(const std::string& name) const {
  const std::string path = folder_ + "/" + name;
  const File file(path, O_RDONLY);
  if (!file.is_open()) return std::nullopt;
  std::string text;
  if (file.read_all(text) && text.size() > seal_bytes) {
    const std::string_view contents = std::string_view(text).substr(0, text.size() - seal_bytes);
    const std::string_view seal = std::string_view(text).substr(contents.size());
    if (seal == std::string(seal_mark) + support::sha256(contents)) {
      utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // used just now
      return path;
    }
  }
  return std::nullopt;
}

std::optional<TemporaryFolder> Cache::workshop(Diagnostics& diagnostics) const {
  tidy(folder_);
  std::optional<TemporaryFolder> made = TemporaryFolder::make(folder_);
  if (!made) report_unwritable(folder_, diagnostics);
  return made;
}

bool Cache::store(const std::string& name, const std::string& path, Diagnostics& diagnostics) const {
  std::string contents;
  {
    const File file(path, O_RDONLY);
    if (!file.is_open() || !file.read_all(contents)) return report_unwritable(path, diagnostics);
  }
  {
    File file(path, O_WRONLY | O_APPEND);
    const std::string seal = std::string(seal_mark) + support::sha256(contents);
    if (!file.is_open() || !file.write_all(seal) || !file.sync() || !file.close())
      return report_unwritable(path, diagnostics);
  }
  if (rename(path.c_str(), (folder_ + "/" + name).c_str()) != 0)
    return report_unwritable(folder_, diagnostics);
  return true;
}

bool write_file(const std::string& path, std::string_view text, Diagnostics& diagnostics) {
  File file(path, O_WRONLY | O_CREAT | O_TRUNC);
  if (!file.is_open() || !file.write_all(text) || !file.close()) return report_unwritable(path, diagnostics);
  return true;
}

}  // namespace isoshade::cpu
