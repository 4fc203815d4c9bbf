// SPDX-License-Identifier: Apache-2.0
// isoshade draw: draws a graph as a diagram.
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "compiler/driver/diagram.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/explain.h"
#include "compiler/driver/fixed_settings.h"
#include "compiler/support/process.h"
#include "compiler/support/temporary.h"
#include "compiler/support/visible.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

namespace fs = std::filesystem;

/// Runs Graphviz on `dot` and returns its output in `format`. Passes files, which needs no shell.
std::optional<std::string> lay_out(const std::string& dot, const std::string& document,
                                   const std::string& format, support::Seconds limit,
                                   support::Diagnostics& diagnostics) {
  const auto fail = [&](const std::string& message) {
    diagnostics.report(support::Id::no_graphviz, message)
        .suggest("install the package graphviz, or write a .dot file and draw it on another machine");
    return std::nullopt;
  };
  const std::string program = support::find_program("dot");
  if (program.empty()) return fail("there is no `dot` on PATH");
  const auto folder = support::TemporaryFolder::make(support::temporary_parent());
  if (!folder) {
    const int failure = errno;
    diagnostics
        .report(support::Id::unwritable_file, "cannot create a temporary folder in " +
                                                  support::quote(support::temporary_parent()) + ": " +
                                                  std::strerror(failure))
        .suggest("set TMPDIR to a writable folder");
    return std::nullopt;
  }
  const std::string input = folder->path() + "/graph.dot";
  const std::string output = folder->path() + "/graph." + format;
  if (!scene::write_file(input, dot, diagnostics)) return std::nullopt;
  const auto end = support::run_process({program, "-T" + format, "-o", output, input}, {}, limit);
  if (end && end->late) {
    support::report_late(support::Id::no_graphviz, program, "draw " + support::quote(document), limit,
                         diagnostics)
        .suggest(
            "raise the limit (--build-timeout SECONDS), or write a .dot file and draw it with another layout");
    return std::nullopt;
  }
  if (!end || end->status != 0)
    return fail("`dot` failed: " + (end ? support::quote(end->output) : "it cannot be run"));
  const support::Source diagram = graph::read_source(output, diagnostics);
  return diagram != nullptr ? std::optional(diagram->text()) : std::nullopt;
}

bool draw_to_file(const DrawArguments& arguments, const Common& common, support::Diagnostics& diagnostics) {
  const std::string format = fs::path(arguments.output).extension().string();
  if (format != ".svg" && format != ".png" && format != ".dot") {
    diagnostics.report(support::Id::unwritable_file,
                       support::quote(arguments.output) + " does not end in .svg, .png or .dot");
    return false;
  }
  check::Library library = make_library(common);
  driver::CompileOptions options;
  options.library = &library;
  const support::Source source = graph::read_source(arguments.graph, diagnostics);
  if (source == nullptr) return false;
  const auto graph = driver::check_document(source, options, diagnostics);
  if (graph == nullptr || !may_write(arguments.output, diagnostics)) return false;
  std::set<std::string> left_out;
  if (arguments.after_specialisation) {
    const auto general = driver::compile_shader(graph, options, {}, diagnostics);
    auto fixed = general ? driver::fixed_words(*graph, arguments.settings, diagnostics) : std::nullopt;
    if (!fixed) return false;
    options.fixed = *std::move(fixed);
    const auto shader = driver::compile_shader(graph, options, {}, diagnostics);
    if (!shader) return false;
    left_out = driver::explain(*general, *shader).left_out();
  }
  const std::string dot = driver::draw(*graph, arguments.depth, left_out);
  if (format == ".dot") return scene::write_file(arguments.output, dot, diagnostics);
  const auto diagram = lay_out(dot, arguments.graph, format.substr(1), common.build_timeout, diagnostics);
  return diagram && scene::write_file(arguments.output, *diagram, diagnostics);
}

}  // namespace

int draw(const DrawArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const bool done = draw_to_file(arguments, common, diagnostics);
  return flush(diagnostics, common) || !done ? failure : success;
}

}  // namespace isoshade::cli
