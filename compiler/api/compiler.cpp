// SPDX-License-Identifier: Apache-2.0
#include <isoshade/compiler.h>

#include "compiler/api/boundary.h"
#include "compiler/driver/shader.h"
#include "compiler/driver/target_limits.h"
#include "compiler/graph/document.h"
#include "compiler/reflect/files.h"
#include "compiler/reflect/reflect.h"
#include "compiler/support/visible.h"
#include "compiler/targets/targets.h"

namespace isoshade {

namespace {

using support::Diagnostics;

/// The languages by their names; nothing if there is none of a name, which is reported.
std::optional<std::vector<const emit::Target*>> find_targets(const std::vector<std::string>& names,
                                                             Diagnostics& diagnostics) {
  std::vector<const emit::Target*> found;
  for (const std::string& name : names) {
    found.push_back(targets::find(name));
    if (found.back() != nullptr) continue;
    support::Diagnostic& report =
        diagnostics.report(support::Id::unknown_choice, "there is no target " + support::quote(name));
    for (const emit::Target* target : targets::all())
      report.note(std::string(target->name) + ": " + std::string(target->doc));
    return std::nullopt;
  }
  return found;
}

bool compile_source(const support::Source& source, const CompileOptions& options, check::Library& library,
                    Compilation& made, Diagnostics& diagnostics) {
  const auto languages = find_targets(options.targets, diagnostics);
  if (!languages) return false;
  driver::CompileOptions compile;
  compile.library = &library;
  compile.tier = api::tier_of(options.precision);
  const auto division = options.exact_division ? driver::Division::exact : driver::Division::native;
  const auto shader = driver::compile_shader(source, compile, {options.prefix, division}, diagnostics);
  if (!shader) return false;
  for (const emit::Target* target : *languages) {
    if (!driver::within_limits(*shader, *target, division, diagnostics)) return false;
    made.files.push_back(
        {shader->pure.name + std::string(target->extension), driver::text(*shader, *target)});
  }
  const auto reflection = reflect::reflect(*shader, {division, library.files(), false, {}}, diagnostics);
  if (!reflection) return false;
  made.files.push_back({shader->pure.name + ".json", reflect::json(*reflection)});
  for (reflect::ReadFile& file : reflect::files_of(*shader->typed, library.files()))
    made.read.push_back(std::move(file.path));
  return true;
}

}  // namespace

const char* version() noexcept { return ISOSHADE_VERSION; }

Compilation compile_file(const std::string& path, const CompileOptions& options) noexcept {
  return api::guarded<Compilation>(options.sources, [&](Compilation& made, Diagnostics& diagnostics) {
    check::Library library = api::make_library(options.sources);
    const support::Source source = api::read(path, library, diagnostics);
    return source != nullptr && compile_source(source, options, library, made, diagnostics);
  });
}

Compilation compile(const Document& document, const CompileOptions& options) noexcept {
  return api::guarded<Compilation>(options.sources, [&](Compilation& made, Diagnostics& diagnostics) {
    check::Library library = api::make_library(options.sources);
    return compile_source(api::source_of(document), options, library, made, diagnostics);
  });
}

}  // namespace isoshade
