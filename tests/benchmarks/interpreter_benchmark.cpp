// SPDX-License-Identifier: Apache-2.0
// The interpreter and compiled code on one thread: nanoseconds for a row of a table. `idle` reads the same inputs and
// writes as many results.
#include <benchmark/benchmark.h>
#include <cstdio>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "backends/interpreter/stages.h"
#include "runtime/bench/subject.h"

namespace {

using namespace isoshade;

constexpr size_t rows = 1 << 15;

void measure(benchmark::State& state, backends::Backend& backend, const driver::Program& program,
             const std::vector<int32_t>& inputs) {
  support::Diagnostics diagnostics;
  std::vector<int32_t> results;
  for (auto _ : state)
    if (!backend.evaluate(program, inputs, rows, results, diagnostics)) {
      state.SkipWithError(diagnostics.text().c_str());
      break;
    }
  state.counters["row"] = benchmark::Counter(static_cast<double>(rows), benchmark::Counter::kIsIterationInvariantRate |
                                                                            benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  check::Library library(ISOSHADE_GRAPHS "/library");
  support::Diagnostics diagnostics;
  cpu::CpuOptions options;
  options.threads = 1;
  const auto compiled = cpu::create(options, diagnostics);
  const auto interpreted = interpreter::create(1);
  if (compiled == nullptr) {
    std::fputs(diagnostics.text().c_str(), stderr);
    return 1;
  }
  for (const bench::Subject& subject : bench::subjects(ISOSHADE_GRAPHS, "")) {
    auto program = bench::compile(subject, functions::Tier::standard, library, diagnostics);
    if (!program || subject.form == "source") continue;
    const auto inputs = bench::inputs_of(subject, *program, rows);
    const auto idle = std::make_shared<const driver::Program>(bench::idle_program(*program));
    const auto kept = std::make_shared<const driver::Program>(*std::move(program));
    const interpreter::Stages decoded(*kept);
    std::printf("%s: %zu steps, %zu registers\n", subject.effect.c_str(), decoded.code().step_count(),
                decoded.code().register_count());
    for (backends::Backend* const backend : {compiled.get(), interpreted.get()}) {
      const auto add = [&](const char* what, const std::shared_ptr<const driver::Program>& run) {
        const std::string name = subject.effect + what + std::string(backend->name());
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { measure(state, *backend, *run, inputs); });
      };
      add("/", kept);
      add("/idle/", idle);
    }
  }
  benchmark::RunSpecifiedBenchmarks();
}
