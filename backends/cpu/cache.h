// SPDX-License-Identifier: Apache-2.0
// A private folder of files that are whole or not there, whoever else writes to it and whenever a write is
// cut short.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "compiler/support/diagnostics.h"
#include "compiler/support/temporary.h"

namespace isoshade::cpu {

/// How much of it is kept; beyond that the entries used least recently are deleted, down to half of it.
struct CacheLimit {
  size_t entries = 1000;
  uint64_t bytes = uint64_t{256} << 20;
};

/// What a cache holds.
struct CacheContents {
  size_t entries = 0;
  uint64_t bytes = 0;
};

class Cache {
 public:
  /// Opens `folder`, or where that is empty the usual one, making what is missing of it. Where the usual one cannot be
  /// had, a temporary folder serves until the end of this cache; if that is because others could put code into it,
  /// there is a warning.
  static std::optional<Cache> open(const std::string& folder, support::Diagnostics& diagnostics);

  /// $XDG_CACHE_HOME/isoshade or $HOME/.cache/isoshade; empty where the user has no place of their own.
  static std::string usual_folder();

  /// The name of the entry of a key, 64 hex digits. Files of other names are nobody's business.
  static std::string entry_name(const std::string& key);

  const std::string& folder() const { return folder_; }
  CacheContents contents() const;

  /// The path of the entry; nothing if it is not there or is damaged, in which case the next store replaces
  /// it.
  std::optional<std::string> find(const std::string& name) const;

  /// A folder to make an entry in. Also clears away what others left behind, and entries beyond the limit.
  std::optional<support::TemporaryFolder> workshop(support::Diagnostics& diagnostics,
                                                   const CacheLimit& limit = {}) const;

  /// Makes the file, which lies in a workshop, the entry: it is on the disk before it appears under its name.
  /// Appends a checksum of its name and contents, which neither ELF nor most other formats mind.
  bool store(const std::string& name, const std::string& file, support::Diagnostics& diagnostics) const;

  /// Deletes all entries, and workshops that no process uses any more; returns what is left.
  CacheContents clear() const;

 private:
  Cache(std::string folder, std::optional<support::TemporaryFolder> temporary)
      : folder_(std::move(folder)), temporary_(std::move(temporary)) {}

  std::string folder_;
  std::optional<support::TemporaryFolder> temporary_;
};

/// Writes a file; reports a full disk and the like.
bool write_file(const std::string& path, std::string_view text, support::Diagnostics& diagnostics);

}  // namespace isoshade::cpu
