// SPDX-License-Identifier: Apache-2.0
// The Vulkan loader, one instance, and its devices. Internal: reads Vulkan-Hpp.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "backends/vulkan/device_info.h"
#include "backends/vulkan/vulkan_hpp.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

/// What the validation layers said since it was last asked. Drivers may call from any thread.
class Messages {
 public:
  void add(std::string text);
  std::vector<std::string> take();

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// Vulkan 1.1. With ISOSHADE_VALIDATION=1 in the environment the Khronos validation layer is loaded where it
/// is installed. Throws std::exception where there is no loader or no driver.
struct Instance {
  Instance();

  std::unique_ptr<Messages> messages = std::make_unique<Messages>();
  vk::raii::Context context;
  bool validates = false;
  vk::raii::Instance instance{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
  std::vector<vk::raii::PhysicalDevice> devices;
};

bool has_extension(const vk::raii::PhysicalDevice& device, std::string_view name);

DeviceInfo describe(const vk::raii::PhysicalDevice& device, int index);

/// The index of the device that `selector` means, see VulkanOptions::device; -1 if none, with a diagnostic that lists
/// what there is.
int choose(const Instance& instance, std::string_view selector, support::Diagnostics& diagnostics);

/// What the device lacks for the shaders of this project, one sentence each; empty if it will do.
std::vector<std::string> shortcomings(const vk::raii::PhysicalDevice& device);

/// The index of a queue family that draws, or -1.
int graphics_family(const vk::raii::PhysicalDevice& device);

}  // namespace isoshade::vulkan
