// SPDX-License-Identifier: Apache-2.0
// How much memory there is, and what happens where it does not suffice.
#pragma once

#include <cstdint>
#include <string>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

/// How many bytes this process may still take: the least of what the machine has free, with its swap, of the limit of
/// its control group (a container's), and of the limits on its address space and data (ulimit -v, -d).
uint64_t available_memory();

/// Whether so few bytes are left of a limit on the address space or data of this process that a fault in a library is
/// most likely an allocation that failed. May be called in the handler of a signal.
bool is_memory_exhausted();

/// Reports, before it is taken, that `what` ("the image") needs more than there is. Returns whether it fits.
bool check_memory(uint64_t bytes, const std::string& what, const std::string& way_out,
                  Diagnostics& diagnostics);

/// "1.3 GiB", "20 MiB".
std::string memory_text(uint64_t bytes);

}  // namespace isoshade::support
