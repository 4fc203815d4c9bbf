// SPDX-License-Identifier: Apache-2.0
// Compiled with the host's flags: the headers must not warn under them.
#include <isoshade/compiler.h>

#include <cstdio>

int main(int argc, char** argv) {
  const isoshade::Compilation made = isoshade::compile_file(argc > 1 ? argv[1] : "shader.json");
  std::fputs(made.text.c_str(), stderr);
  for (const isoshade::File& file : made.files) std::printf("%s %zu\n", file.name.c_str(), file.bytes.size());
  return made ? 0 : 1;
}
