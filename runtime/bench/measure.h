// SPDX-License-Identifier: Apache-2.0
// The bench: run time and error of functions and scenes, in each tier, on each backend; tables and a plot of them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "compiler/support/process.h"

namespace isoshade::bench {

struct BenchOptions {
  std::string graphs;            ///< the folder with library/ and source_forms/
  std::string library;           ///< the folder of library documents
  std::string filter;            ///< part of the names of effects; empty: all
  size_t rows = 1 << 15;         ///< rows of a timed call on the cpu; a second call has an eighth of them
  size_t vulkan_rows = 1 << 17;  ///< the same on vulkan, where calls have more overhead
  size_t exact_rows = 2048;      ///< rows compared with the reference
  int repetitions = 31;
  std::vector<std::string> lanes;  ///< of the cpu backend; empty: all that the machine has
  int threads = 1;                 ///< of the cpu backend
  std::string compiler;            ///< for generated C++
  support::Seconds build_timeout = support::default_time_limit;
  bool vulkan = true;  ///< measure vulkan, also with GLSL's own built-ins
  bool peers = true;   ///< measure scalar C++ of others: written by hand with GLM, and made by SPIRV-Cross
  std::string device;
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// The error in ULP from which no digit is correct; a NaN or infinity in place of a number counts as this error.
inline constexpr double no_digit = 0x1p24;

/// The backend of a scene that an ordinary renderer draws on the Vulkan device: with the forward pairs of its effects and
/// posts, the device's interpolation and depth test, and GLSL's built-in functions.
inline constexpr const char* forward_backend = "forward";

/// One computation in one form and precision on one backend.
struct Point {
  std::string effect;     ///< "cook_torrance", "pow", "material_balls"
  std::string form;       ///< "source", "library", "function", "scene"
  std::string precision;  ///< "fast", "default", "precise"; "built-ins" are GLSL's own; "peer": others' C++
  std::string backend;    ///< "cpu", "vulkan"; of peers "glm", "spirv-cross"; forward_backend
  std::string lanes;      ///< of the cpu backend: "16x2"
  /// Nanoseconds for one more row of a table or one pixel of a scene, without the fixed cost of a call: the median, and
  /// the interquartile range. `transfer` is the time of a program that only reads the same inputs and writes as many
  /// results; computation may overlap with it.
  double nanoseconds = 0, spread = 0, transfer = 0;
  /// Nanoseconds for one more evaluation whose inputs are made in registers and whose results are folded: `evaluation` as
  /// a whole, `making` without the subject, `compute` the difference, with the interquartile range. Not of scenes.
  double compute = 0, compute_spread = 0, evaluation = 0, making = 0;
  /// Of the machine code that is measured by `evaluation`, on the widest lanes of the cpu: cycles for one evaluation as
  /// measured, as the ports allow, and as llvm-mca simulates; see ports.h. 0 where it is not known.
  double cycles = 0, port_cycles = 0, simulated_cycles = 0, spills = 0;
  std::string busiest = {};  ///< port, or "dispatch"
  /// Against the reference, over all components, in ULP of the exact result, at most no_digit.
  double max_ulp = 0, mean_ulp = 0;
  double max_absolute = 0;  ///< over results that are finite
  bool identical = false;   ///< whether all bits equal those of the other backends
};

struct Report {
  std::vector<std::string> machines;  ///< the description of each backend
  std::vector<std::string> notes;     ///< what was left out, and why
  double gigahertz = 0;               ///< the clock during the measurement; 0: not known
  std::vector<Point> points;
};

/// Measurements are interleaved: each repetition runs every point once. Returns nothing, with diagnostics, if something
/// cannot run.
std::optional<Report> measure(const BenchOptions& options, support::Diagnostics& diagnostics);

/// What is compared: the time of the computation alone, or that of a pixel of a scene.
inline double time_of(const Point& point) { return point.form == "scene" ? point.nanoseconds : point.compute; }

/// Whether the bits of a point may differ from ours: those of GLSL's built-ins and of peers.
inline bool is_foreign(std::string_view precision) { return precision == "built-ins" || precision == "peer"; }

/// Whether all points of the same effect, form and precision computed the same bits, but for foreign ones.
bool all_identical(const Report& report);

/// One line for each point, with a heading.
std::string csv_text(const Report& report);
std::string json_text(const Report& report);
/// The table that the command prints.
std::string summary(const Report& report);
/// For README: effects on the fastest lanes of the cpu in computation apart from transfer, the share of the port bound, and
/// ratios to scalar C++ and to Vulkan, as a table in Markdown; and a table of the scenes that an ordinary renderer drew, too.
std::string ratios_text(const Report& report);

/// The points that no other point beats in both time and error, fastest first.
std::vector<const Point*> pareto_front(const std::vector<const Point*>& points);

/// A gnuplot script that draws an SVG to the file `output`: for each effect a panel with time against largest error, for
/// the fastest lanes of the cpu and for vulkan. The shape of a mark shows the precision, filled or hollow the backend, a
/// letter "s" the source's formula; the line is the Pareto front.
std::string gnuplot_text(const Report& report, const std::string& output);

}  // namespace isoshade::bench
