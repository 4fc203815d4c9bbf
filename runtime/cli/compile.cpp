// SPDX-License-Identifier: Apache-2.0
// isoshade compile: writes the programs of a graph and its reflection. graphs/README.md describes the files.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "backends/cpu/compiler.h"
#include "compiler/api/artifacts.h"
#include "compiler/driver/explain.h"
#include "compiler/driver/fixed_settings.h"
#include "compiler/support/visible.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

/// Writes the files of one compilation.
class Writer {
 public:
  Writer(const CompileArguments& arguments, support::Diagnostics& diagnostics)
      : arguments_(arguments), diagnostics_(diagnostics) {}

  /// The reflection comes first: if it would overwrite a document, no other file is written either.
  bool all(const api::Artifacts& made) {
    if (arguments_.output.empty() || arguments_.dump_after == "help") return true;
    const auto put = [&](const File& file) { return write(file.name, file.bytes); };
    return std::ranges::all_of(made.files, put) && headers(made) && depfile(made);
  }

  const std::vector<std::string>& written() const { return written_; }

 private:
  bool write(const std::string& name, std::string_view bytes) {
    const std::filesystem::path path = std::filesystem::path(arguments_.output) / name;
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(),
                                        error);  // write_file reports a failure
    if (!may_write(path.string(), diagnostics_)) return false;
    if (is_document(path)) {
      diagnostics_
          .report(support::Id::unwritable_file,
                  support::quote(path.string()) + " is a document, which the reflection would overwrite")
          .suggest("choose another folder with -o");
      return false;
    }
    if (!is_kept(path, bytes) && !scene::write_file(path.string(), bytes, diagnostics_)) return false;
    written_.push_back(path.string());
    return true;
  }

  /// What the C++ includes.
  bool headers(const api::Artifacts& made) {
    const auto is_cpp = [](const File& file) {
      return file.name.ends_with(".h") || file.name.ends_with(".cpp");
    };
    if (arguments_.without_lanes || std::ranges::none_of(made.files, is_cpp)) return true;
    return std::ranges::all_of(cpu::lanes_headers(), [&](const cpu::Header& header) {
      return write(std::string(header.path), header.text);
    });
  }

  /// The rule that says what the files depend on.
  bool depfile(const api::Artifacts& made) {
    if (arguments_.depfile.empty()) return true;
    std::error_code error;
    for (const std::string& path : written_)
      if (std::filesystem::equivalent(path, arguments_.depfile, error)) {
        diagnostics_
            .report(support::Id::unwritable_file, "--depfile would overwrite " + support::quote(path) +
                                                      ", which has just been written")
            .suggest("choose another name for it");
        return false;
      }
    for (const std::vector<std::string>& paths : {written_, made.read})
      for (const std::string& path : paths)
        if (std::ranges::any_of(path, [](char c) { return c >= 0 && c < ' '; })) {
          diagnostics_.report(support::Id::unwritable_file,
                              "make and ninja cannot read the path " + support::quote(path) + " in a rule");
          return false;
        }
    std::string rule;
    for (const std::string& path : written_) rule += escaped(path) + " ";
    rule.back() = ':';
    for (const std::string& path : made.read) rule += " \\\n  " + escaped(path);
    return may_write(arguments_.depfile, diagnostics_) &&
           scene::write_file(arguments_.depfile, rule + "\n", diagnostics_);
  }

  /// Written to the folder of its graph, the reflection may have the same file name as the graph.
  static bool is_document(const std::filesystem::path& path) {
    std::error_code error;
    if (path.extension() != ".json" || !std::filesystem::is_regular_file(path, error)) return false;
    support::Diagnostics ignored;
    const support::Source source = graph::read_source(path.string(), ignored);
    const auto document = source ? graph::parse_document(source, ignored) : std::nullopt;
    return document && document->root.find("isoshade") != nullptr;
  }

  /// Whether the file has these bytes, and a build tool wants to know that they did not change. The first file tells it
  /// when this ran.
  bool is_kept(const std::filesystem::path& path, std::string_view bytes) const {
    if (arguments_.depfile.empty() || written_.empty()) return false;
    std::ifstream file(path, std::ios::binary);
    return file && std::equal(std::istreambuf_iterator<char>(file), {}, bytes.begin(), bytes.end());
  }

  /// A path as ninja reads it. So does make, but for a backslash before # or a colon.
  static std::string escaped(const std::string& path) {
    std::string text;
    size_t backslashes = 0;
    for (const char c : path) {
      if (c == ' ') text.append(backslashes, '\\');
      if (c == ' ' || c == '#' || c == ':') text += '\\';
      if (c == '$') text += '$';
      text += c;
      backslashes = c == '\\' ? backslashes + 1 : 0;
    }
    return text;
  }

  const CompileArguments& arguments_;
  support::Diagnostics& diagnostics_;
  std::vector<std::string> written_;
};

/// False after an error.
bool print_explanation(const driver::Checked& document, driver::CompileOptions options, support::Diagnostics& diagnostics) {
  options.dump = {};
  const auto fixed = driver::compile_shader(document, options, {}, diagnostics);
  options.fixed = {};
  const auto general = fixed ? driver::compile_shader(document, options, {}, diagnostics) : std::nullopt;
  if (!general) return false;
  std::fputs(driver::text(driver::explain(*general, *fixed), *fixed).c_str(), stdout);
  return true;
}

}  // namespace

int compile(const CompileArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  check::Library library = make_library(common);
  driver::CompileOptions options;
  options.library = &library;
  options.tier = arguments.precision;
  int dumped = 0;
  const bool lists_stages = arguments.dump_after == "help";
  std::set<std::string, std::less<>> listed;  // some passes run more than once
  if (!arguments.dump_after.empty())
    options.dump = [&](std::string_view stage, const std::function<std::string()>& text) {
      if (lists_stages && listed.emplace(stage).second)
        std::printf("%.*s\n", static_cast<int>(stage.size()), stage.data());
      if (arguments.dump_after != stage) return;
      ++dumped;
      std::printf("# after %.*s\n%s", static_cast<int>(stage.size()), stage.data(), text().c_str());
    };

  Writer writer(arguments, diagnostics);
  api::ArtifactOptions wanted;
  wanted.targets = arguments.targets;
  wanted.wrapper = arguments.wrapper;
  wanted.hardware_samplers = arguments.hardware_samplers;
  wanted.prove = arguments.check;
  wanted.prefix = arguments.prefix;
  wanted.division = arguments.division == "exact" ? driver::Division::exact : driver::Division::native;
  const support::Source source = graph::read_source(arguments.graph, diagnostics);
  const driver::Checked document = source ? driver::check_document(source, options, diagnostics) : nullptr;
  auto fixed = document ? driver::fixed_words(*document, arguments.settings, diagnostics) : std::nullopt;
  if (fixed) options.fixed = *std::move(fixed);
  if (!fixed || (arguments.explain && !print_explanation(document, options, diagnostics))) {
    flush(diagnostics, common);
    return failure;
  }
  const auto made = api::make_artifacts(document, options, wanted, diagnostics);
  const bool has_stage = arguments.dump_after.empty() || lists_stages || dumped > 0;
  if (made && !has_stage)
    diagnostics.report(support::Id::unknown_stage, "there is no stage \"" + arguments.dump_after + "\"")
        .suggest("`--dump-after help` lists the stages of this graph");
  const bool done = made && has_stage && writer.all(*made);
  if (flush(diagnostics, common) || !done) return failure;
  if (!common.quiet)
    for (const std::string& path : writer.written())
      if (path.find("isoshade/lanes/") == std::string::npos) std::fprintf(stderr, "wrote %s\n", path.c_str());
  return success;
}

}  // namespace isoshade::cli
