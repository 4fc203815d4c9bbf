// SPDX-License-Identifier: Apache-2.0
// Shipped scenes on any backend, for tests that compare every bit.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "backends/resolve.h"
#include "compiler/check/library.h"
#include "runtime/compare/compare.h"
#include "runtime/render/render.h"
#include "runtime/scene/load.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::equivalence {

/// Paths of all shipped scenes, sorted.
inline std::vector<std::string> shipped_scenes() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(ISOSHADE_GRAPHS "/scenes"))
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

inline std::string scene_path(const std::string& name) { return ISOSHADE_GRAPHS "/scenes/" + name + ".json"; }

inline scene::Scene load(const support::Source& source) {
  support::Diagnostics diagnostics;
  auto scene = scene::load_scene(source, {}, check::Library(ISOSHADE_GRAPHS "/library").files(), diagnostics);
  if (!scene) ADD_FAILURE() << diagnostics.text();
  return scene.value_or(scene::Scene());
}

inline scene::Scene load(const std::string& path) {
  support::Diagnostics diagnostics;
  return load(graph::read_source(path, diagnostics));
}

inline render::Plan plan(const scene::Scene& scene, int width = 0, int height = 0, bool skip = true,
                         functions::Tier tier = functions::Tier::standard) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  render::PlanOptions options;
  options.width = width;
  options.height = height;
  if (!skip) options.compiler.skips = interface::Skips::none();
  options.compiler.library = &library;
  options.compiler.tier = tier;
  auto made = render::plan_frame(scene, options, diagnostics);
  if (!made) ADD_FAILURE() << diagnostics.text();
  return made ? std::move(*made) : render::Plan();
}

inline render::Plan plan(const std::string& path, int width = 0, int height = 0, bool skip = true,
                         functions::Tier tier = functions::Tier::standard) {
  return plan(load(path), width, height, skip, tier);
}

inline backends::Image draw(const render::Plan& plan, backends::Backend& backend) {
  support::Diagnostics diagnostics;
  backends::Image image;
  render::DrawStats stats;
  if (!render::render(plan, backend, image, stats, diagnostics)) ADD_FAILURE() << diagnostics.text();
  return image;
}

/// The image whose pixels have the pixels of this one as samples.
inline backends::Image resolved_to(backends::Image image, int width) {
  const lanes::FpGuard guard;
  const int side = image.width / width;
  backends::resolve(image.rgba.data(), image.depth.data(), image.width, image.height, side);
  image.resize(width, image.height / side);
  return image;
}

inline std::unique_ptr<backends::Backend> cpu_backend(const std::string& lanes = "", int threads = 0,
                                                      const std::string& compiler = "") {
  support::Diagnostics diagnostics;
  cpu::CpuOptions options;
  options.lanes = lanes;
  options.threads = threads;
  options.compiler = compiler;
  auto backend = cpu::create(options, diagnostics);
  if (backend == nullptr) ADD_FAILURE() << diagnostics.text();
  return backend;
}

#ifdef ISOSHADE_VULKAN
/// `as_gpu`: with memory of its own and compute shaders, as devices are used that are not software.
inline std::unique_ptr<backends::Backend> vulkan_backend(
    std::optional<driver::Division> division = std::nullopt, bool as_gpu = false) {
  support::Diagnostics diagnostics;
  vulkan::VulkanOptions options;
  options.division = division;
  options.own_memory = as_gpu;
  options.compute = as_gpu;
  auto backend = vulkan::create(options, diagnostics);
  if (backend == nullptr) ADD_FAILURE() << diagnostics.text();
  return backend;
}
#endif

/// With Vulkan in both of its ways.
inline std::vector<std::unique_ptr<backends::Backend>> every_backend() {
  std::vector<std::unique_ptr<backends::Backend>> all;
  all.push_back(interpreter::create());
  all.push_back(cpu_backend());
#ifdef ISOSHADE_VULKAN
  all.push_back(vulkan_backend());
  all.push_back(vulkan_backend(std::nullopt, true));
#endif
  return all;
}

inline void expect_identical(const backends::Image& a, const backends::Image& b, const std::string& what) {
  const compare::Comparison comparison = compare::compare(a, b);
  EXPECT_TRUE(comparison.identical()) << what << ": " << compare::describe(comparison, "first", "second");
}

}  // namespace isoshade::equivalence
