// SPDX-License-Identifier: Apache-2.0
// Temporary files and folders: gone with the object, and with the process where a signal ends it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace isoshade::support {

/// $TMPDIR where that is an absolute path, else /tmp.
std::string temporary_parent();

/// What to do where a file could not be written for this reason, an errno; empty where nothing general can be said.
std::string_view way_to_write(int failure);

/// A folder that is removed with all that is in it. Only its owner can enter it.
class TemporaryFolder {
 public:
  /// Within `parent`. Nothing if it cannot be made, with the reason in errno.
  static std::optional<TemporaryFolder> make(const std::string& parent);
  TemporaryFolder(TemporaryFolder&&) = default;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  const std::string& path() const { return *path_; }

  /// Whether make() may have made a folder of this name.
  static bool is_name(const std::string& name);

 private:
  explicit TemporaryFolder(std::string path) : path_(std::make_unique<std::string>(std::move(path))) {}
  std::unique_ptr<std::string> path_;  ///< null after a move
};

/// A file that is written before it takes the name of another, so that readers of that see its old bytes or its new
/// ones. Until then it has no name where the file system can do that (O_TMPFILE), so that not even SIGKILL leaves it
/// behind; otherwise a name of its own beside the other, which begins with ".isoshade-".
class TemporaryFile {
 public:
  /// In `folder`. Check is_open(); the reason is in errno.
  explicit TemporaryFile(const std::string& folder);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

  /// Closes the file and gives it the name, which lies in the folder and may be that of an old file. False with the
  /// reason in errno.
  bool rename_to(const std::string& path);

 private:
  bool take_name();
  bool close_file();

  std::string folder_;
  std::string name_;  ///< its path; empty: it has none
  int descriptor_ = -1;
};

}  // namespace isoshade::support
