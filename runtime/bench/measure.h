// SPDX-License-Identifier: Apache-2.0
// Run time and error of the bench's subjects, in each tier, on each backend.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "compiler/support/process.h"

namespace isoshade::bench {

struct BenchOptions {
  std::string graphs;            ///< the folder with library/ and source_forms/
  std::string library;           ///< the folder of library documents
  std::string filter;            ///< a part of the effects' names; empty: all
  size_t rows = 1 << 15;         ///< timed at once on the cpu; an eighth of them too
  size_t vulkan_rows = 1 << 17;  ///< the same on vulkan, where a call takes longer
  size_t exact_rows = 2048;      ///< compared with the reference
  int repetitions = 31;
  std::vector<std::string> lanes;  ///< of the cpu backend; empty: all that the machine has
  int threads = 1;                 ///< of the cpu backend
  std::string compiler;            ///< of generated C++
  support::Seconds build_timeout = support::default_time_limit;
  bool vulkan = true;  ///< with GLSL's own built-ins beside it
  std::string device;
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// An error of this size, or of more, leaves no digit right; NaN and infinities in place of numbers count as it.
inline constexpr double no_digit = 0x1p24;

/// One computation in one form and precision on one backend.
struct Point {
  std::string effect;     ///< "cook_torrance", "pow", "material_balls"
  std::string form;       ///< "source", "library", "function", "scene"
  std::string precision;  ///< "fast", "default", "precise"; "built-ins" are GLSL's own
  std::string backend;    ///< "cpu", "vulkan"
  std::string lanes;      ///< of the cpu: "16x2"
  /// Of one more row of a table, or of a pixel of a scene, in nanoseconds: the median and the distance of the
  /// quartiles. What a call takes however small it is, is not in it. `transfer` is what a program takes that only reads
  /// the same inputs and writes as many results; of it a computation hides a part.
  double nanoseconds = 0, spread = 0, transfer = 0;
  /// Against the reference, over all components, in units in the last place of the exact result, at most no_digit.
  double max_ulp = 0, mean_ulp = 0;
  double max_absolute = 0;  ///< of results that are numbers
  bool identical = false;   ///< whether every bit is that of the other backends
};

struct Report {
  std::vector<std::string> machines;  ///< what each backend says of itself
  std::vector<Point> points;
};

/// Times are interleaved: each repetition visits every point. Nothing, with diagnostics, where something cannot run.
std::optional<Report> measure(const BenchOptions& options, support::Diagnostics& diagnostics);

/// Whether every point but the built-ins computed the same bits as the others of its effect, form and precision.
bool all_identical(const Report& report);

}  // namespace isoshade::bench
