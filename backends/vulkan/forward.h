// SPDX-License-Identifier: Apache-2.0
// An ordinary renderer: draws the picture of a frame with forward pairs, as a program would that knows of a pair only what its
// layout says. The device interpolates, tests the depth and fills, so the picture is outside the contract: to compare with.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/forward.h"
#include "compiler/lower/sampling.h"
#include "compiler/targets/glsl/spirv.h"

namespace isoshade::vulkan {

struct ForwardShader {
  driver::ForwardPair pair;
  /// How the device samples each image of the parameters; empty if the pair reads texel by texel.
  std::vector<lower::Sampling> samplings = {};
};

/// A post and the images that it reads: 0 is what the draws make, 1 + i what post i makes.
struct ForwardPost {
  const ForwardShader* shader = nullptr;
  std::span<const float> record;  ///< of its parameters
  int width = 0, height = 0;      ///< of the image that it makes
  std::vector<int> sources;       ///< the image that it processes, then those that its document lists; -1: none
};

/// What is drawn: the last view of the frame, which has one sample a pixel, then posts.
struct ForwardScene {
  const backends::Frame* frame = nullptr;
  std::vector<const ForwardShader*> shaders;  ///< of the draws of the view
  std::vector<ForwardPost> posts;
  int result = 0;  ///< the image that the scene becomes
};

class ForwardRenderer {
 public:
  /// Compiles the shaders and uploads what they read. `scene` and what it points to must outlive the renderer. Null, with a
  /// diagnostic, if there is no such device (VulkanOptions::device) or a shader does not compile.
  /// `contract`: outside, or free.
  static std::unique_ptr<ForwardRenderer> create(const ForwardScene& scene, const std::string& device,
                                                 glsl::Contract contract, support::Diagnostics& diagnostics);
  ~ForwardRenderer();

  /// Fills the uniform blocks, draws, and waits until the device has done it. False, with a diagnostic, if Vulkan fails.
  bool draw(support::Diagnostics& diagnostics);
  /// The color that was drawn last. The image has no depth.
  bool read(backends::Image& image, support::Diagnostics& diagnostics);

 private:
  class Impl;
  explicit ForwardRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isoshade::vulkan
