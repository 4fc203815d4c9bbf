// SPDX-License-Identifier: Apache-2.0
// The Vulkan loader, one instance, and its devices. Internal: includes Vulkan-Hpp.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

// Vulkan-Hpp without the parts that only cost compile time. It takes seconds to compile: include this header in as few
// files as possible.
#define VULKAN_HPP_NO_STRUCT_CONSTRUCTORS  // structs are aggregates: .member = value
#define VULKAN_HPP_NO_STRUCT_SETTERS
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#define VULKAN_HPP_NO_SMART_HANDLE
#include <vulkan/vulkan_raii.hpp>

#include "backends/vulkan/backend.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

/// Collects messages of the validation layers. Drivers may call from any thread.
class Messages {
 public:
  void add(std::string text);
  std::vector<std::string> take();

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// Vulkan 1.1. ISOSHADE_VALIDATION=1 in the environment loads the Khronos validation layer if it is installed. Throws
/// std::exception if there is no loader or no driver.
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

/// What decides how the device computes, as far as it can be asked: the device, its driver, versions of both, of the loader
/// and of the API, and, because software devices compile for it, the processor; and the variables of the environment that
/// drivers and the loader read. For the keys of caches.
std::string identity(const Instance& instance, const vk::raii::PhysicalDevice& device, const DeviceInfo& info);

/// The index of the device that `selector` selects, see VulkanOptions::device; -1 if there is none, with a diagnostic
/// that lists the devices.
int choose(const Instance& instance, std::string_view selector, support::Diagnostics& diagnostics);

/// The features that the device lacks for the shaders of this project, one sentence each; empty if it has them all.
std::vector<std::string> shortcomings(const vk::raii::PhysicalDevice& device);

/// The index of a queue family that draws and computes, or -1.
int graphics_family(const vk::raii::PhysicalDevice& device);

}  // namespace isoshade::vulkan
