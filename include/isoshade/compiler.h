// SPDX-License-Identifier: Apache-2.0
// The compiler as a library: a graph in, shaders out.
//
//     const isoshade::Compilation made = isoshade::compile_file("effects/glow.json", {.targets = {"glsl"}});
//     if (!made) return report(made.text);
//     compile_glsl(my_fragment_shader + made.find("glow.glsl")->bytes);
//
// In CMake: find_package(isoshade REQUIRED) and target_link_libraries(program PRIVATE isoshade::compiler).
//
// Any number of threads may call any function at the same time.
#pragma once

#include <isoshade/outcome.h>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade {

/// The version of the library that is linked; ISOSHADE_VERSION is that of the headers.
ISOSHADE_API const char* version() noexcept;

/// What stands around the functions that a document becomes.
enum class Wrapper {
  none,      ///< nothing: they are included in programs of your own
  forward,   ///< an ordinary vertex and fragment shader for each pass, outside of the contract
  isoshade,  ///< the stages that isoshade's own renderer runs
};

struct CompileOptions {
  Sources sources = {};
  /// "glsl", "cpp", "glsl-es", with a wrapper "spirv"; empty: glsl and, unless the wrapper is forward, cpp.
  std::vector<std::string> targets = {};
  Wrapper wrapper = Wrapper::none;
  bool hardware_samplers = false;  ///< forward: images are read by samplers, not by isoshade's own filters
  std::string prefix = {};         ///< of all names; empty: the document's name
  Precision precision = Precision::standard;
  /// For GPUs whose `/` and sqrt are not correctly rounded: computes both by multiplications and integers.
  bool exact_division = false;
  /// Adds to the reflection what `isoshade check` finds; takes seconds where much is left to prove.
  bool prove = false;
  /// "rim=0": values of parameters of an effect or a post, as `--set` of the command. The functions are compiled for these
  /// values alone, and lose what only others need; the struct of parameters keeps all fields. Of an image only that there is
  /// none: "map=\"\"". Of several values for one parameter, the last one counts.
  std::vector<std::string> fixed = {};
};

/// A file as `isoshade compile -o FOLDER` writes it. C++ includes the headers that are installed in isoshade/lanes.
struct File {
  std::string name;  ///< "glow.glsl"; "glow.json" is the reflection (graphs/README.md, "Reflection")
  std::string bytes;
};

struct Compilation : Outcome {
  std::vector<File> files;
  /// Paths of the documents and images that decide the result; for an image that is missing, the folder in which it would
  /// appear.
  std::vector<std::string> read;

  /// Null if there is no file of this name.
  const File* find(std::string_view name) const {
    for (const File& file : files)
      if (file.name == name) return &file;
    return nullptr;
  }
};

/// Compiles an effect, a post or a function (graphs/README.md, "What compile writes").
ISOSHADE_API Compilation compile_file(const std::string& path, const CompileOptions& options = {}) noexcept;

/// The same for a document in memory; its path need not exist.
ISOSHADE_API Compilation compile(const Document& document, const CompileOptions& options = {}) noexcept;

}  // namespace isoshade
