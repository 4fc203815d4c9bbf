// SPDX-License-Identifier: Apache-2.0
// The device of the ordinary renderer (forward.h): its memory, images and textures. Internal: includes Vulkan-Hpp.
#pragma once

#include "backends/backend.h"
#include "backends/vulkan/instance.h"

namespace isoshade::vulkan::forward {

/// A buffer that the host writes and reads.
struct Memory {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  std::byte* data = nullptr;
};

struct Target {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Image image{nullptr};
  vk::raii::ImageView view{nullptr};
};

inline constexpr vk::Format color_format = vk::Format::eR32G32B32A32Sfloat, depth_format = vk::Format::eD32Sfloat;

/// What fails throws std::exception.
class Device {
 public:
  explicit Device(const vk::raii::PhysicalDevice& physical);

  const vk::raii::Device& operator*() const { return device_; }
  const vk::raii::Device* operator->() const { return &device_; }
  size_t uniform_alignment() const;

  Memory memory(size_t bytes, vk::BufferUsageFlags usage);
  Target target(vk::Format format, vk::ImageUsageFlags usage, vk::Extent3D extent, uint32_t levels = 1);
  /// A texture of the frame with its mip levels; one black texel for -1.
  Target texture(const backends::Frame& frame, int number);

  vk::raii::CommandBuffer begin();
  void submit(const vk::raii::CommandBuffer& commands);

 private:
  vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags wanted);

  vk::raii::PhysicalDevice physical_;
  vk::raii::Device device_{nullptr};
  vk::raii::Queue queue_{nullptr};
  vk::raii::CommandPool pool_{nullptr};
};

/// Moves an image from one layout to another, between all that was written before and all that follows.
void change(const vk::raii::CommandBuffer& commands, const Target& target, vk::ImageLayout from, vk::ImageLayout to);

}  // namespace isoshade::vulkan::forward
