// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/session.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <unistd.h>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "backends/reference/backend.h"
#include "compiler/support/read_file.h"
#include "compiler/support/visible.h"
#include "runtime/cli/places.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::cli {

namespace fs = std::filesystem;

std::string library_root(const Common& common) {
  if (!common.library.empty()) return common.library;
  std::error_code error;
  const fs::path command = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path installed = command.parent_path().parent_path() / "share/isoshade/graphs/library";
    if (fs::is_directory(installed, error)) return installed.string();
  }
  return std::string(source_library);
}

check::Library make_library(const Common& common) {
  check::Library library(library_root(common));
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
  if (common.json) {
    std::set<support::Source> sources;
    for (const support::Diagnostic& diagnostic : diagnostics.all()) sources.insert(diagnostic.where.file);
    for (const support::Source& source : sources) {
      support::Diagnostics ignored;
      const auto document = source != nullptr ? graph::parse_document(source, ignored) : std::nullopt;
      if (document) graph::add_pointers(*document, diagnostics);
    }
  }
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
                                                StandIn stand_in) {
  if (name == "interpreter") return interpreter::create();
  if (name == "reference") return reference::create();
  if (name == "vulkan") {
#ifdef ISOSHADE_VULKAN
    vulkan::VulkanOptions options;
    options.device = choice.device;
    if (!choice.division.empty())
      options.division = choice.division == "exact" ? driver::Division::exact : driver::Division::native;
    return vulkan::create(options, diagnostics);
#else
    diagnostics.report(support::Id::no_device, "this isoshade was built without Vulkan")
        .suggest("build with -DISOSHADE_VULKAN=ON");
    return nullptr;
#endif
  }
  cpu::CpuOptions options;
  options.lanes = choice.lanes;
  options.threads = choice.threads;
  options.compiler = choice.compiler;
  options.build_timeout = common.build_timeout;
  support::Diagnostics reported;
  if (auto backend = cpu::create(options, reported)) {
    for (const support::Diagnostic& warning : reported.all())
      if (std::ranges::find(diagnostics.all(), warning.message, &support::Diagnostic::message) ==
          diagnostics.all().end())
        diagnostics.report(warning.id, warning.message).suggest(warning.fix);
    return backend;
  }
  const bool no_compiler = reported.all().size() == 1 && reported.all()[0].id == support::Id::no_compiler;
  const char* named = std::getenv("ISOSHADE_CXX");
  const bool asked_for = !choice.compiler.empty() || (named != nullptr && *named != '\0');
  if (no_compiler && !asked_for && stand_in == StandIn::allowed) {
    if (!common.quiet)
      std::fputs(
          "note: there is no C++ compiler on this machine; using the interpreter, which is slower but computes the same "
          "bits\n",
          stderr);
    return interpreter::create();
  }
  diagnostics = std::move(reported);
  return nullptr;
}

}  // namespace isoshade::cli
