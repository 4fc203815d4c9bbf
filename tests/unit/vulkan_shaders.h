// SPDX-License-Identifier: Apache-2.0
// A Vulkan backend that runs GLSL written by hand, under the validation layers.
#pragma once

#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>

#include "backends/vulkan/backend.h"
#include "compiler/targets/glsl/glsl.h"

namespace isoshade::vulkan {

/// What generated shaders declare; see targets/glsl/stages.h.
inline std::string interface_glsl() {
  return glsl::head() + R"(
layout(std430, set = 0, binding = 0) readonly buffer vertices_block { float vertices[]; };
layout(std430, set = 0, binding = 1) readonly buffer triangles_block { int triangles[]; };
layout(std430, set = 0, binding = 2) readonly buffer objects_block { float objects[]; };
layout(std430, set = 0, binding = 3) readonly buffer lights_block { float lights[]; };
layout(std430, set = 0, binding = 4) readonly buffer frame_block { float frame[]; };
layout(std430, set = 0, binding = 5) readonly buffer view_block { float view[]; };
layout(std430, set = 0, binding = 6) readonly buffer inputs_block { int inputs[]; };
layout(push_constant) uniform Push {
  int object; int light_count; int program; int first; int count; int width;
  int origin_x; int origin_y; int projected;
} push;
)";
}

/// A program whose text is what `texts` holds under its name.
inline driver::Program named(std::string name, driver::Stage stage) {
  driver::Program program;
  program.name = std::move(name);
  program.stage = stage;
  return program;
}

using Texts = std::map<std::string, std::string>;

struct HandWritten {
  Texts texts;  ///< by name; the depth stage's is under "depth"
  support::Diagnostics diagnostics;
  std::unique_ptr<VulkanBackend> backend;

  explicit HandWritten(Texts by_name, EvalStage stage = EvalStage::fragment, bool own_memory = false)
      : texts(std::move(by_name)) {
    setenv("ISOSHADE_VALIDATION", "1", 1);
    VulkanOptions options;
    options.eval_stage = stage;
    options.own_memory = own_memory;
    options.glsl = [this](const driver::Program& program, driver::Division) {
      return texts.at(program.stage == driver::Stage::depth ? "depth" : program.name);
    };
    backend = create(options, diagnostics);
    EXPECT_NE(backend, nullptr) << diagnostics.text();
  }
};

}  // namespace isoshade::vulkan
