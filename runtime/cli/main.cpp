// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "runtime/cli/session.h"

namespace isoshade::cli {
namespace {

/// Whoever closed a standard stream would otherwise find its number given to the next file that is opened, and
/// messages in that file. Writing to what is opened here fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int run(int argc, char** argv) {
  int exit = failure;
  const auto arguments = parse_arguments(argc, argv, exit);
  if (!arguments) return exit;
  if (arguments->compile) return compile(*arguments->compile, arguments->common);
  if (arguments->render) return render(*arguments->render, arguments->common);
  if (arguments->verify) return verify(*arguments->verify, arguments->common);
  if (arguments->eval) return eval(*arguments->eval, arguments->common);
  if (arguments->check) return check_documents(*arguments->check, arguments->common);
  if (arguments->format) return format(*arguments->format, arguments->common);
  if (arguments->draw) return draw(*arguments->draw, arguments->common);
  if (arguments->bench) return bench(*arguments->bench, arguments->common);
  if (arguments->nodes) return nodes(*arguments->nodes, arguments->common);
  if (arguments->schema) return schema(arguments->common);
  return devices(*arguments->devices, arguments->common);
}

}  // namespace
}  // namespace isoshade::cli

int main(int argc, char** argv) {
  using namespace isoshade::cli;
  occupy_standard_streams();
  const int result = run(argc, argv);
  // What nobody could read was not told: a full disk must not pass for "identical".
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return result;
  std::fprintf(stderr, "error[unwritable-file]: cannot write standard output: %s\n", std::strerror(errno));
  return failure;
}
