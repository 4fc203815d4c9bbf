// SPDX-License-Identifier: Apache-2.0
// What the subcommands share: finding the library, loading scenes, printing diagnostics, creating backends.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "compiler/check/library.h"
#include "runtime/cli/arguments.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene {
struct Scene;
}

namespace isoshade::cli {

/// The library, with the options of the command line.
check::Library make_library(const Common& common);

/// Diagnostics that respect -Werror and -Wno-ID and keep up to `limit` errors.
support::Diagnostics make_diagnostics(const Common& common, size_t limit = 50);

/// Prints the diagnostics to stderr, in the format of --diagnostics. Returns whether there is an error.
bool flush(support::Diagnostics& diagnostics, const Common& common);

/// Printed when --fail-on-nan makes the exit code 1, even if the warning is disabled.
inline constexpr const char* not_finite_text = "--fail-on-nan: pixels are infinite or NaN\n";

/// Prints a line of progress to stderr, if that is a terminal and --quiet is not set.
void progress(const Common& common, const std::string& line);

/// Reads a scene and applies the changes of the command line. A glTF file of --mesh is centred and scaled to unit size.
std::optional<scene::Scene> load_scene(const std::string& path, const SceneChanges& changes,
                                       const Common& common, support::Diagnostics& diagnostics);

/// Applies the changes of the command line that are not settings to a scene. Reports a mesh that nothing can show.
bool apply_changes(const SceneChanges& changes, scene::Scene& scene, support::Diagnostics& diagnostics);

/// Returns false, with a diagnostic, if the file has been read in this run, by whatever path. Call it after reading all
/// inputs and before computing.
bool may_write(const std::string& path, support::Diagnostics& diagnostics);

/// How a subcommand writes its image.
struct ImageOutput {
  const scene::ImageFormat* format = nullptr;
  scene::WriteOptions options;  ///< encoding and exposure are the scene's
};

/// Nothing, with a diagnostic, if the format is not known or an option does not concern it. Call it before rendering.
std::optional<ImageOutput> image_output(const std::string& path, const OutputChoice& choice, int threads,
                                        support::Diagnostics& diagnostics);

/// Returns false, with a diagnostic, if "-" occurs more than once among the inputs.
bool read_standard_input_once(const std::vector<std::string>& inputs, support::Diagnostics& diagnostics);

/// Creates a backend by its name. `execution`: of the cpu backend. With Execution::at_once, programs are interpreted if there
/// is no compiler and the user named none, with a note on stderr.
std::unique_ptr<backends::Backend> make_backend(const std::string& name, const BackendChoice& choice,
                                                const Common& common, support::Diagnostics& diagnostics,
                                                cpu::Execution execution = cpu::Execution::at_once);

int compile(const CompileArguments& arguments, const Common& common);
int render(const RenderArguments& arguments, const Common& common);
int sheet(const SheetArguments& arguments, const Common& common);
int verify(const VerifyArguments& arguments, const Common& common);
int eval(const EvalArguments& arguments, const Common& common);
int check_documents(const CheckArguments& arguments, const Common& common);
int format(const FormatArguments& arguments, const Common& common);
int draw(const DrawArguments& arguments, const Common& common);
int page(const PageArguments& arguments, const Common& common);
int bench(const BenchArguments& arguments, const Common& common);
int cache(const CacheArguments& arguments, const Common& common);
int devices(const DevicesArguments& arguments, const Common& common);
int nodes(const NodesArguments& arguments, const Common& common);
int schema(const SchemaArguments& arguments, const Common& common);

}  // namespace isoshade::cli
