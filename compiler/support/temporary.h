// SPDX-License-Identifier: Apache-2.0
// Temporary files and folders, removed with their object, and also when a signal ends the process.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace isoshade::support {

/// $TMPDIR if it is an absolute path, else /tmp.
std::string temporary_parent();

/// A suggestion for a file that could not be written, by errno; empty if there is no general advice.
std::string_view write_failure_fix(int failure);

/// A folder, accessible to its owner only, that is removed with its contents.
class TemporaryFolder {
 public:
  /// Creates one in `parent`. On failure returns nullopt and sets errno.
  static std::optional<TemporaryFolder> make(const std::string& parent);
  TemporaryFolder(TemporaryFolder&&) = default;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  const std::string& path() const { return *path_; }

  /// Whether `name` has the form of the names that make() chooses.
  static bool is_name(const std::string& name);

 private:
  explicit TemporaryFolder(std::string path) : path_(std::make_unique<std::string>(std::move(path))) {}
  std::unique_ptr<std::string> path_;  ///< null after a move
};

/// A file that is written first and then atomically replaces another, so that readers see either the old or the new
/// bytes. Until then it has no name if the file system supports O_TMPFILE, so that not even SIGKILL leaves it behind;
/// otherwise it has a name in the same folder that begins with ".isoshade-".
class TemporaryFile {
 public:
  /// Creates it in `folder`. If is_open() is then false, errno has the reason.
  explicit TemporaryFile(const std::string& folder);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

  /// Closes the file and moves it to `path`, which lies in the folder and may be an existing file. On failure returns
  /// false and sets errno.
  bool rename_to(const std::string& path);

 private:
  bool take_name();
  bool close_file();

  std::string folder_;
  std::string name_;  ///< its path; empty while it has no name
  int descriptor_ = -1;
};

}  // namespace isoshade::support
