// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "backends/cpu/compiler.h"
#include "backends/cpu/kernel.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "tests/unit/cpu_folders.h"
#include "tests/unit/cpu_programs.h"

namespace isoshade::cpu {
namespace {

using backends::Cache;
using driver::Program;
using driver::Stage;
using support::Diagnostics;
using support::Id;

/// The machine's compiler, counted: each run of it adds a line to a file.
class CountedCompiler {
 public:
  CountedCompiler() {
    Diagnostics diagnostics;
    write_text(folder_ / "c++", "#!/bin/sh\n[ \"$1\" = --version ] || echo run >> " + (folder_ / "runs") +
                                    "\nexec " + Compiler::find("", diagnostics)->path() + " \"$@\"\n");
    chmod((folder_ / "c++").c_str(), 0755);
  }
  std::string path() const { return folder_ / "c++"; }
  int runs() const {
    const std::string text = read_text(folder_ / "runs");
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  }

 private:
  TestFolder folder_;
};

KernelStore make_store(const std::string& compiler, const std::string& cache, const char* lanes = "4",
                       const std::string& keep = "") {
  Diagnostics diagnostics;
  return KernelStore(
      Toolchain{*Compiler::find(compiler, diagnostics), *Cache::open(cache, diagnostics), *lane_count(lanes)},
      Execution::compiled, text_of, keep);
}

/// Whether the kernel of the eval program is there and computes.
bool works(KernelStore& store, Diagnostics& diagnostics) {
  const Program program = program_of(Stage::eval);
  const Program* const programs[] = {&program};
  const auto kernels = store.kernels(programs, diagnostics);
  if (!kernels) return false;
  const float inputs[] = {3, 5, 7, 11};
  int results[4] = {};
  BufferView buffers[std::size(lower::frame_buffers)] = {};
  buffers[static_cast<size_t>(lower::FrameBuffer::inputs)] = {inputs, 4};
  const lanes::FpGuard guard_floats;
  kernels->front()->eval(buffers, 0, 2, results);
  return results[0] == 0x41700000 && results[1] == 0 && results[2] == 0x429a0000 && results[3] == 1;
}

TEST(KernelStore, CompilesOnceAndThenUsesTheCache) {
  const CountedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  for (int i = 0; i < 3; ++i) {
    KernelStore store = make_store(compiler.path(), cache.path());
    EXPECT_TRUE(works(store, diagnostics)) << diagnostics.text();
    EXPECT_TRUE(works(store, diagnostics)) << diagnostics.text();
  }
  EXPECT_EQ(compiler.runs(), 1);
  EXPECT_EQ(count_files(cache.path()), 1);
}

TEST(KernelStore, RecompilesForOtherLaneCounts) {
  const CountedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  for (const char* lanes : {"1", "4", "1"}) {
    KernelStore store = make_store(compiler.path(), cache.path(), lanes);
    EXPECT_TRUE(works(store, diagnostics)) << diagnostics.text();
  }
  EXPECT_EQ(compiler.runs(), 2);
}

TEST(KernelStore, RecompilesDamagedEntries) {
  const CountedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  {
    KernelStore store = make_store(compiler.path(), cache.path());
    ASSERT_TRUE(works(store, diagnostics)) << diagnostics.text();
  }
  const std::string entry = std::filesystem::directory_iterator(cache.path())->path();
  const std::string whole = read_text(entry);
  int expected_runs = 1;
  for (const std::string& damaged :
       {whole.substr(0, whole.size() / 2), std::string(), "\x7f" + std::string("ELF"), whole + "more"}) {
    // In its place, as a write that was cut short would be; a loaded object stays as it was.
    std::filesystem::remove(entry);
    write_text(entry, damaged);
    KernelStore store = make_store(compiler.path(), cache.path());
    EXPECT_TRUE(works(store, diagnostics)) << diagnostics.text();
    EXPECT_EQ(compiler.runs(), ++expected_runs);
  }
}

TEST(KernelStore, ServesTwoProcessesAtOnce) {
  const TestFolder cache;
  const auto race = [&] {
    Diagnostics diagnostics;
    KernelStore store = make_store("", cache.path());
    return works(store, diagnostics);
  };
  const pid_t first = start_child(race), second = start_child(race);
  EXPECT_TRUE(succeeded(first));
  EXPECT_TRUE(succeeded(second));
  EXPECT_EQ(count_files(cache.path()), 1);
}

TEST(KernelStore, ReportsCompileErrorsAndContinues) {
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store("", cache.path());
  const Program wrong = program_of(Stage::eval, "not C++ at all");
  const Program* const programs[] = {&wrong};
  EXPECT_FALSE(store.kernels(programs, diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::compiler_failed);
  EXPECT_EQ(count_files(cache.path()), 0);
  EXPECT_TRUE(works(store, diagnostics));
}

TEST(KernelStore, ReportsCodeThatCannotBeLoaded) {
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store("", cache.path());
  const Program wrong =
      program_of(Stage::eval, "void nowhere(); extern \"C\" void isoshade_eval() { nowhere(); }");
  const Program* const programs[] = {&wrong};
  EXPECT_FALSE(store.kernels(programs, diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, Id::unloadable_code);
}

TEST(KernelStore, CompilesEqualTextsOnce) {
  const CountedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store(compiler.path(), cache.path());
  const Program a = program_of(Stage::vertex), b = program_of(Stage::vertex), c = program_of(Stage::pixel);
  const Program* const programs[] = {&a, &b, &c};
  const auto kernels = store.kernels(programs, diagnostics);
  ASSERT_TRUE(kernels) << diagnostics.text();
  EXPECT_EQ((*kernels)[0], (*kernels)[1]);
  EXPECT_TRUE((*kernels)[0]->is_compiled());
  EXPECT_NE((*kernels)[0], (*kernels)[2]);
  EXPECT_EQ(compiler.runs(), 2);
}

TEST(KernelStore, SanitizesNamesOfKeptTexts) {
  const TestFolder cache, keep;
  Diagnostics diagnostics;
  KernelStore store = make_store("", cache.path(), "4", keep.path());
  const Program program = program_of(Stage::vertex, "../up and away");
  const Program* const programs[] = {&program};
  ASSERT_TRUE(store.kernels(programs, diagnostics)) << diagnostics.text();
  EXPECT_EQ(read_text(keep / "___up_and_away.vertex.cpp"), vertex_text);
}

TEST(LanesHeaders, MatchTheSourceTree) {
  ASSERT_FALSE(lanes_headers().empty());
  bool main_header = false;
  for (const Header& header : lanes_headers()) {
    EXPECT_EQ(read_text(std::string(ISOSHADE_SOURCE_DIR) + "/include/" + std::string(header.path)), header.text);
    main_header |= header.path == "isoshade/lanes/lanes.h";
  }
  EXPECT_TRUE(main_header);
}

}  // namespace
}  // namespace isoshade::cpu
