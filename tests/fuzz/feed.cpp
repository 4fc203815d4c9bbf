// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/feed.h"

#include <memory>

#include "compiler/driver/driver.h"
#include "compiler/graph/format.h"
#include "compiler/support/check.h"
#include "runtime/scene/load.h"

namespace isoshade {
namespace {

void feed_effect(const support::Source& source, const driver::Options& options,
                 support::Diagnostics& diagnostics) {
  const auto effect = driver::compile_effect(source, options, diagnostics);
  support::check(effect.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!effect) return;
  for (const driver::Pass& pass : effect->passes) {
    support::check(!driver::glsl(pass.pixel, driver::Division::exact).empty(), "no GLSL");
    support::check(!driver::cpp(pass.pixel).empty(), "no C++");
  }
}

void feed_post(const support::Source& source, const driver::Options& options,
               support::Diagnostics& diagnostics) {
  const auto post = driver::compile_post(source, options, diagnostics);
  support::check(post.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!post) return;
  support::check(!driver::glsl(post->program, driver::Division::exact).empty(), "no GLSL");
  support::check(!driver::cpp(post->program).empty(), "no C++");
}

void feed_function(const support::Source& source, const driver::Options& options,
                   support::Diagnostics& diagnostics) {
  const auto program = driver::compile_function(source, options, diagnostics);
  support::check(program.has_value() != diagnostics.has_errors(), "neither errors nor a program");
  if (!program) return;
  support::check(!driver::glsl(*program, driver::Division::native).empty(), "no GLSL");
  support::check(!driver::cpp(*program).empty(), "no C++");
}

}  // namespace

support::Diagnostics feed(std::string_view text) {
  support::Diagnostics diagnostics;
  static check::Library library(ISOSHADE_GRAPHS "/library");
  driver::Options options;
  options.library = &library;
  const auto source = std::make_shared<support::SourceFile>("/nowhere/fuzz.json", std::string(text));
  const auto document = graph::parse_document(source, diagnostics);
  if (!document) return diagnostics;
  support::check(!graph::format(*document).empty(), "no text");
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
  support::check(diagnostics.text().size() < (4u << 20), "a flood of text");
  support::check(diagnostics.json().size() < (4u << 20), "a flood of text");
  return diagnostics;
}

}  // namespace isoshade
