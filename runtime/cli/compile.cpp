// SPDX-License-Identifier: Apache-2.0
// isoshade compile: writes the programs of a graph and its reflection. graphs/README.md describes the files.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "backends/cpu/compiler.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/forward.h"
#include "compiler/driver/shader.h"
#include "compiler/driver/target_limits.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/reflect/files.h"
#include "compiler/reflect/reflect.h"
#include "compiler/support/visible.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/targets.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

/// The files of a document with isoshade's stages, and what the reflection tells of them.
struct StageFiles {
  struct File {
    reflect::Stage stage;
    driver::Program program;
  };
  std::vector<File> files;
  reflect::List<reflect::RecordWords> record;

  void add(driver::Program program, std::string file, reflect::Optional<std::string> pass = {}) {
    const std::string stage(lower::name(program.stage));
    files.push_back({{{stage}, std::move(pass), std::move(file)}, std::move(program)});
  }
};

/// Writes the files of one compilation.
class Writer {
 public:
  Writer(const CompileArguments& arguments, support::Diagnostics& diagnostics)
      : arguments_(arguments), diagnostics_(diagnostics) {}

  driver::Division division() const {
    return arguments_.division == "exact" ? driver::Division::exact : driver::Division::native;
  }

  /// A kernel in each language.
  bool program(const std::string& stem, const driver::Program& program) {
    return for_each_target([&](const emit::Target& target, bool is_text, const emit::Binary* binary) {
      if (target.kernel == nullptr) return cannot(target.name, "stages for isoshade's own renderer");
      const auto backend = target.keeps_calls ? driver::Target::cpu : driver::Target::vulkan;
      if (!driver::within_limits(program, backend, division(), diagnostics_)) return false;
      const std::string text = driver::text(program, target, division());
      const std::string name = stem + std::string(target.kernel_extension(program.stage));
      if (is_text && !write(name, text)) return false;
      if (binary == nullptr) return true;
      const auto bytes = binary->compile(text, program.stage, diagnostics_, driver::description(program));
      return bytes && write(name + std::string(binary->extension), *bytes);
    });
  }

  /// A pure shader in each language.
  bool shader(const driver::Shader& shader) {
    return for_each_target([&](const emit::Target& target, bool, const emit::Binary* binary) {
      if (binary != nullptr)
        return cannot(binary->name, "functions to include", "; or add --wrapper isoshade");
      return driver::within_limits(shader, target, division(), diagnostics_) &&
             write(shader.pure.name + std::string(target.extension), driver::text(shader, target));
    });
  }

  std::vector<driver::ForwardPair> pairs(const driver::Shader& shader, const emit::Target& target) const {
    const auto sampling =
        arguments_.hardware_samplers ? emit::ForwardSampling::samplers : emit::ForwardSampling::fetch;
    return driver::forward_pairs(shader, target, sampling);
  }

  /// The forward pairs in each language.
  bool forward(const driver::Shader& shader) {
    if (shader.kind == graph::DocumentKind::function) {
      diagnostics_
          .report(support::Id::unsupported, "a function has no vertices and pixels to stand around it")
          .suggest("leave out --wrapper forward");
      return false;
    }
    return for_each_target([&](const emit::Target& target, bool, const emit::Binary* binary) {
      if (binary != nullptr || target.forward == nullptr)
        return cannot(binary != nullptr ? binary->name : target.name, "forward shaders");
      if (!driver::within_limits(shader, target, division(), diagnostics_)) return false;
      for (const driver::ForwardPair& pair : pairs(shader, target)) {
        const std::string stem = pair.stem + std::string(target.forward_infix);
        if (!write(stem + ".vert", pair.text.vertex) || !write(stem + ".frag", pair.text.fragment))
          return false;
      }
      return true;
    });
  }

  bool stages(const StageFiles& stages) {
    return std::ranges::all_of(stages.files,
                               [&](const auto& file) { return program(file.stage.file, file.program); });
  }

  /// The reflection comes first: if it would overwrite a document, no other file is written either.
  bool all(const driver::Shader& shader, const std::optional<StageFiles>& stages,
           const graph::FileRule& files) {
    const bool is_forward = arguments_.wrapper == Wrapper::forward;
    std::vector<driver::ForwardPair> bound;  // alike in all languages
    if (is_forward) bound = pairs(shader, glsl::target());
    auto reflection = reflect::reflect(shader, {division(), files, arguments_.check, bound}, diagnostics_);
    if (!reflection) return false;
    for (const reflect::ReadFile& read : reflect::files_of(*shader.typed, files))
      if (read.file.role == reflect::FileRole::image && read.file.sha256) images_.push_back(read.path);
    if (stages) {
      reflection->stages = reflect::Stages{{}, stages->record};
      for (const StageFiles::File& file : stages->files) reflection->stages->programs.push_back(file.stage);
    }
    if (!write(reflection->name + ".json", reflect::json(*reflection))) return false;
    if (stages) return this->stages(*stages);
    return is_forward ? forward(shader) : this->shader(shader);
  }

  bool headers() {
    if (!wants("cpp") || arguments_.without_lanes) return true;
    for (const cpu::Header& header : cpu::lanes_headers())
      if (!write(std::string(header.path), header.text)) return false;
    return true;
  }

  bool write(const std::string& name, std::string_view bytes) {
    if (arguments_.output.empty() || arguments_.dump_after == "help") return true;
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

  /// The rule that says what the files depend on: the document, the functions that it uses, its images.
  bool depfile(const check::Library& library) {
    if (arguments_.depfile.empty() || written_.empty()) return true;
    std::string rule;
    for (const std::string& path : written_) rule += escaped(path) + " ";
    rule.back() = ':';
    rule += " " + escaped(arguments_.graph);
    for (const std::vector<std::string>& paths : {library.loaded(), images_})
      for (const std::string& path : paths) rule += " \\\n  " + escaped(path);
    return may_write(arguments_.depfile, diagnostics_) &&
           scene::write_file(arguments_.depfile, rule + "\n", diagnostics_);
  }

  const std::vector<std::string>& written() const { return written_; }

 private:
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

  /// A path as make and ninja read it.
  static std::string escaped(const std::string& path) {
    std::string text;
    for (const char c : path) {
      if (c == ' ' || c == '#') text += '\\';
      if (c == '$') text += '$';
      text += c;
    }
    return text;
  }

  bool wants(std::string_view target) const {
    if (!arguments_.targets.empty())
      return std::ranges::find(arguments_.targets, target) != arguments_.targets.end();
    return target == "glsl" || (target == "cpp" && arguments_.wrapper != Wrapper::forward);
  }

  /// Calls `write` for each language of which the text or the binary form is wanted.
  template <class Write>
  bool for_each_target(Write write) {
    for (const emit::Target* target : targets::all()) {
      const bool is_text = wants(target->name);
      const bool is_binary = target->binary != nullptr && wants(target->binary->name);
      if ((is_text || is_binary) && !write(*target, is_text, is_binary ? target->binary : nullptr))
        return false;
    }
    return true;
  }

  bool cannot(std::string_view target, std::string_view what, std::string_view other_fix = "") {
    diagnostics_
        .report(support::Id::unsupported, "there are no " + std::string(what) + " in " + std::string(target))
        .suggest("leave " + std::string(target) + " out of --target" + std::string(other_fix));
    return false;
  }

  const CompileArguments& arguments_;
  support::Diagnostics& diagnostics_;
  std::vector<std::string> written_;
  std::vector<std::string> images_;  ///< paths of those that were read, to hash them
};

/// The common beginning of the file names of a pass. Two names of 128 characters with an extension exceed the length
/// limit of file names; long names are therefore cut, and the number of the pass keeps them unique ("." is in no name).
std::string pass_stem(const driver::Effect& effect, size_t pass) {
  constexpr size_t limit = 200;
  const std::string stem = effect.name + "." + effect.passes[pass].name;
  if (stem.size() <= limit) return stem;
  return effect.name.substr(0, 96) + "." + effect.passes[pass].name.substr(0, 96) + "." +
         std::to_string(pass);
}

std::optional<StageFiles> stages_of(const support::Source& source, graph::DocumentKind kind,
                                    const driver::CompileOptions& options,
                                    support::Diagnostics& diagnostics) {
  StageFiles stages;
  switch (kind) {
    case graph::DocumentKind::function:
      if (auto program = driver::compile_function(source, options, diagnostics)) {
        const std::string name = program->name;
        stages.add(*std::move(program), name);
        return stages;
      }
      return std::nullopt;
    case graph::DocumentKind::post:
      if (auto post = driver::compile_post(source, options, diagnostics)) {
        stages.record = reflect::record_of(post->parameters, 0);
        stages.add(std::move(post->program), post->name + ".post");
        return stages;
      }
      return std::nullopt;
    case graph::DocumentKind::effect:
    case graph::DocumentKind::scene: break;
  }
  auto effect = driver::compile_effect(source, options, diagnostics);
  if (!effect) return std::nullopt;
  stages.record = reflect::record_of(effect->parameters, lower::object_word::parameters);
  for (size_t i = 0; i < effect->passes.size(); ++i) {
    driver::EffectPass& pass = effect->passes[i];
    const std::string stem = pass_stem(*effect, i);
    stages.add(std::move(pass.vertex), stem + ".vertex", pass.name);
    stages.add(std::move(pass.pixel), stem + ".pixel", pass.name);
  }
  return stages;
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
  const support::Source source = graph::read_source(arguments.graph, diagnostics);
  const auto kind = source != nullptr ? driver::kind_of(source, diagnostics) : std::nullopt;
  bool done = false;
  if (kind) {
    std::optional<StageFiles> stages;
    driver::CompileOptions shader_options = options;
    if (arguments.wrapper == Wrapper::isoshade) {
      stages = stages_of(source, *kind, options, diagnostics);
      shader_options.dump = {};  // of the stages alone
    }
    if (stages || arguments.wrapper != Wrapper::isoshade) {
      const auto shader =
          driver::compile_shader(source, shader_options, {arguments.prefix, writer.division()}, diagnostics);
      done = shader && writer.all(*shader, stages, library.files());
    }
  }
  if (done) done = writer.headers() && writer.depfile(library);
  if (done && !arguments.dump_after.empty() && !lists_stages && dumped == 0)
    diagnostics.report(support::Id::unknown_stage, "there is no stage \"" + arguments.dump_after + "\"")
        .suggest("`--dump-after help` lists the stages of this graph");
  if (flush(diagnostics, common) || !done) return failure;
  if (!common.quiet)
    for (const std::string& path : writer.written())
      if (path.find("isoshade/lanes/") == std::string::npos) std::fprintf(stderr, "wrote %s\n", path.c_str());
  return success;
}

}  // namespace isoshade::cli
