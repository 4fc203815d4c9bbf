// SPDX-License-Identifier: Apache-2.0
// How long JSON text to both texts takes, in this process.
#include <benchmark/benchmark.h>
#include <fstream>
#include <sstream>

#include "compiler/driver/driver.h"

namespace {

using namespace isoshade;

std::string read(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The material with a library that has been used before, as in an editor, or with a new one. Texts of functions that are
/// not the document's own are known after the first turn, with either.
void material(benchmark::State& state, bool new_library) {
  const std::string path = ISOSHADE_GRAPHS "/materials/cook_torrance.json";
  const std::string text = read(path);
  check::Library shared(ISOSHADE_GRAPHS "/library");
  for (auto _ : state) {
    support::Diagnostics diagnostics;
    check::Library fresh(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = new_library ? &fresh : &shared;
    const auto source = std::make_shared<const support::SourceFile>(path, text);
    const auto effect = driver::compile_effect(source, options, diagnostics);
    if (!effect) {
      state.SkipWithError(diagnostics.text().c_str());
      break;
    }
    benchmark::DoNotOptimize(driver::glsl(effect->passes[0].pixel, driver::Division::native));
    benchmark::DoNotOptimize(driver::cpp(effect->passes[0].pixel));
  }
}

BENCHMARK_CAPTURE(material, with_a_warm_library, false)->Unit(benchmark::kMicrosecond)->Repetitions(9);
BENCHMARK_CAPTURE(material, with_a_new_library, true)->Unit(benchmark::kMicrosecond)->Repetitions(9);

}  // namespace

BENCHMARK_MAIN();
