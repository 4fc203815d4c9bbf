// SPDX-License-Identifier: Apache-2.0
// What went wrong, where, and the way out. Errors of the user are Diagnostics; bugs abort.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/support/source.h"

namespace isoshade::support {

enum class Severity { warning, error };

/// Every diagnostic has one row in diagnostics.def: its id as printed, its severity, what it means.
enum class Id {
#define DIAGNOSTIC(name, id, severity, meaning) name,
#include "compiler/support/diagnostics.def"
#undef DIAGNOSTIC
};

std::string_view id_text(Id id);   ///< "unknown-port"
Severity default_severity(Id id);  ///< as in the table
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

/// The sink that every stage writes to. Keeps at most `limit` errors and as many warnings; later ones are
/// counted. A name or a file in a message is put there by quote() of visible.h: a document may say anything.
class Diagnostics {
 public:
  explicit Diagnostics(size_t limit = 50) : limit_(limit) {}

  /// The reference is valid until the next report.
  Diagnostic& report(Id id, Span where, std::string message);
  Diagnostic& report(Id id, std::string message) { return report(id, Span{}, std::move(message)); }
  /// Reports that nothing is called `word`, and suggests the candidate nearest to it, if one is near.
  Diagnostic& report_unknown(Id id, Span where, std::string message, std::string_view word,
                             const std::vector<std::string_view>& candidates);

  bool has_errors() const { return errors_ != 0; }
  size_t error_count() const { return errors_; }
  /// Whether further errors are only counted: work on their notes and suggestions is lost.
  bool full() const { return errors_ >= limit_; }
  const std::vector<Diagnostic>& all() const { return diagnostics_; }
  std::vector<Diagnostic>& all() { return diagnostics_; }

  void warnings_as_errors(bool on) { warnings_as_errors_ = on; }
  /// Drops an id where it is a warning; errors cannot be disabled.
  void disable(Id id) { disabled_.push_back(id); }

  /// path:line:column: error[id]: message, the source line, a caret, the fix, notes. Whatever a document put
  /// into it is made visible: no control character reaches the terminal. Of lines beyond 160 bytes the part
  /// around the caret is shown; a tab is shown as four blanks.
  std::string text(bool colour = false) const;
  /// An array of {id, severity, file, line, column, pointer, message, notes, fix}, in ASCII. Lines and
  /// columns (in bytes) count from 1; where a diagnostic has no place, file is "" and both are 0. A note has
  /// file, line, column and message.
  std::string json() const;

 private:
  std::vector<Diagnostic> diagnostics_;
  std::vector<Id> disabled_;
  Diagnostic dropped_{};  ///< where reports past the limit and disabled ones are written
  size_t limit_;
  size_t errors_ = 0;
  size_t warnings_ = 0;
  bool warnings_as_errors_ = false;
};

/// The candidate nearest to `word` by edit distance (case and '_' count little), or empty if none is near
/// enough to suggest. Work is bounded, so of very many candidates only the first ones are looked at.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace isoshade::support
