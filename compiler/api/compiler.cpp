// SPDX-License-Identifier: Apache-2.0
#include <isoshade/compiler.h>

#include "compiler/api/artifacts.h"
#include "compiler/api/boundary.h"
#include "compiler/driver/fixed_settings.h"

namespace isoshade {

namespace {

using support::Diagnostics;

bool compile_source(const support::Source& source, const CompileOptions& options, check::Library& library,
                    Compilation& made, Diagnostics& diagnostics) {
  driver::CompileOptions compile;
  compile.library = &library;
  compile.tier = api::tier_of(options.precision);
  api::ArtifactOptions wanted;
  wanted.targets = options.targets;
  wanted.wrapper = options.wrapper;
  wanted.hardware_samplers = options.hardware_samplers;
  wanted.prove = options.prove;
  wanted.prefix = options.prefix;
  wanted.division = options.exact_division ? driver::Division::exact : driver::Division::native;
  const driver::Checked document = driver::check_document(source, compile, diagnostics);
  auto fixed = document ? driver::fixed_words(*document, options.fixed, diagnostics) : std::nullopt;
  if (!fixed) return false;
  compile.fixed = *std::move(fixed);
  auto artifacts = api::make_artifacts(document, compile, wanted, diagnostics);
  if (!artifacts) return false;
  made.files = std::move(artifacts->files);
  made.read = std::move(artifacts->read);
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
