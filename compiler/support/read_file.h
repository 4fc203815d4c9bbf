// SPDX-License-Identifier: Apache-2.0
// Reading whole files, and knowing afterwards which they were.
#pragma once

#include <optional>
#include <string>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

/// The bytes of a file, or the reason why there are none.
struct FileBytes {
  std::optional<std::string> bytes;
  Id id = Id::unreadable_file;  ///< or missing_file, too_large
  std::string reason;
};

/// A pipe without a name is what a shell makes of <(COMMAND).
enum class Pipes { refused, nameless };

/// Reads a regular file. What else there may be under the name (a folder, a FIFO, a device, a socket) is not even
/// opened: that could wait for ever, and some devices act on it.
FileBytes read_file(const std::string& path, size_t most_bytes, Pipes pipes = Pipes::refused);

/// Reads an open file to its end.
FileBytes read_open_file(int descriptor, size_t most_bytes);

/// Whether the path names a file that read_file() has read in this process: writing it would destroy an input.
bool was_read(const std::string& path);

}  // namespace isoshade::support
