// SPDX-License-Identifier: Apache-2.0
// Diagnostics: what is wrong, where, and how to fix it. User errors are Diagnostics; bugs abort (assert.h).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/support/source.h"

namespace isoshade::support {

enum class Severity { warning, error };

/// Each diagnostic has one row in diagnostics.def: its printed id, its default severity and its meaning.
enum class Id {
#define DIAGNOSTIC(name, id, severity, meaning) name,
#include "compiler/support/diagnostics.def"
#undef DIAGNOSTIC
};

std::string_view id_text(Id id);   ///< "unknown-port"
Severity default_severity(Id id);
std::string_view meaning(Id id);   ///< one sentence
std::vector<Id> all_ids();

struct Note {
  Span where;
  std::string message;
};

struct Diagnostic {
  Id id;
  Severity severity;
  Span where;
  std::string message;
  std::vector<Note> notes;
  std::string fix;      ///< "did you mean \"roughness\"?"; empty if none
  std::string pointer;  ///< JSON pointer of the value, where known

  Diagnostic& note(Span where, std::string message);
  Diagnostic& note(std::string message);
  Diagnostic& suggest(std::string fix);
  Diagnostic& at(std::string json_pointer);
};

/// The sink that every stage reports to. Keeps at most `limit` errors and `limit` warnings; further ones are
/// only counted. Messages quote names and paths with quote() (visible.h), because documents are untrusted.
class Diagnostics {
 public:
  explicit Diagnostics(size_t limit = 50) : limit_(limit) {}

  /// The reference is valid until the next report.
  Diagnostic& report(Id id, Span where, std::string message);
  Diagnostic& report(Id id, std::string message) { return report(id, Span{}, std::move(message)); }
  /// Reports an unknown name `word`, and suggests the nearest candidate if one is close enough.
  Diagnostic& report_unknown(Id id, Span where, std::string message, std::string_view word,
                             const std::vector<std::string_view>& candidates);

  bool has_errors() const { return errors_ != 0; }
  size_t error_count() const { return errors_; }
  /// Whether further errors are only counted; callers then skip the work for notes and suggestions.
  bool full() const { return errors_ >= limit_; }
  const std::vector<Diagnostic>& all() const { return diagnostics_; }
  std::vector<Diagnostic>& all() { return diagnostics_; }

  void warnings_as_errors(bool on) { warnings_as_errors_ = on; }
  /// Suppresses warnings with this id; errors cannot be disabled.
  void disable(Id id) { disabled_.push_back(id); }

  /// path:line:column: error[id]: message, the source line, carets, the fix, notes. Text from documents is
  /// escaped (visible.h), so no control character reaches the terminal. Lines longer than 160 bytes are cut to
  /// a window around the caret; a tab prints as four spaces.
  std::string text(bool colour = false) const;
  /// A JSON array of {id, severity, file, line, column, pointer, message, notes, fix}, in ASCII. Lines and
  /// columns (in bytes) start at 1; a diagnostic without a location has file "" and line and column 0. A note
  /// has file, line, column and message.
  std::string json() const;

 private:
  std::vector<Diagnostic> diagnostics_;
  std::vector<Id> disabled_;
  Diagnostic dropped_{};  ///< receives reports beyond the limit and disabled ones
  size_t limit_;
  size_t errors_ = 0;
  size_t warnings_ = 0;
  bool warnings_as_errors_ = false;
};

/// The candidate nearest to `word` by edit distance, ignoring case and '_'; empty if none is close enough.
/// The work is bounded: with very many candidates, only the first ones are compared.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace isoshade::support
