// SPDX-License-Identifier: Apache-2.0
// Compiles documents in process: one in memory, one with an error, and a file.
#include <cstdio>
#include <string>

#include <isoshade/compiler.h>

int main(int argc, char** argv) {
  const std::string half = R"({"isoshade": 1, "function": "half", "inputs": {"in": {"type": "float"}},
    "nodes": {"y": {"type": "multiply", "in1": "in", "in2": 0.5}}, "outputs": {"out": "y"}})";
  const isoshade::Compilation made = isoshade::compile({"half.json", half});
  std::fputs(made.text.c_str(), stderr);
  if (!made || made.find("half.glsl") == nullptr || made.find("half.h") == nullptr) return 1;
  std::puts(made.find("half.glsl")->bytes.c_str());

  const isoshade::Compilation wrong = isoshade::compile({"wrong.json", "{\"isoshade\": 1, \"funktion\": \"half\"}"});
  if (wrong || wrong.diagnostics.empty() || !wrong.files.empty()) return 1;
  const isoshade::Diagnostic& diagnostic = wrong.diagnostics[0];
  std::printf("%s:%d:%d: %s: %s\n", diagnostic.where.file.c_str(), diagnostic.where.line, diagnostic.where.column,
              diagnostic.id.c_str(), diagnostic.message.c_str());

  for (int i = 1; i < argc; ++i) {
    const isoshade::Compilation file = isoshade::compile_file(argv[i], {.targets = {"glsl", "cpp"}});
    std::fputs(file.text.c_str(), stderr);
    if (!file) return 1;
    for (const std::string& read : file.read) std::printf("read %s\n", read.c_str());
  }
  return 0;
}
