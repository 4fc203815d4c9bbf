// SPDX-License-Identifier: Apache-2.0
// How long large graphs take, JSON text to both texts, in this process, and whether that is linear.
#include <benchmark/benchmark.h>
#include <memory>
#include <string>

#include "compiler/driver/driver.h"

namespace {

using namespace isoshade;

/// A function of `count` nodes of different kinds, each of which reads two before it.
std::string graph_of(int64_t count) {
  std::string text =
      R"({"isoshade": 1, "function": "large", "inputs": {"n0": {"type": "float"}, "n1": {"type": "float"}}, "nodes": {)";
  const auto name = [](int64_t i) { return "\"n" + std::to_string(i) + "\""; };
  for (int64_t i = 2; i < count + 2; ++i) {
    text += (i > 2 ? ",\n" : "\n") + name(i) + ": ";
    const std::string a = name(i - 1), b = name(i - 2 - (i % 7 < i - 2 ? i % 7 : 0));
    switch (i % 5) {
      case 0: text += R"({"type": "multiply", "in1": )" + a + R"(, "in2": )" + b + "}"; break;
      case 1: text += R"({"type": "mix", "fg": )" + a + R"(, "bg": )" + b + R"(, "mix": 0.25})"; break;
      case 2: text += R"({"type": "max", "in1": )" + a + R"(, "in2": )" + b + "}"; break;
      case 3: text += R"({"type": "sin", "in": )" + a + "}"; break;
      default: text += R"({"type": "add", "in1": )" + a + R"(, "in2": )" + b + "}"; break;
    }
  }
  return text + "\n}, \"outputs\": {\"out\": " + name(count + 1) + "}}";
}

void nodes(benchmark::State& state) {
  const std::string text = graph_of(state.range(0));
  for (auto _ : state) {
    support::Diagnostics diagnostics;
    check::Library library;
    driver::CompileOptions options;
    options.library = &library;
    const auto source = std::make_shared<const support::SourceFile>("large.json", text);
    const auto program = driver::compile_function(source, options, diagnostics);
    if (!program) {
      state.SkipWithError(diagnostics.text().c_str());
      break;
    }
    benchmark::DoNotOptimize(driver::glsl(*program, driver::Division::native));
    benchmark::DoNotOptimize(driver::cpp(*program));
  }
  state.SetComplexityN(state.range(0));
}

BENCHMARK(nodes)
    ->Arg(1'000)
    ->Arg(10'000)
    ->Arg(30'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

}  // namespace

BENCHMARK_MAIN();
