// SPDX-License-Identifier: Apache-2.0
// The boundary between isoshade and the programs that link it: nothing is thrown across it, and the float mode of the
// calling thread is on one side only.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

#include <isoshade/outcome.h>

#include "compiler/check/library.h"
#include "compiler/functions/tier.h"
#include "compiler/support/boundary.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::api {

/// Sets the float mode that the C++ standard assumes, as every thread has it at its start; restores the caller's.
class DefaultFloatMode {
 public:
  DefaultFloatMode();
  ~DefaultFloatMode();
  DefaultFloatMode(const DefaultFloatMode&) = delete;
  DefaultFloatMode& operator=(const DefaultFloatMode&) = delete;

 private:
  alignas(16) unsigned char former_[32];
};

/// The functions that finish an outcome; they throw nothing.
void finish(Outcome& outcome, bool done, support::Diagnostics& diagnostics) noexcept;
void finish_without_memory(Outcome& outcome) noexcept;
void finish_after_bug(Outcome& outcome, const char* message) noexcept;

void choose_warnings(const Sources& sources, support::Diagnostics& diagnostics);

/// Calls work(result, diagnostics), which returns whether it succeeded, and fills in the outcome. A Result is an Outcome;
/// without success all else in it is empty.
template <class Result, class Work>
Result guarded(const Sources& sources, const Work& work) noexcept {
  Result result;
  Outcome outcome;
  support::let_bugs_throw();
  const DefaultFloatMode mode;
  try {
    support::Diagnostics diagnostics;
    choose_warnings(sources, diagnostics);
    const bool done = work(result, diagnostics);
    finish(outcome, done, diagnostics);
  } catch (const std::bad_alloc&) {
    finish_without_memory(outcome);
  } catch (const std::length_error&) {
    finish_without_memory(outcome);
  } catch (const std::exception& error) {
    finish_after_bug(outcome, error.what());
  } catch (...) {
    finish_after_bug(outcome, "an exception of unknown type");
  }
  if (!outcome) result = Result();
  static_cast<Outcome&>(result) = std::move(outcome);
  return result;
}

/// The library of functions, with the documents in memory.
check::Library make_library(const Sources& sources);

support::Source source_of(const Document& document);
/// A file, or the document in memory that has its path. Reports a failure and returns null.
support::Source read(const std::string& path, const check::Library& library,
                     support::Diagnostics& diagnostics);

functions::Tier tier_of(Precision precision);

}  // namespace isoshade::api
