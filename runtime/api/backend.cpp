// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <mutex>

#include <isoshade/runtime.h>

#include "backends/choice/choice.h"
#include "backends/shared.h"
#include "compiler/api/boundary.h"
#include "compiler/driver/driver.h"
#include "runtime/render/render.h"
#include "runtime/scene/load.h"

namespace isoshade {

struct Function::Loaded {
  driver::Program program;
  driver::Program reference;  ///< for the backend "reference"

  static bool load(Function& function, const support::Source& source, const FunctionOptions& options,
                   check::Library& library, support::Diagnostics& diagnostics);
};

struct Backend::Opened {
  std::mutex one_at_a_time;
  std::string description;
  std::string cache;  ///< BackendOptions::cache
  std::unique_ptr<backends::Backend> backend;
};

namespace {

using support::Diagnostics;

constexpr int sample_counts[] = {1, 4, 16};

std::vector<Column> columns_of(const std::vector<driver::Field>& fields) {
  std::vector<Column> columns;
  for (const driver::Field& field : fields) columns.push_back({field.name, field.type, field.words});
  return columns;
}

bool report_not_open(Diagnostics& diagnostics) {
  diagnostics.report(support::Id::missing_argument, "no backend is open");
  return false;
}

/// Applies the options to the scene; reports those that no scene can have.
bool apply(const RenderOptions& options, scene::Scene& scene, Diagnostics& diagnostics) {
  const auto is_size = [](int size) { return size >= 0 && size <= scene::max_size; };
  if (!is_size(options.width) || !is_size(options.height)) {
    diagnostics.report(support::Id::out_of_range, "an image has from 1 to " +
                                                      std::to_string(scene::max_size) + " pixels a side");
    return false;
  }
  if (options.samples != 0 && std::ranges::find(sample_counts, options.samples) == std::end(sample_counts)) {
    diagnostics.report(support::Id::out_of_range, "a pixel has 1, 4 or 16 samples");
    return false;
  }
  if (options.samples != 0) {
    scene.samples = options.samples;
    scene.samples_where = {};
  }
  return true;
}

/// Draws the scene of `source` with a backend that no other thread uses meanwhile.
bool draw(const support::Source& source, const RenderOptions& options, check::Library& library,
          backends::Backend& backend, const std::string& cache, Image& result, Diagnostics& diagnostics) {
  auto scene = scene::load_scene(source, options.settings, library.files(), diagnostics, options.time);
  if (!scene || !apply(options, *scene, diagnostics)) return false;
  render::PlanOptions plan_options;
  plan_options.width = options.width;
  plan_options.height = options.height;
  plan_options.cache = cache;
  plan_options.compiler.library = &library;
  plan_options.compiler.reference = backend.name() == "reference";
  plan_options.compiler.tier = api::tier_of(options.precision);
  const auto plan = render::plan_frame(*scene, plan_options, diagnostics);
  if (!plan) return false;
  backends::Image image;
  render::DrawStats stats;
  if (!render::render(*plan, backend, image, stats, diagnostics)) return false;
  render::warn_non_finite(*scene, *plan, stats.non_finite, diagnostics);
  result.width = image.width;
  result.height = image.height;
  result.rgba = std::move(image.rgba);
  result.depth = std::move(image.depth);
  result.srgb = scene->output.encoding == scene::Encoding::srgb;
  result.exposure = scene->output.exposure;
  return true;
}

}  // namespace

bool Function::Loaded::load(Function& function, const support::Source& source, const FunctionOptions& options,
                            check::Library& library, Diagnostics& diagnostics) {
  driver::CompileOptions compile;
  compile.library = &library;
  compile.tier = api::tier_of(options.precision);
  auto program = driver::compile_function(source, compile, diagnostics);
  if (!program) return false;
  compile.reference = true;
  Diagnostics told;  // the same warnings again
  auto reference = driver::compile_function(source, compile, told);
  if (!reference) return false;
  std::vector<Column> inputs = columns_of(program->inputs), outputs = columns_of(program->results);
  function.loaded_ = std::make_shared<const Loaded>(Loaded{*std::move(program), *std::move(reference)});
  function.inputs_ = std::move(inputs);
  function.outputs_ = std::move(outputs);
  return true;
}

Outcome Function::load_file(const std::string& path, const FunctionOptions& options) noexcept {
  return api::guarded<Outcome>(options.sources, [&](Outcome&, Diagnostics& diagnostics) {
    check::Library library = api::make_library(options.sources);
    const support::Source source = api::read(path, library, diagnostics);
    return source != nullptr && Loaded::load(*this, source, options, library, diagnostics);
  });
}

Outcome Function::load(const Document& document, const FunctionOptions& options) noexcept {
  return api::guarded<Outcome>(options.sources, [&](Outcome&, Diagnostics& diagnostics) {
    check::Library library = api::make_library(options.sources);
    return Loaded::load(*this, api::source_of(document), options, library, diagnostics);
  });
}

Outcome Backend::open(const BackendOptions& options) noexcept {
  return api::guarded<Outcome>({}, [&](Outcome&, Diagnostics& diagnostics) {
    choice::Options chosen;
    chosen.name = options.name;
    chosen.lanes = options.lanes;
    chosen.threads = options.threads;
    chosen.compiler = options.compiler;
    chosen.build_timeout = support::Seconds(options.compiler_seconds);
    chosen.cache = options.cache;
    chosen.device = options.device;
    constexpr int most_threads = 1024;
    constexpr double most_seconds = 86400;
    if (options.threads < 0 || options.threads > most_threads ||
        !(options.compiler_seconds > 0 && options.compiler_seconds <= most_seconds)) {
      diagnostics.report(support::Id::out_of_range,
                         "a backend has at most 1024 threads, and its compiler at most a day");
      return false;
    }
    auto opened = std::make_shared<Opened>();
    opened->backend = choice::create(chosen, diagnostics);
    if (opened->backend == nullptr) return false;
    opened->description = opened->backend->description();
    opened->cache = options.cache;
    opened_ = std::move(opened);
    return true;
  });
}

std::string Backend::description() const noexcept {
  struct Text : Outcome {
    std::string line;
  };
  return api::guarded<Text>({}, [&](Text& text, Diagnostics&) {
           if (opened_ != nullptr) text.line = opened_->description;
           return true;
         })
      .line;
}

Rendering Backend::render_file(const std::string& path, const RenderOptions& options) const noexcept {
  return api::guarded<Rendering>(options.sources, [&](Rendering& rendering, Diagnostics& diagnostics) {
    if (opened_ == nullptr) return report_not_open(diagnostics);
    check::Library library = api::make_library(options.sources);
    const support::Source source = api::read(path, library, diagnostics);
    const std::lock_guard lock(opened_->one_at_a_time);
    return source != nullptr &&
           draw(source, options, library, *opened_->backend, opened_->cache, rendering.image, diagnostics);
  });
}

Rendering Backend::render(const Document& scene, const RenderOptions& options) const noexcept {
  return api::guarded<Rendering>(options.sources, [&](Rendering& rendering, Diagnostics& diagnostics) {
    if (opened_ == nullptr) return report_not_open(diagnostics);
    check::Library library = api::make_library(options.sources);
    const std::lock_guard lock(opened_->one_at_a_time);
    return draw(api::source_of(scene), options, library, *opened_->backend, opened_->cache, rendering.image,
                diagnostics);
  });
}

Evaluation Backend::evaluate(const Function& function, std::span<const std::int32_t> inputs) const noexcept {
  return api::guarded<Evaluation>({}, [&](Evaluation& evaluation, Diagnostics& diagnostics) {
    if (opened_ == nullptr) return report_not_open(diagnostics);
    if (function.loaded_ == nullptr) {
      diagnostics.report(support::Id::missing_argument, "no function is loaded");
      return false;
    }
    const size_t words = backends::word_count(function.loaded_->program.inputs);
    if (words == 0 || inputs.size() % words != 0) {
      diagnostics.report(support::Id::bad_table,
                         "the inputs have " + std::to_string(inputs.size()) + " words, but a row has " +
                             std::to_string(words));
      return false;
    }
    const std::lock_guard lock(opened_->one_at_a_time);
    backends::Backend& backend = *opened_->backend;
    const bool is_reference = backend.name() == "reference";
    return backend.evaluate(is_reference ? function.loaded_->reference : function.loaded_->program, inputs,
                            inputs.size() / words, evaluation.words, diagnostics);
  });
}

}  // namespace isoshade
