// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/feed.h"

#include <memory>

#include "compiler/driver/driver.h"
#include "compiler/graph/document.h"
#include "compiler/support/assert.h"
#include "runtime/scene/load.h"

namespace isoshade {
namespace {

void feed_effect(const support::Source& source, const driver::CompileOptions& options,
                 support::Diagnostics& diagnostics) {
  const auto effect = driver::compile_effect(source, options, diagnostics);
  support::assert_that(effect.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!effect) return;
  for (const driver::EffectPass& pass : effect->passes) {
    support::assert_that(!driver::glsl(pass.pixel, driver::Division::exact).empty(), "no GLSL");
    support::assert_that(!driver::cpp(pass.pixel).empty(), "no C++");
    for (const std::optional<driver::Program>* program : {&pass.cutout, &pass.blend}) {
      if (!*program) continue;
      support::assert_that(!driver::glsl(**program, driver::Division::exact).empty(), "no GLSL");
      support::assert_that(!driver::glsl_of_layer(**program, driver::Division::exact).empty(), "no GLSL of a layer");
      support::assert_that(!driver::cpp(**program).empty(), "no C++");
    }
  }
}

void feed_post(const support::Source& source, const driver::CompileOptions& options,
               support::Diagnostics& diagnostics) {
  const auto post = driver::compile_post(source, options, diagnostics);
  support::assert_that(post.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!post) return;
  support::assert_that(!driver::glsl(post->program, driver::Division::exact).empty(), "no GLSL");
  support::assert_that(!driver::cpp(post->program).empty(), "no C++");
}

void feed_function(const support::Source& source, const driver::CompileOptions& options,
                   support::Diagnostics& diagnostics) {
  const auto program = driver::compile_function(source, options, diagnostics);
  support::assert_that(program.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!program) return;
  support::assert_that(!driver::glsl(*program, driver::Division::native).empty(), "no GLSL");
  support::assert_that(!driver::cpp(*program).empty(), "no C++");
}

}  // namespace

support::Diagnostics feed(std::string_view text) {
  support::Diagnostics diagnostics;
  static check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  const auto source = std::make_shared<support::SourceFile>("/nowhere/fuzz.json", std::string(text));
  const auto document = graph::parse_document(source, diagnostics);
  if (!document) return diagnostics;
  support::assert_that(!graph::format(*document).empty(), "no text");
  const auto kind = graph::document_kind(*document, diagnostics);
  if (!kind) return diagnostics;
  if (*kind == graph::DocumentKind::scene) {
    scene::load_scene(source, {}, library.files(), diagnostics);
  } else if (*kind == graph::DocumentKind::effect) {
    feed_effect(source, options, diagnostics);
  } else if (*kind == graph::DocumentKind::post) {
    feed_post(source, options, diagnostics);
  } else {
    feed_function(source, options, diagnostics);
  }
  // What is told must be tellable.
  support::assert_that(diagnostics.text().size() < (4u << 20), "a flood of text");
  support::assert_that(diagnostics.json().size() < (4u << 20), "a flood of text");
  return diagnostics;
}

}  // namespace isoshade
