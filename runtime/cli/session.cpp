// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/session.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "runtime/cli/places.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::cli {

namespace fs = std::filesystem;

std::string library_root(const Common& common) {
  if (!common.library.empty()) return common.library;
  if (const char* set = std::getenv("ISOSHADE_LIBRARY"); set != nullptr && *set != '\0') return set;
  std::error_code error;
  const fs::path command = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path installed = command.parent_path().parent_path() / "share/isoshade/graphs/library";
    if (fs::is_directory(installed, error)) return installed.string();
  }
  return std::string(source_library);
}

bool flush(support::Diagnostics& diagnostics) {
  const std::string text = diagnostics.text(isatty(STDERR_FILENO) == 1);
  std::fputs(text.c_str(), stderr);
  const bool errors = diagnostics.has_errors();
  diagnostics = support::Diagnostics();
  return errors;
}

void progress(const Common& common, const std::string& line) {
  if (common.quiet || isatty(STDERR_FILENO) != 1) return;
  std::fprintf(stderr, "%s\n", line.c_str());
}

std::unique_ptr<backends::Backend> make_backend(const std::string& name, const BackendChoice& choice,
                                                const Common& common, support::Diagnostics& diagnostics) {
  if (name == "interpreter") return interpreter::create();
  if (name == "vulkan") {
#ifdef ISOSHADE_VULKAN
    vulkan::Options options;
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
  cpu::Options options;
  options.lanes = choice.lanes;
  options.threads = choice.threads;
  options.compiler = choice.compiler;
  support::Diagnostics reported;
  if (auto backend = cpu::create(options, reported)) return backend;
  const bool no_compiler = reported.all().size() == 1 && reported.all()[0].id == support::Id::no_compiler;
  if (no_compiler && choice.compiler.empty()) {
    if (!common.quiet)
      std::fputs(
          "note: there is no C++ compiler on this machine; the interpreter serves, with the same bits but "
          "slowly\n",
          stderr);
    return interpreter::create();
  }
  diagnostics = std::move(reported);
  return nullptr;
}

}  // namespace isoshade::cli
