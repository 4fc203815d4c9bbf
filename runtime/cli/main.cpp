// SPDX-License-Identifier: Apache-2.0
// The process: standard streams, signals, running out of memory, and the choice of the subcommand.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <iterator>
#include <new>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

#include "compiler/support/assert.h"
#include "compiler/support/leftovers.h"
#include "compiler/support/memory.h"
#include "runtime/cli/session.h"

namespace isoshade::cli {
namespace {

/// Opens /dev/null in place of each standard stream that the parent closed. Otherwise the next file to be opened would get
/// the stream's number, and messages would be written to it. Using these streams fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// Sets the signal handlers, whatever the parent process set.
void set_signals() {
  std::signal(SIGCHLD, SIG_DFL);  // if it is ignored, waiting for a child process fails
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails and is reported, and leaves no partial file
  support::clean_up_on_signals();
}

volatile std::sig_atomic_t memory_error_as_json = 0;  ///< as with --diagnostics json

/// Uses text that is already in memory, because nothing can be allocated.
void report_out_of_memory() {
  constexpr std::string_view text =
      "error[device-limit]: this process has run out of memory\n"
      "  make the document, table or image smaller, or allow more memory (ulimit -v)\n";
  constexpr std::string_view json =
      "[{\"id\": \"device-limit\", \"severity\": \"error\", \"file\": \"\", \"line\": 0, \"column\": 0, "
      "\"pointer\": \"\", \"message\": \"this process has run out of memory\", \"notes\": [], "
      "\"fix\": \"make the document, table or image smaller, or allow more memory (ulimit -v)\"}]\n";
  const std::string_view message = memory_error_as_json != 0 ? json : text;
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message.data(), message.size());
}

[[noreturn]] void end_out_of_memory() {
  std::fflush(stdout);
  report_out_of_memory();
  support::clean_up_and_exit(failure);
}

[[noreturn]] void end_uncaught() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) { end_out_of_memory(); } catch (const std::length_error&) {
    end_out_of_memory();
  } catch (...) {}
  support::bug("uncaught exception");
}

constexpr int faults[] = {SIGABRT, SIGSEGV, SIGBUS};
struct sigaction previous_actions[std::size(faults)];  ///< for each fault; a sanitizer may have set one

/// A library that cannot allocate memory may abort, or use the null pointer that it got.
void end_after_fault(int signal) {
  for (size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &previous_actions[i], nullptr);
  if (support::is_memory_exhausted()) {
    report_out_of_memory();
    support::clean_up_and_exit(failure);
  }
  // The faulting instruction runs again after the return; an abort must be raised again.
  if (signal == SIGABRT) raise(signal);
}

/// Makes the process end with an error message and status 2 if memory runs out where run() cannot catch it: in a thread of
/// a library, in a noexcept function, or in a driver that does not check its allocations. Call after set_signals().
void handle_out_of_memory() {
  std::set_terminate(end_uncaught);
  struct sigaction action {};
  action.sa_handler = end_after_fault;
  for (size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &action, &previous_actions[i]);
}

int run(int argc, char** argv) {
  int exit = failure;
  const auto arguments = parse_arguments(argc, argv, exit);
  if (!arguments) return exit;
  if (arguments->common.json) memory_error_as_json = 1;
  if (arguments->compile) return compile(*arguments->compile, arguments->common);
  if (arguments->render) return render(*arguments->render, arguments->common);
  if (arguments->sheet) return sheet(*arguments->sheet, arguments->common);
  if (arguments->verify) return verify(*arguments->verify, arguments->common);
  if (arguments->eval) return eval(*arguments->eval, arguments->common);
  if (arguments->check) return check_documents(*arguments->check, arguments->common);
  if (arguments->format) return format(*arguments->format, arguments->common);
  if (arguments->draw) return draw(*arguments->draw, arguments->common);
  if (arguments->page) return page(*arguments->page, arguments->common);
  if (arguments->bench) return bench(*arguments->bench, arguments->common);
  if (arguments->cache) return cache(*arguments->cache, arguments->common);
  if (arguments->nodes) return nodes(*arguments->nodes, arguments->common);
  if (arguments->schema) return schema(*arguments->schema, arguments->common);
  return devices(*arguments->devices, arguments->common);
}

}  // namespace
}  // namespace isoshade::cli

int main(int argc, char** argv) {
  using namespace isoshade::cli;
  occupy_standard_streams();
  set_signals();
  handle_out_of_memory();
  int result = failure;
  try {
    result = run(argc, argv);
  } catch (const std::bad_alloc&) { end_out_of_memory(); } catch (const std::length_error&) {
    end_out_of_memory();
  }
  // A full disk may have lost the output; "identical" that nobody could read is not a success.
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return result;
  std::fprintf(stderr, "error[unwritable-file]: cannot write standard output: %s\n", std::strerror(errno));
  return failure;
}
