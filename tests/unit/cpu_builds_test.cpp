// SPDX-License-Identifier: Apache-2.0
// Programs are interpreted while they are compiled in the background.
#include <algorithm>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>

#include "backends/cpu/backend.h"
#include "backends/cpu/kernel.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"
#include "runtime/lanes/lanes.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::cpu {
namespace {

using backends::Cache;
using driver::Program;
using support::Diagnostics;
using support::Id;

/// Whether `condition` holds within half a minute.
template <class Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// The machine's compiler, which waits for a permission and then does as told: by default it compiles.
class GatedCompiler {
 public:
  explicit GatedCompiler(const std::string& then = "") {
    Diagnostics diagnostics;
    const std::string real = Compiler::find("", diagnostics)->path();
    write_text(folder_ / "c++", "#!/bin/sh\n[ \"$1\" = --version ] && exec " + real + " \"$@\"\necho run >> " +
                                    (folder_ / "runs") + "\nwhile [ ! -e " + (folder_ / "go") +
                                    " ]; do sleep 0.01; done\n" + then + "\nexec " + real + " \"$@\"\n");
    chmod((folder_ / "c++").c_str(), 0755);
  }
  ~GatedCompiler() { permit(); }
  GatedCompiler(const GatedCompiler&) = delete;
  GatedCompiler& operator=(const GatedCompiler&) = delete;

  std::string path() const { return folder_ / "c++"; }
  void permit() const { write_text(folder_ / "go", ""); }
  int runs() const {
    const std::string text = read_text(folder_ / "runs");
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  }

 private:
  TestFolder folder_;
};

/// Of two floats: the root of the first one, plus the second one and a constant several times.
Program program_with(float constant) {
  Program program;
  program.stage = driver::Stage::eval;
  program.name = "test";
  program.module = lower::frame_module();
  ir::Function function;
  function.name = "test";
  function.parameters = {{"a", ir::float_type, "", false}, {"b", ir::float_type, "", false}};
  function.results = {{"sum", ir::float_type}};
  program.module.functions.push_back(std::move(function));
  ir::Builder b(program.module, 0);
  const std::array initial{b.op(ir::Opcode::fsqrt, {b.parameter(0)})};
  b.finish(b.loop(b.constant(5), initial, [&](ir::ValueId, std::span<const ir::ValueId> carried) {
    const ir::ValueId more = b.op(ir::Opcode::fmul, {b.parameter(1), b.constant(constant)});
    return std::vector{b.op(ir::Opcode::fadd, {carried[0], more})};
  }));
  program.entry = lower::add_eval_kernel(program.module, 0);
  program.inputs = {{"a", "float", 1, {}, {}, {}}, {"b", "float", 1, {}, {}, {}}};
  program.results = {{"sum", "float", 1, {}, {}, {}}};
  return program;
}

constexpr int rows = 10000;

std::vector<float> inputs() {
  std::vector<float> made;
  for (int i = 0; i < 2 * rows; ++i) made.push_back(static_cast<float>(i) * 0.37f - 100);
  return made;
}

std::vector<int> run(const Kernel& kernel, int first = 0, int count = rows) {
  static const std::vector<float> in = inputs();
  BufferView buffers[std::size(lower::frame_buffers)] = {};
  buffers[static_cast<size_t>(lower::FrameBuffer::inputs)] = {in.data(), static_cast<int>(in.size())};
  std::vector<int> results(static_cast<size_t>(count));
  const lanes::FpGuard guard_floats;
  kernel.eval(buffers, first, count, results.data());
  return results;
}

KernelStore make_store(const std::string& compiler, const std::string& cache, Execution execution = Execution::at_once,
                       double limit = 60) {
  Diagnostics diagnostics;
  return KernelStore(Toolchain{*Compiler::find(compiler, diagnostics, support::Seconds(limit)),
                               *Cache::open(cache, diagnostics), widest_lane_count()},
                     execution, driver::cpp, "");
}

const Kernel* kernel_of(KernelStore& store, const Program& program, Diagnostics& diagnostics) {
  const Program* const programs[] = {&program};
  const auto kernels = store.kernels(programs, diagnostics);
  EXPECT_TRUE(kernels) << diagnostics.text();
  return kernels ? kernels->front() : nullptr;
}

std::vector<int> compiled_results(const Program& program) {
  static const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store("", cache.path(), Execution::compiled);
  return run(*kernel_of(store, program, diagnostics));
}

int count_entries(const std::string& cache) {
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(cache)) count += file.path().extension() == ".so";
  return count;
}

TEST(Builds, CodeTakesOverFromTheInterpreterWithTheSameBits) {
  const GatedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store(compiler.path(), cache.path());
  const Program program = program_with(1.5f);
  const Kernel* const kernel = kernel_of(store, program, diagnostics);
  const std::vector<int> expected = compiled_results(program);
  EXPECT_FALSE(kernel->is_compiled());
  // As in a frame: some parts before, others after.
  std::vector<int> parts = run(*kernel, 0, rows / 2);
  compiler.permit();
  ASSERT_TRUE(soon([&] { return kernel->is_compiled(); }));
  const std::vector<int> rest = run(*kernel, rows / 2, rows - rows / 2);
  parts.insert(parts.end(), rest.begin(), rest.end());
  EXPECT_EQ(parts, expected);
  EXPECT_EQ(kernel->runs_interpreted(), static_cast<uint64_t>(rows / 2));
  EXPECT_EQ(kernel->runs_compiled(), static_cast<uint64_t>(rows - rows / 2));
  EXPECT_NE(store.description().find("(5000 of 10000 vertices, pixels and rows by the interpreter)"), std::string::npos)
      << store.description();
  EXPECT_EQ(count_files(cache.path()), 1);
  EXPECT_TRUE(diagnostics.all().empty());
}

TEST(Builds, ManyThreadsMayRunAKernelThatBecomesCompiled) {
  const GatedCompiler compiler;
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store(compiler.path(), cache.path());
  const Program program = program_with(2.5f);
  const Kernel* const kernel = kernel_of(store, program, diagnostics);
  const std::vector<int> expected = compiled_results(program);
  std::atomic<int> different = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      bool last = false;
      do {
        last = kernel->is_compiled();
        different += run(*kernel) != expected;
      } while (!last);
    });
  compiler.permit();
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
  EXPECT_GT(kernel->runs_interpreted(), 0u);
  EXPECT_GT(kernel->runs_compiled(), 0u);
}

TEST(Builds, UnfinishedOnesGoOnAndServeTheNextProcess) {
  const GatedCompiler compiler;
  const TestFolder cache;
  const Program first = program_with(3), second = program_with(4), third = program_with(5), fourth = program_with(6);
  {
    Diagnostics diagnostics;
    KernelStore store = make_store(compiler.path(), cache.path());
    const Program* const programs[] = {&first, &second, &third, &fourth};
    ASSERT_TRUE(store.kernels(programs, diagnostics)) << diagnostics.text();
  }
  EXPECT_EQ(count_entries(cache.path()), 0);
  compiler.permit();
  const auto made = [&] {
    int count = 0;
    for (const auto& folder : std::filesystem::directory_iterator(cache.path()))
      count += std::filesystem::exists(folder.path() / "program.so");
    return count;
  };
  ASSERT_TRUE(soon([&] { return made() == 4; })) << made();
  Diagnostics diagnostics;
  KernelStore store = make_store(compiler.path(), cache.path());
  const Kernel* const kernel = kernel_of(store, first, diagnostics);
  ASSERT_TRUE(soon([&] { return kernel->is_compiled(); }));
  EXPECT_EQ(run(*kernel), compiled_results(first));
  EXPECT_TRUE(soon([&] { return count_files(cache.path()) == 4 && count_entries(cache.path()) == 4; }))
      << "it puts the others into the cache too, and removes the folders in which they were made";
  EXPECT_EQ(compiler.runs(), 4);
}

TEST(Builds, ProcessesWaitForEachOther) {
  const GatedCompiler compiler;
  const TestFolder cache;
  const Program program = program_with(7);
  Diagnostics diagnostics;
  KernelStore a = make_store(compiler.path(), cache.path()), b = make_store(compiler.path(), cache.path());
  const Kernel* const of_a = kernel_of(a, program, diagnostics);
  ASSERT_TRUE(soon([&] { return compiler.runs() == 1; }));
  const Kernel* const of_b = kernel_of(b, program, diagnostics);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  compiler.permit();
  EXPECT_TRUE(soon([&] { return of_a->is_compiled() && of_b->is_compiled(); }));
  EXPECT_EQ(compiler.runs(), 1);
  EXPECT_EQ(run(*of_a), run(*of_b));
}

TEST(Builds, FailuresAreWarningsAndLeaveNoFiles) {
  for (const auto& [then, words] : {std::pair{"echo no space for text; exit 1", "no space for text"},
                                    std::pair{"kill -9 $$", "failed"}, std::pair{"exit 0", "made.so"}}) {
    const GatedCompiler compiler(then);
    const TestFolder cache;
    Diagnostics diagnostics;
    KernelStore store = make_store(compiler.path(), cache.path());
    const Program program = program_with(8);
    const Kernel* const kernel = kernel_of(store, program, diagnostics);
    compiler.permit();
    ASSERT_TRUE(soon([&] {
      kernel_of(store, program, diagnostics);
      return !diagnostics.all().empty();
    }));
    ASSERT_EQ(diagnostics.all().size(), 1u) << diagnostics.text();
    EXPECT_EQ(diagnostics.all()[0].id, Id::not_compiled);
    EXPECT_FALSE(diagnostics.has_errors());
    EXPECT_NE(diagnostics.text().find(words), std::string::npos) << diagnostics.text();
    EXPECT_NE(diagnostics.text().find("the eval program of \"test\""), std::string::npos) << diagnostics.text();
    EXPECT_EQ(run(*kernel), compiled_results(program));
    EXPECT_EQ(count_files(cache.path()), 0);
  }
}

TEST(Builds, AFailureThatNobodySawIsReportedByTheNextProcess) {
  const GatedCompiler compiler("echo this fails; exit 1");
  const TestFolder cache;
  const Program program = program_with(9);
  Diagnostics diagnostics;
  {
    KernelStore store = make_store(compiler.path(), cache.path());
    kernel_of(store, program, diagnostics);
    ASSERT_TRUE(soon([&] { return compiler.runs() == 1; }));
  }
  compiler.permit();
  const std::filesystem::path folder = std::filesystem::directory_iterator(cache.path())->path();
  ASSERT_TRUE(soon([&] { return std::filesystem::exists(folder / "failed"); }));
  KernelStore store = make_store(compiler.path(), cache.path());
  ASSERT_TRUE(soon([&] {
    kernel_of(store, program, diagnostics);
    return !diagnostics.all().empty();
  }));
  EXPECT_NE(diagnostics.text().find("this fails"), std::string::npos) << diagnostics.text();
}

TEST(Builds, ACompilerThatHangsIsEnded) {
  const GatedCompiler compiler("sleep 1000 & sleep 1000");
  const TestFolder cache;
  Diagnostics diagnostics;
  KernelStore store = make_store(compiler.path(), cache.path(), Execution::at_once, 0.5);
  const Program program = program_with(10);
  kernel_of(store, program, diagnostics);
  compiler.permit();
  ASSERT_TRUE(soon([&] {
    kernel_of(store, program, diagnostics);
    return !diagnostics.all().empty();
  }));
  EXPECT_EQ(diagnostics.all()[0].id, Id::not_compiled);
  EXPECT_EQ(count_files(cache.path()), 0);
}

TEST(Builds, WhatADeadProcessLeftIsMadeAgain) {
  const GatedCompiler compiler;
  compiler.permit();
  const TestFolder cache;
  const Program program = program_with(11);
  Diagnostics diagnostics;
  {
    KernelStore store = make_store(compiler.path(), cache.path());
    const Kernel* const kernel = kernel_of(store, program, diagnostics);
    ASSERT_TRUE(soon([&] { return kernel->is_compiled(); }));
  }
  // A folder whose lock nobody holds.
  const std::string entry = std::filesystem::directory_iterator(cache.path())->path();
  std::filesystem::remove(entry);
  std::filesystem::create_directory(entry + ".making");
  write_text(entry + ".making/lock", "");
  KernelStore store = make_store(compiler.path(), cache.path());
  const Kernel* const kernel = kernel_of(store, program, diagnostics);
  EXPECT_TRUE(soon([&] { return kernel->is_compiled(); }));
  EXPECT_EQ(compiler.runs(), 2);
  EXPECT_EQ(count_files(cache.path()), 1);
  EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.text();
}

TEST(Builds, TemporaryCachesLeaveNothing) {
  const GatedCompiler compiler;
  const TestFolder temporary;
  const TestVariable no_home("HOME", nullptr), no_caches("XDG_CACHE_HOME", nullptr),
      parent("TMPDIR", temporary.path().c_str());
  {
    Diagnostics diagnostics;
    KernelStore store = make_store(compiler.path(), "");
    const Program program = program_with(12);
    run(*kernel_of(store, program, diagnostics));
    ASSERT_TRUE(soon([&] { return compiler.runs() == 1; }));
  }
  EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
}

TEST(CpuBackend, InterpretsWithoutACompiler) {
  const TestVariable nowhere("PATH", "/nowhere");
  Diagnostics diagnostics;
  CpuOptions options;
  options.execution = Execution::interpreted;
  const auto backend = create(options, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  EXPECT_EQ(backend->description().find("interpreter, lanes"), 0u) << backend->description();
  std::vector<int32_t> words, results;
  for (const float x : inputs()) words.push_back(std::bit_cast<int32_t>(x));
  const Program program = program_with(1);
  ASSERT_TRUE(backend->evaluate(program, words, rows, results, diagnostics)) << diagnostics.text();
  KernelStore store(std::nullopt, Execution::interpreted, driver::cpp, "");
  EXPECT_EQ(results, run(*kernel_of(store, program, diagnostics)));
}

}  // namespace
}  // namespace isoshade::cpu
