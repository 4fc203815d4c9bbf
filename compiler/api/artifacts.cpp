// SPDX-License-Identifier: Apache-2.0
#include "compiler/api/artifacts.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "compiler/driver/forward.h"
#include "compiler/driver/shader.h"
#include "compiler/driver/target_limits.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/reflect/files.h"
#include "compiler/reflect/reflect.h"
#include "compiler/support/visible.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/targets.h"

namespace isoshade::api {
namespace {

using support::Diagnostics;

/// The stages of a document for isoshade's own renderer, and what the reflection tells of them.
struct Stages {
  struct Stage {
    reflect::Stage stage;
    driver::Program program;
  };
  std::vector<Stage> all;
  reflect::List<reflect::RecordWords> record;

  void add(driver::Program program, std::string file, reflect::Optional<std::string> pass = {}) {
    const std::string stage(lower::name(program.stage));
    all.push_back({{{stage}, std::move(pass), std::move(file)}, std::move(program)});
  }
};

std::optional<Stages> stages_of(const driver::Checked& document, driver::CompileOptions compile,
                                Diagnostics& diagnostics) {
  // Who fills records by the reflection knows nothing of what a draw computes.
  compile.skips.set(interface::Skip::rates, false);
  Stages stages;
  switch (document->graph.kind) {
    case graph::DocumentKind::function:
      if (auto program = driver::compile_function(document, compile, diagnostics)) {
        const std::string name = program->name;
        stages.add(*std::move(program), name);
        return stages;
      }
      return std::nullopt;
    case graph::DocumentKind::post: {
      driver::Post post = driver::post_of(document, compile);
      driver::make_program(post, compile);
      stages.record = reflect::record_of(post.parameters, 0);
      stages.add(std::move(post.program), post.name + ".post");
      return stages;
    }
    case graph::DocumentKind::effect:
    case graph::DocumentKind::scene:
    case graph::DocumentKind::image: break;
  }
  driver::Effect effect = driver::effect_of(document, compile);
  driver::make_programs(effect, compile);
  stages.record = reflect::record_of(effect.parameters, lower::object_word::parameters);
  for (size_t i = 0; i < effect.passes.size(); ++i) {
    driver::EffectPass& pass = effect.passes[i];
    const std::string stem = driver::pass_stem(effect.name, pass.name, i);
    stages.add(std::move(pass.vertex), stem + ".vertex", pass.name);
    if (pass.cutout) stages.add(*std::move(pass.cutout), stem + ".cutout", pass.name);
    if (pass.blend) stages.add(*std::move(pass.blend), stem + ".blend", pass.name);
    stages.add(std::move(pass.pixel), stem + ".pixel", pass.name);
  }
  return stages;
}

/// Makes the files of one document.
class Maker {
 public:
  Maker(const ArtifactOptions& options, Diagnostics& diagnostics)
      : options_(options), diagnostics_(diagnostics) {}

  /// Whether all targets exist; reports those that do not.
  bool check_targets() {
    const auto exists = [](const std::string& name) {
      return targets::find(name) != nullptr || targets::find_binary(name) != nullptr;
    };
    const auto missing = std::ranges::find_if_not(options_.targets, exists);
    if (missing == options_.targets.end()) return true;
    support::Diagnostic& report =
        diagnostics_.report(support::Id::unknown_choice, "there is no target " + support::quote(*missing));
    for (const emit::Target* target : targets::all()) {
      report.note(std::string(target->name) + ": " + std::string(target->doc));
      if (target->binary != nullptr)
        report.note(std::string(target->binary->name) + ": " + std::string(target->binary->doc));
    }
    return false;
  }

  /// The reflection, then the texts: of the stages if they are wanted, else of the shader.
  std::optional<Artifacts> make(const driver::Shader& shader, const std::optional<Stages>& stages,
                                const graph::FileRule& rule) {
    const bool is_forward = options_.wrapper == Wrapper::forward;
    std::vector<driver::ForwardPair> bound;  // alike in all languages
    if (is_forward) bound = pairs(shader, glsl::target());
    auto reflection =
        reflect::reflect(shader, {rule, options_.prove, bound}, diagnostics_);
    if (!reflection) return std::nullopt;
    if (stages) {
      reflection->stages = reflect::Stages{{}, stages->record};
      for (const Stages::Stage& stage : stages->all) reflection->stages->programs.push_back(stage.stage);
    }
    add(reflection->name + ".json", reflect::json(*reflection));
    for (reflect::ReadFile& read : reflect::files_of(*shader.typed, rule)) {
      if (!read.file.sha256) note_unread(read);
      made_.read.push_back(read.file.sha256 ? std::move(read.path) : nearest_folder(read.path));
    }
    const bool done = stages ? std::ranges::all_of(stages->all, [&](const auto& s) { return add_stage(s); })
                      : is_forward ? add_forward(shader)
                                   : add_pure(shader);
    return done ? std::optional(std::move(made_)) : std::nullopt;
  }

 private:
  void note_unread(const reflect::ReadFile& image) {
    diagnostics_
        .report(support::Id::unread_image, image.where,
                "the image " + support::quote(image.file.path) + " cannot be read, so the reflection has no hash of it")
        .note("`isoshade render` would not accept it");
  }

  static std::string nearest_folder(std::filesystem::path path) {
    std::error_code error;
    do path = path.parent_path();
    while (path.has_relative_path() && !std::filesystem::is_directory(path, error));
    return path.empty() ? "." : path.string();
  }

  void add(std::string name, std::string bytes) {
    made_.files.push_back({std::move(name), std::move(bytes)});
  }

  /// A kernel in each language.
  bool add_stage(const Stages::Stage& stage) {
    const driver::Program& program = stage.program;
    return for_each_target([&](const emit::Target& target, bool is_text, const emit::Binary* binary) {
      if (target.kernel == nullptr) return cannot(target.name, "stages for isoshade's own renderer");
      const auto backend = target.keeps_calls ? driver::Target::cpu : driver::Target::vulkan;
      if (!driver::within_limits(program, backend, options_.division, diagnostics_)) return false;
      const std::string text = driver::text(program, target, options_.division);
      const std::string name = stage.stage.file + std::string(target.kernel_extension(program.stage));
      if (is_text) add(name, text);
      if (binary == nullptr) return true;
      auto bytes = binary->kernel(text, program.stage, diagnostics_, driver::description(program));
      if (bytes) add(name + std::string(binary->extension), *std::move(bytes));
      return bytes.has_value();
    });
  }

  /// A pure shader in each language.
  bool add_pure(const driver::Shader& shader) {
    return for_each_target([&](const emit::Target& target, bool, const emit::Binary* binary) {
      if (binary != nullptr)
        return cannot(binary->name, "functions to include", "; or add --wrapper forward or isoshade");
      if (!driver::within_limits(shader, target, options_.division, diagnostics_)) return false;
      add(shader.pure.name + std::string(target.extension), driver::text(shader, target));
      return true;
    });
  }

  std::vector<driver::ForwardPair> pairs(const driver::Shader& shader, const emit::Target& target) const {
    const auto sampling =
        options_.hardware_samplers ? emit::ForwardSampling::samplers : emit::ForwardSampling::fetch;
    return driver::forward_pairs(shader, target, sampling);
  }

  /// The forward pairs in each language.
  bool add_forward(const driver::Shader& shader) {
    return for_each_target([&](const emit::Target& target, bool is_text, const emit::Binary* binary) {
      if (target.forward == nullptr) return cannot(target.name, "forward shaders");
      if (!driver::within_limits(shader, target, options_.division, diagnostics_)) return false;
      for (const driver::ForwardPair& pair : pairs(shader, target)) {
        const std::string stem = pair.stem + std::string(target.forward_infix);
        const auto add_pair = [&](const emit::ForwardText& text, std::string_view extension) {
          add(stem + ".vert" + std::string(extension), text.vertex);
          add(stem + ".frag" + std::string(extension), text.fragment);
        };
        if (is_text) add_pair(pair.text, "");
        if (binary == nullptr) continue;
        const auto bytes = binary->forward(pair.text, diagnostics_, support::quote(pair.stem));
        if (!bytes) return false;
        add_pair(*bytes, binary->extension);
      }
      return true;
    });
  }

  bool wants(std::string_view target) const {
    if (!options_.targets.empty())
      return std::ranges::find(options_.targets, target) != options_.targets.end();
    return target == "glsl" || (target == "cpp" && options_.wrapper != Wrapper::forward);
  }

  /// Calls `make` for each language of which the text or the binary form is wanted.
  template <class Make>
  bool for_each_target(Make make) {
    for (const emit::Target* target : targets::all()) {
      const bool is_text = wants(target->name);
      const bool is_binary = target->binary != nullptr && wants(target->binary->name);
      if ((is_text || is_binary) && !make(*target, is_text, is_binary ? target->binary : nullptr))
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

  const ArtifactOptions& options_;
  Diagnostics& diagnostics_;
  Artifacts made_;
};

}  // namespace

std::optional<Artifacts> make_artifacts(const driver::Checked& document, const driver::CompileOptions& compile,
                                        const ArtifactOptions& options, Diagnostics& diagnostics) {
  if (options.hardware_samplers && options.wrapper != Wrapper::forward) {
    diagnostics.report(support::Id::unsupported, "only forward shaders read images by samplers")
        .suggest("add --wrapper forward, or leave out --sampling");
    return std::nullopt;
  }
  Maker maker(options, diagnostics);
  if (!maker.check_targets()) return std::nullopt;
  if (document->graph.kind == graph::DocumentKind::function && options.wrapper == Wrapper::forward) {
    diagnostics.report(support::Id::unsupported, "a function has no vertices and pixels to stand around it")
        .suggest("leave out --wrapper forward");
    return std::nullopt;
  }
  driver::CompileOptions of_shader = compile;
  std::optional<Stages> stages;
  if (options.wrapper == Wrapper::isoshade) {
    stages = stages_of(document, compile, diagnostics);
    if (!stages) return std::nullopt;
    of_shader.dump = {};  // of the stages alone
  }
  const auto shader =
      driver::compile_shader(document, of_shader, {options.prefix, options.division}, diagnostics);
  if (!shader) return std::nullopt;
  if (options.wrapper == Wrapper::forward && !driver::can_be_forward(*shader, diagnostics)) return std::nullopt;
  return maker.make(*shader, stages, compile.library->files());
}

}  // namespace isoshade::api
