// SPDX-License-Identifier: Apache-2.0
// What the subcommands share: where the library is, how diagnostics are printed, how backends are made.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "compiler/check/library.h"
#include "runtime/cli/arguments.h"

namespace isoshade::cli {

/// The folder of library documents: as given, the installed one beside the command, or that of
/// the source tree the command was built from.
std::string library_root(const Common& common);

/// The library as the command line has it.
check::Library make_library(const Common& common);

/// A sink that obeys -Werror and -Wno-ID, and keeps so many errors.
support::Diagnostics make_diagnostics(const Common& common, size_t limit = 50);

/// Prints what has been reported to stderr, as text or as --diagnostics says; returns whether there was an
/// error.
bool flush(support::Diagnostics& diagnostics, const Common& common);

/// Why --fail-on-nan ends with 1, also where its warnings are silenced.
inline constexpr const char* not_finite_text = "--fail-on-nan: pixels are infinite or NaN\n";

/// Progress for a person: to stderr, if that is a terminal and nobody asked for quiet.
void progress(const Common& common, const std::string& line);

/// Whether it is safe to write the file: it is none of those that have been read so far, whatever named them. Ask when
/// all is read and nothing computed. Reports if it is one.
bool may_write(const std::string& path, support::Diagnostics& diagnostics);

/// Whether "-" stands at most once among the files to be read. Reports if not.
bool read_standard_input_once(const std::vector<std::string>& inputs, support::Diagnostics& diagnostics);

/// Whether the interpreter may serve for the cpu: not where the cpu is to be proven.
enum class StandIn { allowed, refused };

/// Makes a backend by its name. Where there is no compiler and none was named, the interpreter stands in for the
/// cpu and says so.
std::unique_ptr<backends::Backend> make_backend(const std::string& name, const BackendChoice& choice,
                                                const Common& common, support::Diagnostics& diagnostics,
                                                StandIn stand_in = StandIn::allowed);

int compile(const CompileArguments& arguments, const Common& common);
int render(const RenderArguments& arguments, const Common& common);
int verify(const VerifyArguments& arguments, const Common& common);
int eval(const EvalArguments& arguments, const Common& common);
int check_documents(const CheckArguments& arguments, const Common& common);
int format(const FormatArguments& arguments, const Common& common);
int draw(const DrawArguments& arguments, const Common& common);
int bench(const BenchArguments& arguments, const Common& common);
int cache(const CacheArguments& arguments, const Common& common);
int devices(const DevicesArguments& arguments, const Common& common);
int nodes(const NodesArguments& arguments, const Common& common);
int schema(const Common& common);

}  // namespace isoshade::cli
