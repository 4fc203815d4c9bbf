// SPDX-License-Identifier: Apache-2.0
// A private folder of files that are whole or not there, whoever else writes to it and whenever a write is
// cut short.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "compiler/support/diagnostics.h"

namespace isoshade::cpu {

/// A folder that is removed with all that is in it.
class TemporaryFolder {
 public:
  /// Within `parent`; only its owner can enter it. Nothing if it cannot be made, with the reason in errno.
  static std::optional<TemporaryFolder> make(const std::string& parent);
  TemporaryFolder(TemporaryFolder&&) = default;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  const std::string& path() const { return *path_; }

 private:
  explicit TemporaryFolder(std::string path) : path_(std::make_unique<std::string>(std::move(path))) {}
  std::unique_ptr<std::string> path_;  ///< null after a move
};

class Cache {
 public:
  /// Opens `folder`, or where that is empty $XDG_CACHE_HOME/isoshade or $HOME/.cache/isoshade, making what is
  /// missing of it. Without such a place a temporary folder serves until the end of this cache. Reports a
  /// folder that others can write to.
  static std::optional<Cache> open(const std::string& folder, support::Diagnostics& diagnostics);

  const std::string& folder() const { return folder_; }

  /// The path of the entry; nothing if it is not there or is damaged, in which case the next store replaces
  /// it.
  std::optional<std::string> find(const std::string& name) const;

  /// A folder to make an entry in. Also clears away what others left behind, and the entries used least
  /// recently where there are very many.
  std::optional<TemporaryFolder> workshop(support::Diagnostics& diagnostics) const;

  /// Makes the file, which lies in a workshop, the entry: it is on the disk before it appears under its name.
  /// Appends a checksum, which neither ELF nor most other formats mind.
  bool store(const std::string& name, const std::string& file, support::Diagnostics& diagnostics) const;

 private:
  Cache(std::string folder, std::optional<TemporaryFolder> temporary)
      : folder_(std::move(folder)), temporary_(std::move(temporary)) {}

  std::string folder_;
  std::optional<TemporaryFolder> temporary_;
};

/// Writes a file; reports a full disk and the like.
bool write_file(const std::string& path, std::string_view text, support::Diagnostics& diagnostics);

}  // namespace isoshade::cpu
