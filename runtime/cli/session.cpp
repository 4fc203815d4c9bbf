// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/session.h"

#include <algorithm>
#include <cstdio>
#include <unistd.h>

#include "backends/choice/choice.h"
#include "compiler/support/read_file.h"
#include "compiler/support/visible.h"

namespace isoshade::cli {

check::Library make_library(const Common& common) {
  check::Library library(common.library.empty() ? check::shipped_library() : common.library);
  library.allow_outside(common.allow_outside);
  return library;
}

support::Diagnostics make_diagnostics(const Common& common, size_t limit) {
  support::Diagnostics diagnostics(limit);
  diagnostics.warnings_as_errors(common.warnings_as_errors);
  for (const support::Id id : support::all_ids())
    if (std::ranges::find(common.disabled, support::id_text(id)) != common.disabled.end())
      diagnostics.disable(id);
  return diagnostics;
}

bool flush(support::Diagnostics& diagnostics, const Common& common) {
  if (common.json) graph::add_pointers(diagnostics);
  const std::string text = common.json ? diagnostics.json() : diagnostics.text(isatty(STDERR_FILENO) == 1);
  std::fputs(text.c_str(), stderr);
  return diagnostics.has_errors();
}

bool may_write(const std::string& path, support::Diagnostics& diagnostics) {
  if (path == "-" || !support::was_read(path)) return true;
  diagnostics
      .report(support::Id::unwritable_file, "writing " + support::quote(path) + " would destroy an input")
      .suggest("choose another name for the output");
  return false;
}

std::optional<ImageOutput> image_output(const std::string& path, const OutputChoice& choice, int threads,
                                        support::Diagnostics& diagnostics) {
  ImageOutput output;
  output.format = scene::output_format(path, choice.format, diagnostics);
  if (output.format == nullptr) return std::nullopt;
  output.options.threads = threads;
  output.options.quality = choice.quality.value_or(output.options.quality);
  for (const auto& [name, compression] : scene::lossless_compressions)
    if (choice.compression == name) output.options.compression = compression;
  const auto needs = [&](const char* option, const std::string& format) {
    if (output.format->name == format) return true;
    diagnostics
        .report(support::Id::missing_argument,
                std::string(option) + " needs the format " + format + ", not " + std::string(output.format->name))
        .suggest("end the name of the output in ." + format + ", or leave " + option + " out");
    return false;
  };
  if (!choice.compression.empty() && !needs("--compression", "exr")) return std::nullopt;
  if (choice.quality && !needs("--quality", "jpg")) return std::nullopt;
  return output;
}

bool read_standard_input_once(const std::vector<std::string>& inputs, support::Diagnostics& diagnostics) {
  if (std::count(inputs.begin(), inputs.end(), "-") <= 1) return true;
  diagnostics
      .report(support::Id::unreadable_file, "\"-\" is given twice, but standard input can be read only once")
      .suggest("pass all but one as files");
  return false;
}

void progress(const Common& common, const std::string& line) {
  if (common.quiet || isatty(STDERR_FILENO) != 1) return;
  std::fprintf(stderr, "%s\n", line.c_str());
}

std::unique_ptr<backends::Backend> make_backend(const std::string& name, const BackendChoice& choice,
                                                const Common& common, support::Diagnostics& diagnostics,
                                                cpu::Execution execution) {
  choice::Options options;
  options.name = name;
  options.lanes = choice.lanes;
  options.threads = choice.threads;
  options.execution = execution;
  options.compiler = choice.compiler;
  options.build_timeout = common.build_timeout;
  options.device = choice.device;
  options.division = choice.division;
  support::Diagnostics reported;
  if (auto backend = choice::create(options, reported)) {
    for (const support::Diagnostic& warning : reported.all())
      if (std::ranges::find(diagnostics.all(), warning.message, &support::Diagnostic::message) ==
          diagnostics.all().end())
        diagnostics.report(warning.id, warning.message).suggest(warning.fix);
    return backend;
  }
  if (execution == cpu::Execution::at_once && choice::may_stand_in(options, reported)) {
    if (!common.quiet)
      std::fputs(
          "note: there is no C++ compiler on this machine; the interpreter runs the programs, which is slower but "
          "computes the same bits\n",
          stderr);
    options.execution = cpu::Execution::interpreted;
    return choice::create(options, diagnostics);
  }
  diagnostics = std::move(reported);
  return nullptr;
}

}  // namespace isoshade::cli
