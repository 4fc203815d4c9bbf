// SPDX-License-Identifier: Apache-2.0
// Branches around what no pixel needs, and arithmetic that ranges decide: programs have fewer operations to do, and the
// same bits on every backend.
#include "compiler/driver/driver.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

using interface::Skip;

size_t branches_of(const driver::Program& program) {
  size_t count = 0;
  for (const ir::Function& function : program.module.functions)
    for (const ir::Block& block : function.blocks)
      count += static_cast<size_t>(std::ranges::count_if(block.instructions, [&](const ir::InstructionId id) {
        return function.instructions[id].op == ir::Opcode::branch;
      }));
  return count;
}

/// The branches in the last pass of an effect.
size_t branches(const std::string& effect, const interface::Skips& skips) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  options.skips = skips;
  const std::string path = std::string(ISOSHADE_GRAPHS "/") + effect + ".json";
  const auto made = driver::compile_effect(graph::read_source(path, diagnostics), options, diagnostics);
  if (!made) ADD_FAILURE() << diagnostics.text();
  return made ? branches_of(made->passes.back().pixel) : 0;
}

interface::Skips without(Skip skip) {
  interface::Skips skips;
  skips.set(skip, false);
  return skips;
}

TEST(Branches, StandAroundExpensiveSidesOnly) {
  for (const char* effect : {"materials/cook_torrance", "materials/gltf_pbr", "effects/cartoon", "effects/sketch"})
    EXPECT_GT(branches(effect, {}), branches(effect, without(Skip::branches))) << effect;
  // Its choices are between values that are there, or cheap.
  EXPECT_EQ(branches("effects/flat", {}), branches("effects/flat", without(Skip::branches)));
}

render::Plan plan_with(const interface::Skips& skips, const scene::Scene& scene) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  render::PlanOptions options;
  options.width = 160;
  options.height = 90;
  options.compiler.library = &library;
  options.compiler.skips = skips;
  auto made = render::plan_frame(scene, options, diagnostics);
  if (!made) ADD_FAILURE() << diagnostics.text();
  return made ? std::move(*made) : render::Plan();
}

TEST(Branches, ChangeNoBitOnAnyBackend) {
  const std::vector<std::unique_ptr<backends::Backend>> all = every_backend();
  for (const char* name : {"material_balls", "gltf_textures", "cartoon_tub", "sketch", "environment_balls"}) {
    const scene::Scene scene = load(scene_path(name));
    const render::Plan with = plan_with({}, scene);
    const backends::Image expected = draw(plan_with(interface::Skips::none(), scene), *all[0]);
    for (const Skip skip : {Skip::branches, Skip::ranges}) {
      const render::Plan whole = plan_with(without(skip), scene);
      for (const auto& backend : all) {
        expect_identical(expected, draw(with, *backend), name + (" with all skips, " + backend->description()));
        expect_identical(expected, draw(whole, *backend),
                         name + (" without " + std::string(interface::name(skip)) + ", " + backend->description()));
      }
    }
  }
}

}  // namespace
}  // namespace isoshade::equivalence
