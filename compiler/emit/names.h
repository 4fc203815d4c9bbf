// SPDX-License-Identifier: Apache-2.0
// Identifiers of emitted text. A graph is data: no id of a document can become a keyword, a name of the
// generated code or anything but an identifier.
#pragma once

#include <string>
#include <string_view>

#include "compiler/emit/name_table.h"

namespace isoshade::emit {

/// Names of one scope, unique in it and good in GLSL and C++ alike.
class Names {
 public:
  Names() = default;
  /// A scope inside another: names of the outer one are not taken again.
  explicit Names(const Names* outer, size_t expected = 0) : outer_(outer), used_(expected) {}

  /// `wanted`, or the nearest name that is free: letters, digits and single underscores, no keyword or name
  /// of either language or of the code around it, not beginning with a digit, "gl_" or (unless ours) "iso_".
  std::string take(std::string_view wanted);
  /// The same for a function, which must not redefine one of GLSL's own.
  std::string take_function(std::string_view wanted);
  /// Keeps a name of our own from being taken.
  void hold(std::string_view name) { used_.add(name); }

 private:
  std::string take(std::string_view wanted, bool function);
  bool taken(const std::string& name) const;

  const Names* outer_ = nullptr;
  NameTable used_;  ///< with the last number tried behind each
};

/// Text made harmless for the rest of a line behind `//`: printable ASCII, no backslash, `??` or `*/`; at
/// most 200 characters.
std::string comment_text(std::string_view text);

}  // namespace isoshade::emit
