// SPDX-License-Identifier: Apache-2.0
// Reads whole files, and remembers which files were read.
#pragma once

#include <optional>
#include <string>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

/// The bytes of a file, or why it could not be read.
struct FileBytes {
  std::optional<std::string> bytes;
  Id id = Id::unreadable_file;  ///< or missing_file, too_large
  std::string reason;
};

/// A nameless pipe is what a shell passes for <(COMMAND).
enum class Pipes { refused, nameless };

/// Reads a regular file. Anything else (a folder, a FIFO, a device, a socket) is not even opened: opening could block
/// forever, and some devices react to it.
FileBytes read_file(const std::string& path, size_t most_bytes, Pipes pipes = Pipes::refused);

/// Reads an open file from its current offset to its end.
FileBytes read_open_file(int descriptor, size_t most_bytes);

/// Whether read_file() has read this file in this process; writing it would overwrite an input.
bool was_read(const std::string& path);

}  // namespace isoshade::support
