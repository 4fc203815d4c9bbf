// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/out_of_memory.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <iterator>
#include <new>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

#include "compiler/support/assert.h"
#include "compiler/support/leftovers.h"
#include "compiler/support/memory.h"
#include "runtime/cli/arguments.h"

namespace isoshade::cli {
namespace {

volatile std::sig_atomic_t as_json = 0;

/// In words that are there already: nothing more can be allocated.
void tell() {
  constexpr std::string_view text =
      "error[device-limit]: the memory that this process may have does not suffice\n"
      "  make the document, table or image smaller, or allow more memory (ulimit -v)\n";
  constexpr std::string_view json =
      "[{\"id\": \"device-limit\", \"severity\": \"error\", \"file\": \"\", \"line\": 0, \"column\": 0, "
      "\"pointer\": \"\", \"message\": \"the memory that this process may have does not suffice\", "
      "\"notes\": [], "
      "\"fix\": \"make the document, table or image smaller, or allow more memory (ulimit -v)\"}]\n";
  const std::string_view words = as_json != 0 ? json : text;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, words.data(), words.size());
}

[[noreturn]] void end_uncaught() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) { end_out_of_memory(); } catch (const std::length_error&) {
    end_out_of_memory();
  } catch (...) {}
  support::bug("an exception that nothing catches");
}

constexpr int faults[] = {SIGABRT, SIGSEGV, SIGBUS};
struct sigaction former[std::size(faults)];  ///< what was done at each: a sanitizer may have its own

/// A library that cannot allocate may abort, or use the null pointer that it was given.
void end_after_fault(int signal) {
  for (size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &former[i], nullptr);
  if (support::is_memory_exhausted()) {
    tell();
    support::clean_up_and_exit(failure);
  }
  // Back to where it happened, to end there as it would have ended.
  if (signal == SIGABRT) raise(signal);
}

}  // namespace

void end_in_words_where_memory_runs_out() {
  std::set_terminate(end_uncaught);
  struct sigaction action {};
  action.sa_handler = end_after_fault;
  for (size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &action, &former[i]);
}

void tell_as_json() { as_json = 1; }

void end_out_of_memory() {
  std::fflush(stdout);
  tell();
  support::clean_up_and_exit(failure);
}

}  // namespace isoshade::cli
