// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/hoist.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "compiler/driver/driver.h"
#include "compiler/driver/finish.h"
#include "compiler/graph/files.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/parser.h"
#include "compiler/ir/printer.h"
#include "compiler/ir/validator.h"

namespace isoshade {
namespace {

size_t left_at_draw_rate(const driver::Program& program) {
  const auto rate = driver::draw_rate(program.stage, 0);
  return rate ? passes::operations_at_draw_rate(program.module, program.entry, *rate) : 0;
}

/// Of all programs of a document.
size_t left_in(const std::string& path, interface::Skips skips) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  options.skips = skips;
  const support::Source source = graph::read_source(path, diagnostics);
  size_t left = 0;
  if (const auto kind = driver::kind_of(source, diagnostics); kind == graph::DocumentKind::effect) {
    const auto effect = driver::compile_effect(source, options, diagnostics);
    EXPECT_TRUE(effect) << diagnostics.text();
    for (const driver::EffectPass& pass : effect->passes) {
      left += left_at_draw_rate(pass.vertex) + left_at_draw_rate(pass.pixel);
      left += (pass.blend ? left_at_draw_rate(*pass.blend) : 0) + (pass.cutout ? left_at_draw_rate(*pass.cutout) : 0);
    }
  } else if (kind == graph::DocumentKind::post) {
    const auto post = driver::compile_post(source, options, diagnostics);
    EXPECT_TRUE(post) << diagnostics.text();
    left += left_at_draw_rate(post->program);
  }
  return left;
}

TEST(Hoist, LeavesNoOperationOfShippedEffectsThatIsTheSameForADraw) {
  interface::Skips without;
  without.set(interface::Skip::rates, false);
  size_t documents = 0, moved = 0;
  for (const char* folder : {"/effects", "/materials"}) {
    for (const auto& file : std::filesystem::recursive_directory_iterator(std::string(ISOSHADE_GRAPHS) + folder)) {
      if (file.path().extension() != ".json") continue;
      ++documents;
      EXPECT_EQ(left_in(file.path(), {}), 0u) << file.path();
      moved += left_in(file.path(), without);
    }
  }
  EXPECT_GE(documents, 30u);
  EXPECT_GE(moved, 200u);
}

}  // namespace
}  // namespace isoshade
