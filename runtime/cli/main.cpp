// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <stdexcept>
#include <unistd.h>

#include "compiler/support/leftovers.h"
#include "runtime/cli/out_of_memory.h"
#include "runtime/cli/session.h"

namespace isoshade::cli {
namespace {

/// Whoever closed a standard stream would otherwise find its number given to the next file that is opened, and
/// messages in that file. Writing to what is opened here fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// Signals mean here what they should, whatever the parent made of them.
void settle_signals() {
  std::signal(SIGCHLD, SIG_DFL);  // ignored, no program could be waited for
  std::signal(SIGXFSZ,
              SIG_IGN);  // writing fails then, which is told, where the signal would leave half a file
  support::clean_up_on_signals();
}

int run(int argc, char** argv) {
  int exit = failure;
  const auto arguments = parse_arguments(argc, argv, exit);
  if (!arguments) return exit;
  if (arguments->common.json) tell_as_json();
  if (arguments->compile) return compile(*arguments->compile, arguments->common);
  if (arguments->render) return render(*arguments->render, arguments->common);
  if (arguments->verify) return verify(*arguments->verify, arguments->common);
  if (arguments->eval) return eval(*arguments->eval, arguments->common);
  if (arguments->check) return check_documents(*arguments->check, arguments->common);
  if (arguments->format) return format(*arguments->format, arguments->common);
  if (arguments->draw) return draw(*arguments->draw, arguments->common);
  if (arguments->bench) return bench(*arguments->bench, arguments->common);
  if (arguments->cache) return cache(*arguments->cache, arguments->common);
  if (arguments->nodes) return nodes(*arguments->nodes, arguments->common);
  if (arguments->schema) return schema(arguments->common);
  return devices(*arguments->devices, arguments->common);
}

}  // namespace
}  // namespace isoshade::cli

int main(int argc, char** argv) {
  using namespace isoshade::cli;
  occupy_standard_streams();
  settle_signals();
  end_in_words_where_memory_runs_out();
  int result = failure;
  try {
    result = run(argc, argv);
  } catch (const std::bad_alloc&) { end_out_of_memory(); } catch (const std::length_error&) {
    end_out_of_memory();
  }
  // What nobody could read was not told: a full disk must not pass for "identical".
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return result;
  std::fprintf(stderr, "error[unwritable-file]: cannot write standard output: %s\n", std::strerror(errno));
  return failure;
}
