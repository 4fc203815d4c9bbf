// SPDX-License-Identifier: Apache-2.0
#include "backends/cache.h"

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
#include <vector>

#include "compiler/support/sha256.h"
#include "compiler/support/visible.h"

namespace isoshade::backends {
namespace {

namespace fs = std::filesystem;
using support::Diagnostics;
using support::Id;
using support::quote;

// An entry ends with this and the SHA-256 of its contents in hex.
constexpr std::string_view seal_mark = "\nisoshade:";
constexpr size_t hash_digits = 64;
constexpr size_t seal_bytes = seal_mark.size() + hash_digits;
constexpr auto oldest_workshop = std::chrono::hours(24);

class File {
 public:
  File(const std::string& path, int flags)
      : descriptor_(open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0600)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }

  /// Whether it is a file that only this user may have written.
  bool is_own() const {
    struct stat facts;
    return fstat(descriptor_, &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_uid == geteuid() &&
           (facts.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  }

  uint64_t size() const {
    struct stat facts;
    return fstat(descriptor_, &facts) == 0 ? static_cast<uint64_t>(facts.st_size) : 0;
  }

  bool read_all(std::string& text) const {
    text.resize(static_cast<size_t>(size()) + 1);  // the byte more receives nothing, at the end of the file
    size_t count = 0;
    while (true) {
      if (count == text.size()) text.resize(2 * count);
      const ssize_t n = ::read(descriptor_, text.data() + count, text.size() - count);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        text.resize(count);
        return n == 0;
      }
      count += static_cast<size_t>(n);
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

  /// Some file systems report a full disk only here.
  bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

bool report_unwritable(const std::string& path, Diagnostics& diagnostics) {
  const int failure = errno;
  diagnostics.report(Id::unwritable_cache, "cannot write " + quote(path) + ": " + std::strerror(failure))
      .suggest(std::string(support::write_failure_fix(failure)));
  return false;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Creates the folder and its parents; only the owner may enter the new ones.
bool make_folders(const std::string& path) {
  for (size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
    if (mkdir(path.substr(0, slash).c_str(), 0700) != 0 && errno != EEXIST) return false;
  return mkdir(path.c_str(), 0700) == 0 || errno == EEXIST;
}

/// The reason why another user could have written code in the folder; empty if there is none.
std::string danger_of(const std::string& folder) {
  struct stat facts;
  if (lstat(folder.c_str(), &facts) != 0) return "";
  if (S_ISLNK(facts.st_mode)) return "is a symbolic link, and what it names may change";
  if (facts.st_uid != geteuid()) return "belongs to someone else";
  if ((facts.st_mode & (S_IWGRP | S_IWOTH)) != 0) return "is one that others may write to";
  std::error_code error;
  for (fs::path above = fs::canonical(folder, error).parent_path(); !error; above = above.parent_path()) {
    if (stat(above.c_str(), &facts) == 0 && (facts.st_mode & S_IWOTH) != 0 && (facts.st_mode & S_ISVTX) == 0)
      return "lies in " + quote(above.string()) + ", which others may write to";
    if (above == above.parent_path()) break;
  }
  return "";
}

bool is_usable(const std::string& folder) {
  struct stat facts;
  return lstat(folder.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) &&
         access(folder.c_str(), W_OK | X_OK) == 0;
}

constexpr std::string_view ending_of(EntryKind kind) {
  switch (kind) {
    case EntryKind::code: return ".so";
    case EntryKind::maps: return ".maps";
    case EntryKind::probe: return ".probe";
    case EntryKind::spirv: return ".spv";
    case EntryKind::pipelines: return ".pipelines";
  }
  return "";
}
static_assert(!ending_of(static_cast<EntryKind>(entry_kinds - 1)).empty() &&
              ending_of(static_cast<EntryKind>(entry_kinds)).empty());

/// Nothing if no cache gives this name.
std::optional<EntryKind> kind_of(std::string_view name) {
  if (name.size() < hash_digits || name.find_first_not_of("0123456789abcdef") != hash_digits) return std::nullopt;
  for (size_t k = 0; k < entry_kinds; ++k)
    if (name.substr(hash_digits) == ending_of(static_cast<EntryKind>(k))) return static_cast<EntryKind>(k);
  return std::nullopt;
}

constexpr std::string_view shared_ending = ".making";

/// The entry that is made in a folder of this name; empty if none is.
std::string made_in(const std::string& name) {
  if (!name.ends_with(shared_ending)) return "";
  const std::string entry = name.substr(0, name.size() - shared_ending.size());
  return kind_of(entry) ? entry : "";
}

struct Entry {
  fs::file_time_type used;
  uint64_t bytes = 0;
  fs::path path;
  EntryKind kind = EntryKind::code;
};

/// The entries and the abandoned workshops: only files whose names a cache gives; links are not followed.
struct Listing {
  explicit Listing(const std::string& folder) {
    const fs::file_time_type now = fs::file_time_type::clock::now();
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      const std::string name = at->path().filename().string();
      std::error_code gone;  // another process may delete it at any time
      const fs::file_status status = at->symlink_status(gone);
      if (gone) continue;
      if (const auto kind = kind_of(name); kind && fs::is_regular_file(status)) {
        const fs::file_time_type used = at->last_write_time(gone);
        const uint64_t bytes = gone ? 0 : at->file_size(gone);
        if (!gone) entries.push_back({used, bytes, at->path(), *kind});
      } else if (!fs::is_directory(status)) {
        continue;
      } else if (std::string entry = made_in(name); support::TemporaryFolder::is_name(name) || !entry.empty()) {
        const fs::file_time_type made = at->last_write_time(gone);
        if (gone) continue;
        if (now - made > oldest_workshop)
          abandoned.push_back(at->path());
        else if (!entry.empty())
          shared.push_back(std::move(entry));
      }
    }
  }

  CacheContents sum() const {
    CacheContents sum;
    for (const Entry& entry : entries) {
      sum.bytes += entry.bytes;
      sum.of_kind[static_cast<size_t>(entry.kind)] += 1;
    }
    sum.entries = entries.size();
    return sum;
  }

  std::vector<Entry> entries;
  std::vector<fs::path> abandoned;
  std::vector<std::string> shared;  ///< the entries that are made in shared workshops
};

void remove_abandoned(const Listing& listing) {
  std::error_code ignored;
  for (const fs::path& path : listing.abandoned) fs::remove_all(path, ignored);
}

/// Errors are ignored: losing an entry is harmless.
void tidy(const std::string& folder, const CacheLimit& limit) {
  Listing listing(folder);
  remove_abandoned(listing);
  CacheContents left = listing.sum();
  if (left.entries <= limit.entries && left.bytes <= limit.bytes) return;
  std::ranges::sort(listing.entries, {}, &Entry::used);
  for (const Entry& entry : listing.entries) {
    if (left.entries <= limit.entries / 2 && left.bytes <= limit.bytes / 2) break;
    std::error_code ignored;
    fs::remove(entry.path, ignored);
    left.entries -= 1;
    left.bytes -= entry.bytes;
  }
}

}  // namespace

std::string_view name(EntryKind kind) {
  switch (kind) {
    case EntryKind::code: return "compiled C++";
    case EntryKind::maps: return "maps of environments";
    case EntryKind::probe: return "probe results";
    case EntryKind::spirv: return "SPIR-V shaders";
    case EntryKind::pipelines: return "pipelines of Vulkan drivers";
  }
  return "";
}

std::string Cache::usual_folder() {
  // The XDG base directory specification says that a relative path must be ignored.
  const std::string caches = variable("XDG_CACHE_HOME");
  if (caches.starts_with('/')) return caches + "/isoshade";
  const std::string home = variable("HOME");
  if (home.starts_with('/')) return home + "/.cache/isoshade";
  return "";
}

std::string Cache::entry_name(const std::string& key, EntryKind kind) { return key + std::string(ending_of(kind)); }

std::optional<Cache> Cache::open(const std::string& folder, Diagnostics& diagnostics) {
  const std::string wanted = folder.empty() ? usual_folder() : folder;
  if (!wanted.empty() && make_folders(wanted)) {
    const std::string danger = danger_of(wanted);
    if (danger.empty() && is_usable(wanted)) return Cache(wanted, std::nullopt);
    if (!danger.empty()) {
      diagnostics
          .report(Id::unsafe_cache, "the cache folder " + quote(wanted) + " " + danger +
                                        "; code in it could be theirs, and so none is kept or used")
          .suggest("make it a folder of yours alone (chmod go-w), or set XDG_CACHE_HOME to one");
    }
  } else if (!folder.empty()) {
    report_unwritable(folder, diagnostics);
    return std::nullopt;
  }
  const std::string parent = support::temporary_parent();
  std::optional<support::TemporaryFolder> temporary = support::TemporaryFolder::make(parent);
  if (!temporary) {
    report_unwritable(parent, diagnostics);
    return std::nullopt;
  }
  std::string path = temporary->path();
  return Cache(std::move(path), std::move(temporary));
}

CacheContents Cache::contents() const { return Listing(folder_).sum(); }

CacheContents Cache::clear() const {
  const Listing listing(folder_);
  remove_abandoned(listing);
  std::error_code ignored;
  for (const Entry& entry : listing.entries) fs::remove(entry.path, ignored);
  for (const std::string& entry : listing.shared) fs::remove_all(shared_workshop(entry), ignored);
  return contents();
}

namespace {

/// The checksum includes the name, so that an entry under another entry's name is damaged.
std::string seal_of(const std::string& name, std::string_view contents) {
  return std::string(seal_mark) + support::Sha256().add(name).add("\n").add(contents).hex();
}

}  // namespace

std::optional<std::string> Cache::read(const std::string& name) const {
  const std::string path = folder_ + "/" + name;
  const File file(path, O_RDONLY);
  if (!file.is_open() || !file.is_own()) return std::nullopt;
  if (file.size() > CacheLimit{}.bytes) {
    // No cache keeps an entry of this size, so it is damaged. Reading it could take all memory.
    unlink(path.c_str());
    return std::nullopt;
  }
  std::string text;
  if (!file.read_all(text) || text.size() <= seal_bytes) return std::nullopt;
  const std::string seal = text.substr(text.size() - seal_bytes);
  text.resize(text.size() - seal_bytes);
  if (seal != seal_of(name, text)) return std::nullopt;
  utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // marks it as just used
  return text;
}

std::optional<std::string> Cache::find(const std::string& name) const {
  return read(name) ? std::optional(folder_ + "/" + name) : std::nullopt;
}

std::optional<support::TemporaryFolder> Cache::workshop(Diagnostics& diagnostics,
                                                        const CacheLimit& limit) const {
  tidy(folder_, limit);
  std::optional<support::TemporaryFolder> made = support::TemporaryFolder::make(folder_);
  if (!made) report_unwritable(folder_, diagnostics);
  return made;
}

std::string Cache::shared_workshop(const std::string& name) const {
  return folder_ + "/" + name + std::string(shared_ending);
}

std::vector<std::string> Cache::shared_workshops() const { return Listing(folder_).shared; }

bool Cache::store(const std::string& name, const std::string& path, Diagnostics& diagnostics) const {
  std::string contents;
  {
    const File file(path, O_RDONLY);
    if (!file.is_open() || !file.read_all(contents)) return report_unwritable(path, diagnostics);
  }
  {
    File file(path, O_WRONLY | O_APPEND);
    const std::string seal = seal_of(name, contents);
    if (!file.is_open() || !file.write_all(seal) || !file.sync() || !file.close())
      return report_unwritable(path, diagnostics);
  }
  const std::string entry = folder_ + "/" + name;
  if (rename(path.c_str(), entry.c_str()) == 0) return true;
  // If a folder is in its place, it becomes an abandoned workshop.
  if (errno == EISDIR && rename(entry.c_str(), (path + ".replaced").c_str()) == 0 &&
      rename(path.c_str(), entry.c_str()) == 0)
    return true;
  return report_unwritable(folder_, diagnostics);
}

void Cache::keep(const std::string& name, std::string_view bytes) const {
  Diagnostics unheard;
  const auto made_in = workshop(unheard);
  if (!made_in) return;
  const std::string file = made_in->path() + "/entry";
  if (write_file(file, bytes, unheard)) store(name, file, unheard);
}

bool write_file(const std::string& path, std::string_view text, Diagnostics& diagnostics) {
  File file(path, O_WRONLY | O_CREAT | O_TRUNC);
  if (!file.is_open() || !file.write_all(text) || !file.close()) return report_unwritable(path, diagnostics);
  return true;
}

}  // namespace isoshade::backends
