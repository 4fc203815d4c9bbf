// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/session.h"

int main(int argc, char** argv) {
  using namespace isoshade::cli;
  int exit = failure;
  const auto arguments = parse_arguments(argc, argv, exit);
  if (!arguments) return exit;
  if (arguments->compile) return compile(*arguments->compile, arguments->common);
  if (arguments->render) return render(*arguments->render, arguments->common);
  if (arguments->verify) return verify(*arguments->verify, arguments->common);
  if (arguments->eval) return eval(*arguments->eval, arguments->common);
  return devices(*arguments->devices, arguments->common);
}
