// SPDX-License-Identifier: Apache-2.0
#include "compiler/api/boundary.h"

#include <algorithm>
#include <cfenv>
#include <cstring>

#include "compiler/graph/document.h"
#include "compiler/graph/files.h"

namespace isoshade::api {
namespace {

Place place_of(const support::Span& where) {
  if (where.file == nullptr) return {};
  const support::SourceFile::Position at = where.file->position(where.begin);
  return {where.file->path(), static_cast<int>(at.line), static_cast<int>(at.column)};
}

Diagnostic diagnostic_of(const support::Diagnostic& given) {
  Diagnostic diagnostic;
  diagnostic.id = support::id_text(given.id);
  diagnostic.severity = given.severity == support::Severity::error ? Severity::error : Severity::warning;
  diagnostic.where = place_of(given.where);
  diagnostic.pointer = given.pointer;
  diagnostic.message = given.message;
  for (const support::Note& note : given.notes)
    diagnostic.notes.push_back({place_of(note.where), note.message});
  diagnostic.suggestion = given.fix;
  return diagnostic;
}

/// Adds a diagnostic that no document causes; leaves it out if there is no memory for it.
void add_error(Outcome& outcome, std::string_view id, std::string_view message) noexcept {
  try {
    Diagnostic diagnostic;
    diagnostic.id = id;
    diagnostic.message = message;
    outcome.text += "error[" + diagnostic.id + "]: " + diagnostic.message + "\n";
    outcome.diagnostics.push_back(std::move(diagnostic));
  } catch (...) {
  }
}

}  // namespace

static_assert(sizeof(std::fenv_t) <= 32);

DefaultFloatMode::DefaultFloatMode() {
  std::fenv_t former;
  std::fegetenv(&former);
  std::memcpy(former_, &former, sizeof former);
  std::fesetenv(FE_DFL_ENV);
}

DefaultFloatMode::~DefaultFloatMode() {
  std::fenv_t former;
  std::memcpy(&former, former_, sizeof former);
  std::fesetenv(&former);
}

void finish(Outcome& outcome, bool done, support::Diagnostics& diagnostics) noexcept {
  try {
    graph::add_pointers(diagnostics);
    outcome.text = diagnostics.text();
    outcome.diagnostics.reserve(diagnostics.all().size());
    for (const support::Diagnostic& diagnostic : diagnostics.all())
      outcome.diagnostics.push_back(diagnostic_of(diagnostic));
    outcome.status = done && !diagnostics.has_errors() ? Status::done : Status::failed;
    // What failed and said nothing is a bug: a caller could not tell its user anything.
    if (!done && !diagnostics.has_errors()) finish_after_bug(outcome, "a step failed without a diagnostic");
  } catch (const std::bad_alloc&) {
    finish_without_memory(outcome);
  } catch (const std::exception& error) {
    finish_after_bug(outcome, error.what());
  }
}

void finish_without_memory(Outcome& outcome) noexcept {
  outcome.status = Status::out_of_memory;
  add_error(outcome, support::id_text(support::Id::device_limit), "this process has run out of memory");
}

void finish_after_bug(Outcome& outcome, const char* message) noexcept {
  outcome.status = Status::internal_error;
  add_error(outcome, "internal-error", message);
}

void choose_warnings(const Sources& sources, support::Diagnostics& diagnostics) {
  diagnostics.warnings_as_errors(sources.warnings_as_errors);
  for (const support::Id id : support::all_ids())
    if (std::ranges::find(sources.disabled_warnings, support::id_text(id)) != sources.disabled_warnings.end())
      diagnostics.disable(id);
}

check::Library make_library(const Sources& sources) {
  check::Library library(sources.library.empty() ? check::shipped_library() : sources.library);
  library.allow_outside(sources.allow_outside);
  for (const Document& document : sources.documents) library.add(document.path, document.text);
  return library;
}

support::Source source_of(const Document& document) {
  return std::make_shared<support::SourceFile>(document.path, document.text);
}

support::Source read(const std::string& path, const check::Library& library,
                     support::Diagnostics& diagnostics) {
  // "-" is a file here: standard input belongs to the program.
  return graph::read_document(path == "-" ? "./-" : path, library.files(), diagnostics);
}

functions::Tier tier_of(Precision precision) {
  switch (precision) {
    case Precision::fast: return functions::Tier::fast;
    case Precision::standard: return functions::Tier::standard;
    case Precision::precise: return functions::Tier::precise;
  }
  return functions::Tier::standard;
}

}  // namespace isoshade::api
