// SPDX-License-Identifier: Apache-2.0
#include "tests/names/compilers.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <span>
#include <sstream>

#include "compiler/driver/forward.h"
#include "compiler/graph/graph.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/targets.h"
#include "tests/unit/temporary_folder.h"

namespace isoshade::names {
namespace {

/// Headers whose macros are names of lower case or common ones; complex.h last, for it defines I.
constexpr const char* headers[] = {"cassert",    "cctype",      "cerrno",          "cfenv",      "cfloat",
                                   "cinttypes",  "climits",     "clocale",         "cmath",      "csetjmp",
                                   "csignal",    "cstdarg",     "cstddef",         "cstdio",     "cstdlib",
                                   "cstring",    "ctime",       "cwchar",          "alloca.h",   "endian.h",
                                   "fcntl.h",    "pthread.h",   "sched.h",         "unistd.h",   "stdint.h",
                                   "sys/time.h", "sys/types.h", "sys/sysmacros.h", "sys/wait.h", "complex.h"};

std::string includes() {
  std::string text;
  for (const char* header : headers) text += "#include <" + std::string(header) + ">\n";
  return text;
}

void replace(std::string& text, std::string_view from, std::string_view to) {
  const size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

/// Runs a command and returns what it says; empty where it succeeds.
std::string said(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr)
    if (text.size() < 8000) text += buffer;
  const int status = pclose(pipe);
  return status == 0 ? "" : "exit " + std::to_string(status) + "\n" + text;
}

/// Functions of a host, which answer anything.
std::string host_of(const driver::Shader& shader) {
  std::string text;
  for (const interface::HostCall call : host_calls(shader.pure, shader.pure.functions)) {
    const interface::HostRow& asked = interface::row(call);
    const std::string type = (asked.returns_record() ? "isoshade_" : "") + std::string(asked.result);
    const std::string value = asked.result == "Light"       ? "vec3(0.0), vec3(1.0)"
                              : asked.result == "ImageSize" ? "1, 1, 0"
                                                            : "1";
    text += type + " isoshade_" + std::string(asked.name) + "(" + std::string(asked.parameters) +
            ") { return " + type + "(" + value + "); }\n";
  }
  return text;
}

}  // namespace

bool is_full() { return std::getenv("ISOSHADE_FULL") != nullptr; }

void Texts::add(const driver::Program& program) {
  const bool vertex = program.stage == driver::Stage::vertex;
  support::Diagnostics diagnostics;
  const std::string glsl = driver::glsl(program, driver::Division::native);
  EXPECT_TRUE(
      glsl::compile_spirv(glsl, vertex ? glsl::ShaderKind::vertex : glsl::ShaderKind::fragment, diagnostics))
      << diagnostics.text() << glsl.substr(0, 20000);
  ++glsl_;
  if (program.stage == driver::Stage::eval) {
    const std::string other = driver::glsl_with_vertex_eval(program, driver::Division::exact);
    EXPECT_TRUE(glsl::compile_spirv(other, glsl::ShaderKind::vertex, diagnostics)) << diagnostics.text();
    ++glsl_;
  }
  cpp_.push_back(driver::cpp(program));
}

void Texts::add(const driver::Shader& shader) {
  support::Diagnostics diagnostics;
  const std::string text =
      glsl::head() + driver::text(shader, *targets::find("glsl")) + host_of(shader) +
      "layout(location = 0) out vec4 the_color;\nvoid main() { the_color = vec4(1.0); }\n";
  EXPECT_TRUE(glsl::compile_spirv(text, glsl::ShaderKind::fragment, diagnostics))
      << diagnostics.text() << text.substr(0, 20000);
  ++glsl_;
  headers_.push_back({shader.pure.prefix, driver::text(shader, *targets::find("cpp"))});
  replace(headers_.back().text, "#pragma once", "");
  const emit::Target& es = *targets::find("glsl-es");
  es_.push_back({".frag", "#version 300 es\n" + driver::text(shader, es) + host_of(shader) +
                              "out vec4 the_color;\nvoid main() { the_color = vec4(1.0); }\n"});
  // The pairs of an effect have the same names but for that of the pass.
  std::vector<driver::ForwardPair> pairs = driver::forward_pairs(shader, es);
  for (const driver::ForwardPair& pair : std::span(pairs).first(std::min<size_t>(pairs.size(), 2))) {
    es_.push_back({".vert", pair.text.vertex});
    es_.push_back({".frag", pair.text.fragment});
  }
}

void Texts::compile() {
  const testing::TemporaryFolder folder;
  const auto take = [&](const std::string& compiler, const std::string& text) {
    const std::string path = folder.write("texts.cpp", text).string();
    EXPECT_EQ(said(compiler +
                   " -std=gnu++20 -Wall -Wextra -Werror -Wno-unused-function -fsyntax-only -I " ISOSHADE_ROOT
                   "/include " +
                   path),
              "")
        << compiler;
  };
  const auto compile = [&](const std::string& compiler, size_t every) {
    constexpr size_t most_bytes = 1'500'000;
    size_t count = 0;
    for (size_t i = 0; i < cpp_.size();) {
      // Each text in a namespace of its own, where its function is not exported.
      std::string file = "#include \"isoshade/lanes/lanes.h\"\n" + includes();
      for (; i < cpp_.size() && file.size() < most_bytes; i += every, ++count) {
        std::string text = cpp_[i];
        replace(text, "extern \"C\" __attribute__((visibility(\"default\"))) void", "void");
        file += "namespace text_" + std::to_string(i) + " {\n" + text + "}\n";
      }
      take(compiler, file);
    }
    // Namespaces of a file have different names.
    for (size_t i = 0; i < headers_.size();) {
      std::string file =
          "#include \"isoshade/lanes/host.h\"\n#include \"isoshade/lanes/lanes.h\"\n" + includes();
      std::set<std::string> spaces;
      for (; i < headers_.size() && file.size() < most_bytes && spaces.insert(headers_[i].space).second;
           i += every, ++count)
        file += headers_[i].text;
      take(compiler, file);
    }
    return count;
  };
  for (size_t i = 0; i < es_.size(); ++i) folder.write("es_" + std::to_string(i) + es_[i].ending, es_[i].text);
  if (!es_.empty()) {
    EXPECT_EQ(said("cd " + folder.path().string() + " && find . -name 'es_*' | xargs glslangValidator"), "");
  }
  compile("g++ -Wno-restrict", 1);
  clang_ = compile("clang++", is_full() ? 1 : 16);
}

std::set<std::string> macros_of_headers() {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("headers.cpp", "#include <bits/stdc++.h>\n" + includes()).string();
  const std::string list = (folder.path() / "macros").string();
  EXPECT_EQ(std::system(("g++ -std=gnu++20 -dM -E " + path + " >" + list).c_str()), 0);
  std::ifstream lines(list);
  std::set<std::string> found;
  for (std::string define, word, line; lines >> define >> word && std::getline(lines, line);) {
    word = word.substr(0, word.find('('));
    if (graph::is_id(word)) found.insert(word);
  }
  EXPECT_GT(found.size(), 1000u);
  return found;
}

}  // namespace isoshade::names
