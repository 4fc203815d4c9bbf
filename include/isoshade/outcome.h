// SPDX-License-Identifier: Apache-2.0
// What every function of the library returns beside its result: whether it succeeded, and messages as data.
#pragma once

#if __cplusplus < 202002L
#error "isoshade needs C++20: compile with -std=c++20"
#endif

#include <string>
#include <vector>

#include <isoshade/version.h>

/// Marks what the shared libraries export.
#define ISOSHADE_API __attribute__((visibility("default")))

namespace isoshade {

enum class Severity { warning, error };

/// A place in a document. Lines and columns (in bytes) start at 1; a message about no document has no file and zeros.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

/// A further place or fact that belongs to a diagnostic.
struct Note {
  Place where;
  std::string message;
};

/// What is wrong, where, and how to mend it. docs/diagnostics.md lists the ids.
struct Diagnostic {
  std::string id;  ///< "unknown-port"; stable, for programs to compare
  Severity severity = Severity::error;
  Place where;
  std::string pointer;  ///< the JSON pointer of the value: "/nodes/a/in1"; empty if there is none
  std::string message;
  std::vector<Note> notes;
  std::string suggestion;  ///< "did you mean \"roughness\"?"; empty if there is none
};

enum class Status {
  done,
  failed,          ///< the diagnostics say why
  out_of_memory,   ///< the diagnostics may be incomplete
  internal_error,  ///< a bug of isoshade, which the last diagnostic describes (id "internal-error")
};

/// Nothing is thrown and no call ends the process: whatever goes wrong stands here. The exceptions are a crash of a
/// Vulkan driver or of the operating system's loader, which run in the same process.
struct Outcome {
  Status status = Status::failed;
  std::vector<Diagnostic> diagnostics;  ///< warnings too, also if it is done
  std::string text;                     ///< the diagnostics as the command prints them, with the lines of documents

  explicit operator bool() const { return status == Status::done; }
};

/// A document that is in memory. It is found under its path as if it were a file there, and before that file.
struct Document {
  std::string path;  ///< "effects/glow.json"; relative paths in it start at its folder
  std::string text;
};

// Options have an initialiser each, so that a program may name a few of them: {.library = "shaders"}.

/// How documents are found, and which warnings are given.
struct Sources {
  /// The folder of library functions ("brdf/ggx_d" is brdf/ggx_d.json in it); empty: those installed with isoshade.
  std::string library = {};
  std::vector<Document> documents = {};
  /// Documents may name any file. Otherwise a document names only files of its own folder and below, of the folder tree
  /// that has a file isoshade.root at its top, and of the library.
  bool allow_outside = false;
  std::vector<std::string> disabled_warnings = {};  ///< ids
  bool warnings_as_errors = false;
};

/// Which bodies the functions of the library have. In each, all backends compute the same bits.
enum class Precision { fast, standard, precise };

}  // namespace isoshade
