// SPDX-License-Identifier: Apache-2.0
// A private folder of files. Each file is complete or absent, even if other processes write to the folder or a write is
// interrupted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "compiler/support/temporary.h"

namespace isoshade::backends {

/// The size limit; when it is exceeded, the least recently used entries are deleted until half of it is left.
struct CacheLimit {
  size_t entries = 1000;
  uint64_t bytes = uint64_t{256} << 20;
};

/// What an entry is.
enum class EntryKind : uint8_t {
  code,      ///< a shared object
  maps,      ///< of an environment (runtime/environment)
  probe,     ///< what the probe found about a Vulkan device
  spirv,     ///< a shader for Vulkan
  pipelines  ///< what a Vulkan driver keeps of the shaders that it compiled
};
inline constexpr size_t entry_kinds = 5;

/// "compiled C++"
std::string_view name(EntryKind kind);

/// The contents of a cache.
struct CacheContents {
  size_t entries = 0;
  uint64_t bytes = 0;
  std::array<size_t, entry_kinds> of_kind{};  ///< entries, by EntryKind
};

class Cache {
 public:
  /// Opens `folder`, or the default folder if it is empty, and creates missing parts of the path. If the default folder
  /// is unusable, a temporary folder takes its place for the lifetime of this cache; if the reason is that other users
  /// could write code to it, a warning is reported.
  static std::optional<Cache> open(const std::string& folder, support::Diagnostics& diagnostics);

  /// $XDG_CACHE_HOME/isoshade or $HOME/.cache/isoshade; empty if neither variable is set.
  static std::string usual_folder();

  /// The file name for a key, 64 hex digits. The cache ignores files with other names.
  static std::string entry_name(const std::string& key, EntryKind kind = EntryKind::code);

  const std::string& folder() const { return folder_; }
  /// Whether entries outlive this object.
  bool is_lasting() const { return !temporary_; }
  CacheContents contents() const;

  /// The path of the entry; nothing if it is missing or damaged. The next store() replaces a damaged entry; one larger
  /// than the whole cache may be is deleted at once.
  std::optional<std::string> find(const std::string& name) const;
  /// The contents of the entry, likewise.
  std::optional<std::string> read(const std::string& name) const;

  /// A folder to make an entry in. Also deletes abandoned workshops, and entries beyond the size limit.
  std::optional<support::TemporaryFolder> workshop(support::Diagnostics& diagnostics,
                                                   const CacheLimit& limit = {}) const;

  /// The folder in which an entry is made that processes may leave to each other; it need not exist. It is abandoned after a
  /// day.
  std::string shared_workshop(const std::string& name) const;
  /// The entries for which there is such a folder.
  std::vector<std::string> shared_workshops() const;

  /// Turns a file of a workshop into the entry; it is on the disk before it appears under its name. Appends a checksum
  /// of its name and contents, which ELF and most other formats ignore.
  bool store(const std::string& name, const std::string& file, support::Diagnostics& diagnostics) const;

  /// Makes the bytes an entry. Fails silently: an entry that cannot be kept is made again when it is needed.
  void keep(const std::string& name, std::string_view bytes) const;

  /// Deletes all entries, all abandoned workshops and those that are shared; returns what is left.
  CacheContents clear() const;

 private:
  Cache(std::string folder, std::optional<support::TemporaryFolder> temporary)
      : folder_(std::move(folder)), temporary_(std::move(temporary)) {}

  std::string folder_;
  std::optional<support::TemporaryFolder> temporary_;
};

/// Writes a file; reports errors such as a full disk.
bool write_file(const std::string& path, std::string_view text, support::Diagnostics& diagnostics);

}  // namespace isoshade::backends
