// SPDX-License-Identifier: Apache-2.0
// The command ends in words and with the status of an error where memory runs out, wherever that is.
#pragma once

namespace isoshade::cli {

/// Where no caller can catch it: in a thread of a library, below a function that may not throw, or in a driver that does
/// not look at what it is given. Call after support::clean_up_on_signals().
void end_in_words_where_memory_runs_out();

/// From here on the words are JSON, as --diagnostics json has it.
void tell_as_json();

/// Tells it, cleans up and ends the process.
[[noreturn]] void end_out_of_memory();

}  // namespace isoshade::cli
