// SPDX-License-Identifier: Apache-2.0
// What the backend keeps between runs (backends/cache.h): shaders, the result of the probe, pipelines of the driver. An
// entry that is damaged or cannot be kept is no error: what it holds is made again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backends/cache.h"
#include "backends/vulkan/probe.h"
#include "compiler/support/diagnostics.h"
#include "compiler/targets/glsl/spirv.h"

namespace isoshade::vulkan {

/// In the functions, `device` is Device::identity().
class DiskCache {
 public:
  /// `folder`: empty for the user's. Keeps nothing if the folder is unsafe or cannot be written.
  explicit DiskCache(const std::string& folder);

  /// glsl::compile_spirv(), unless the cache has what it made of this text. glslang starts only for texts that the cache
  /// lacks.
  std::optional<std::vector<uint32_t>> spirv(const std::string& glsl, glsl::ShaderKind kind,
                                             support::Diagnostics& diagnostics, const std::string& what) const;

  /// The result of this probe on this device, with Probe::cached.
  std::optional<Probe> probe(std::string_view device) const;
  /// Keeps the result if the device passed. Other devices are probed at each start, so that a repair is noticed.
  void keep(const Probe& probe, std::string_view device) const;

  /// The contents of a VkPipelineCache; empty if there are none.
  std::string pipelines(std::string_view device) const;
  /// Keeps at most max_pipeline_bytes.
  void keep_pipelines(std::string_view bytes, std::string_view device) const;
  static constexpr size_t max_pipeline_bytes = size_t{32} << 20;

 private:
  std::optional<backends::Cache> cache_;
};

}  // namespace isoshade::vulkan
