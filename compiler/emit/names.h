// SPDX-License-Identifier: Apache-2.0
// Identifiers of emitted text. A graph is data: no id of a document can become a keyword, a name of the
// generated code or anything but an identifier.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compiler/emit/words.h"
#include "compiler/support/name_table.h"

namespace isoshade::emit {

/// Names of one scope, unique in it and good in every target alike.
class Names {
 public:
  /// `outer`: a scope around it, of which no name is taken again.
  explicit Names(Scope scope, const Names* outer = nullptr, size_t expected = 0)
      : scope_(scope), outer_(outer), used_(expected) {}

  /// `wanted`, or the nearest name that is free: letters, digits and single underscores, no word (words.h), not
  /// beginning with a digit or with what GLSL keeps for itself. No name is given twice.
  std::string take(std::string_view wanted) { return take(wanted, Avoid::all); }
  /// The same for a function of our own, which own_words.def may list.
  std::string take_own(std::string_view wanted) { return take(wanted, Avoid::languages); }
  /// Keeps a name of our own from being taken.
  void hold(std::string_view name) { used_.add(name); }

  /// Whether a name was taken or held in this scope itself.
  bool holds(std::string_view name, uint32_t hash) const {
    return used_.find(name, hash) != support::NameTable::npos;
  }
  /// The names that it would have taken, had not a scope around it had them.
  std::vector<std::string> take_avoided() { return std::move(avoided_); }
  /// All that it took, and all that it tried to take.
  support::NameTable take_table() { return std::move(used_); }

 private:
  std::string take(std::string_view wanted, Avoid avoid);
  bool taken(std::string_view name, uint32_t hash) const;
  bool outer_has(std::string_view name, uint32_t hash);

  Scope scope_;
  const Names* outer_;
  std::vector<std::string> avoided_;
  support::NameTable used_;  ///< with the last number tried behind each
};

/// What all names of a text that others link begin with, before an underscore: the nearest to `wanted` with which they are
/// neither words nor names of the library's functions or of the host's.
std::string prefix_of(std::string_view wanted);

/// Text made harmless for the rest of a line behind `//`: printable ASCII, no backslash, `??` or `*/`; at
/// most 200 characters.
std::string comment_text(std::string_view text);

/// The same as lines of their own, indented, each at most 100 columns long where its words allow.
void comment_lines(std::string& out, std::string_view text, size_t indent);

}  // namespace isoshade::emit
