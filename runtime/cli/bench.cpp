// SPDX-License-Identifier: Apache-2.0
// isoshade bench: measures run time and error; writes tables and a plot.
#include <cstdio>
#include <filesystem>

#include "compiler/support/process.h"
#include "compiler/support/visible.h"
#include "runtime/bench/frames.h"
#include "runtime/bench/measure.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

namespace fs = std::filesystem;

/// The path of gnuplot. Called first, so that a missing gnuplot is reported before the long measurement.
std::optional<std::string> find_gnuplot(support::Diagnostics& diagnostics) {
  const std::string program = support::find_program("gnuplot");
  if (!program.empty()) return program;
  diagnostics.report(support::Id::no_gnuplot, "there is no `gnuplot` on PATH")
      .suggest("install the package gnuplot-nox, or pass --no-picture");
  return std::nullopt;
}

bool draw_picture(const std::string& gnuplot, const std::string& script, support::Seconds limit,
                  support::Diagnostics& diagnostics) {
  const auto end = support::run_process({gnuplot, script}, {}, limit);
  if (end && end->late) {
    support::report_late(support::Id::no_gnuplot, gnuplot, "draw " + support::quote(script), limit,
                         diagnostics)
        .suggest("raise the limit (--build-timeout SECONDS), or pass --no-picture");
    return false;
  }
  if (end && end->status == 0) return true;
  diagnostics.report(support::Id::no_gnuplot,
                     "`gnuplot` failed: " + (end ? support::quote(end->output) : "it cannot be run"));
  return false;
}

bench::BenchOptions options_of(const BenchArguments& arguments, const Common& common) {
  bench::BenchOptions options;
  options.library = common.library.empty() ? check::shipped_library() : common.library;
  options.graphs = fs::path(options.library).parent_path().string();
  options.filter = arguments.only;
  options.lanes = arguments.lanes;
  options.threads = arguments.choice.threads > 0 ? arguments.choice.threads : 1;
  options.compiler = arguments.choice.compiler;
  options.build_timeout = common.build_timeout;
  options.device = arguments.choice.device;
  options.vulkan = !arguments.without_vulkan;
  options.progress = [&common](const std::string& line) { progress(common, line); };
  if (arguments.quick) {
    options.rows = 1 << 12;
    options.vulkan_rows = 1 << 13;
    options.exact_rows = 128;
    options.repetitions = 3;
  }
  if (arguments.repetitions > 0) options.repetitions = arguments.repetitions;
  return options;
}

/// Writes the tables, and the plot unless `gnuplot` is empty.
template <class Report>
bool write_report(const Report& report, const std::string& folder, const char* name, const std::string& gnuplot,
                  const Common& common, support::Diagnostics& diagnostics) {
  std::error_code error;
  fs::create_directories(folder, error);  // write_file reports a failure
  const std::string stem = folder + "/" + name;
  return scene::write_file(stem + ".csv", bench::csv_text(report), diagnostics) &&
         scene::write_file(stem + ".json", bench::json_text(report), diagnostics) &&
         (gnuplot.empty() || (scene::write_file(stem + ".gp", bench::gnuplot_text(report, stem + ".svg"), diagnostics) &&
                              draw_picture(gnuplot, stem + ".gp", common.build_timeout, diagnostics)));
}

bool bench_frames(const BenchArguments& arguments, const Common& common, const std::string& gnuplot,
                  support::Diagnostics& diagnostics) {
  bench::FrameBenchOptions options{options_of(arguments, common), arguments.sizes, {}};
  if (arguments.repetitions == 0) options.common.repetitions = arguments.quick ? 3 : 9;
  if (arguments.quick && options.sizes.empty()) options.sizes = {256};
  if (arguments.choice.threads > 0) options.threads = {arguments.choice.threads};
  const auto report = bench::measure_frames(options, diagnostics);
  if (!report) return false;
  if (report->points.empty()) {
    diagnostics
        .report(support::Id::missing_argument, "no scene has a name that contains " + support::quote(arguments.only))
        .suggest("omit --only to measure all");
    return false;
  }
  if (!common.quiet) std::fputs(bench::summary(*report).c_str(), stdout);
  return arguments.output.empty() || write_report(*report, arguments.output, "frames", gnuplot, common, diagnostics);
}

bool bench_to_folder(const BenchArguments& arguments, const Common& common, support::Diagnostics& diagnostics,
                     bool& identical) {
  const bool draws = !arguments.output.empty() && !arguments.without_picture;
  const std::optional<std::string> gnuplot = draws ? find_gnuplot(diagnostics) : std::string();
  if (!gnuplot) return false;
  if (arguments.frames) return bench_frames(arguments, common, *gnuplot, diagnostics);
  const auto report = bench::measure(options_of(arguments, common), diagnostics);
  if (!report) return false;
  if (report->points.empty()) {
    diagnostics
        .report(support::Id::missing_argument,
                "no effect, function or scene has a name that contains " + support::quote(arguments.only))
        .suggest("omit --only to list all");
    return false;
  }
  identical = bench::all_identical(*report);
  const std::string ratios = bench::ratios_text(*report);
  if (!common.quiet) std::fputs((bench::summary(*report) + "\n" + ratios).c_str(), stdout);
  return arguments.output.empty() ||
         (write_report(*report, arguments.output, "bench", *gnuplot, common, diagnostics) &&
          scene::write_file(arguments.output + "/bench.md", ratios, diagnostics));
}

}  // namespace

int bench(const BenchArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  bool identical = true;
  const bool done = bench_to_folder(arguments, common, diagnostics, identical);
  if (flush(diagnostics, common) || !done) return failure;
  if (!identical) std::printf("the backends computed different bits at some points\n");
  return identical ? success : different;
}

}  // namespace isoshade::cli
