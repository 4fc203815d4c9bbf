// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/instance.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <sys/auxv.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include "backends/vulkan/limits.h"
#include "compiler/support/visible.h"

namespace isoshade::vulkan {

namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  static_cast<Messages*>(messages)->add(data->pMessage);
  return VK_FALSE;
}

bool validation_wanted() {
  const char* value = std::getenv("ISOSHADE_VALIDATION");
  return value != nullptr && std::string_view(value) == "1";
}

bool has_layer(const vk::raii::Context& context, std::string_view name) {
  const auto layers = context.enumerateInstanceLayerProperties();
  return std::any_of(layers.begin(), layers.end(),
                     [&](const vk::LayerProperties& layer) { return name == layer.layerName.data(); });
}

std::string version_text(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) +
         "." + std::to_string(VK_API_VERSION_PATCH(version));
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Family, model, stepping and features.
std::string processor() {
  std::string text;
  const auto add = [&](unsigned long value) { text += std::to_string(value) + " "; };
#if defined(__x86_64__)
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(0, &a, &b, &c, &d))
    for (const unsigned part : {b, c, d}) add(part);  // the vendor
  if (__get_cpuid(1, &a, &b, &c, &d))
    for (const unsigned part : {a, c, d}) add(part);  // b has the number of the core
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d))
    for (const unsigned part : {b, c, d}) add(part);
#endif
  add(getauxval(AT_HWCAP));
  add(getauxval(AT_HWCAP2));
  return text;
}

/// Variables that the loader, Mesa and NVIDIA's driver read, in the order of the environment.
std::string driver_variables() {
  constexpr std::string_view prefixes[] = {"VK_", "MESA_", "GALLIVM_", "LP_", "LVP_", "NIR_", "RADV_", "ANV_",
                                           "INTEL_", "AMD_", "NVK_", "__GL_", "__VK_", "NODEVICE_SELECT"};
  std::string text;
  for (char** variable = environ; *variable != nullptr; ++variable)
    if (std::ranges::any_of(prefixes, [&](std::string_view p) { return std::string_view(*variable).starts_with(p); }))
      text += std::string(*variable) + "\n";
  return text;
}

bool is_number(std::string_view text) {
  return !text.empty() && text.size() <= 4 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

void Messages::add(std::string text) {
  const std::lock_guard lock(mutex_);
  texts_.push_back(std::move(text));
}

std::vector<std::string> Messages::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(texts_, {});
}

Instance::Instance() {
  validates = validation_wanted() && has_layer(context, validation_layer);
  const vk::ApplicationInfo application{.pApplicationName = "isoshade", .apiVersion = VK_API_VERSION_1_1};
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  const vk::DebugUtilsMessengerCreateInfoEXT listener{
      .messageSeverity = Severity::eError | Severity::eWarning,
      .messageType = vk::DebugUtilsMessageTypeFlagBitsEXT::eValidation,
      .pfnUserCallback = on_message,
      .pUserData = messages.get()};
  const char* debug_utils = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const uint32_t extras = validates ? 1 : 0;
  instance = vk::raii::Instance(context, vk::InstanceCreateInfo{.pNext = validates ? &listener : nullptr,
                                                                .pApplicationInfo = &application,
                                                                .enabledLayerCount = extras,
                                                                .ppEnabledLayerNames = &validation_layer,
                                                                .enabledExtensionCount = extras,
                                                                .ppEnabledExtensionNames = &debug_utils});
  if (validates) messenger = vk::raii::DebugUtilsMessengerEXT(instance, listener);
  devices = instance.enumeratePhysicalDevices();
}

bool has_extension(const vk::raii::PhysicalDevice& device, std::string_view name) {
  const auto extensions = device.enumerateDeviceExtensionProperties();
  return std::any_of(extensions.begin(), extensions.end(), [&](const vk::ExtensionProperties& extension) {
    return name == extension.extensionName.data();
  });
}

DeviceInfo describe(const vk::raii::PhysicalDevice& device, int index) {
  const vk::PhysicalDeviceProperties properties = device.getProperties();
  DeviceInfo info;
  info.index = index;
  info.name = properties.deviceName.data();
  info.api = version_text(properties.apiVersion);
  info.cpu = properties.deviceType == vk::PhysicalDeviceType::eCpu;
  info.driver = "driver " + version_text(properties.driverVersion);
  if (properties.apiVersion >= VK_API_VERSION_1_1 &&
      has_extension(device, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME)) {
    const auto chain =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
    info.driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
  }
  return info;
}

std::string identity(const Instance& instance, const vk::raii::PhysicalDevice& device, const DeviceInfo& info) {
  const auto chain = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceIDProperties>();
  const vk::PhysicalDeviceProperties& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& ids = chain.get<vk::PhysicalDeviceIDProperties>();
  std::string text = info.name + "\n" + info.driver + "\n";
  const auto add_bytes = [&](const auto& bytes) {
    for (const uint8_t byte : bytes) text += std::to_string(byte) + " ";
    text += "\n";
  };
  for (const uint32_t part : {properties.vendorID, properties.deviceID, properties.apiVersion, properties.driverVersion,
                              instance.context.enumerateInstanceVersion()})
    text += std::to_string(part) + "\n";
  add_bytes(properties.pipelineCacheUUID);
  add_bytes(ids.deviceUUID);
  add_bytes(ids.driverUUID);
  return text + processor() + "\n" + driver_variables();
}

support::Diagnostic& report_unusable(std::string_view why, support::Diagnostics& diagnostics) {
  return diagnostics.report(support::Id::no_device, "Vulkan cannot be used: " + std::string(why))
      .suggest("install the loader and a driver: libvulkan1 and mesa-vulkan-drivers (lavapipe needs no GPU)");
}

std::vector<DeviceInfo> list_devices(support::Diagnostics& diagnostics) {
  std::vector<DeviceInfo> infos;
  try {
    const Instance instance;
    for (const auto& device : instance.devices)
      infos.push_back(describe(device, static_cast<int>(infos.size())));
    if (infos.empty()) report_unusable("there is no device", diagnostics);
  } catch (const std::exception& error) {
    infos.clear();
    report_unusable(error.what(), diagnostics);
  }
  return infos;
}

bool matches(const DeviceInfo& info, std::string_view selector) {
  if (is_number(selector)) return info.index == std::stoi(std::string(selector));
  return lower_case(info.name).find(lower_case(selector)) != std::string::npos;
}

int choose(const Instance& instance, std::string_view selector, support::Diagnostics& diagnostics) {
  std::vector<DeviceInfo> infos;
  for (const auto& device : instance.devices)
    infos.push_back(describe(device, static_cast<int>(infos.size())));

  const auto index_of = [&](auto matches) {
    const auto found = std::find_if(infos.begin(), infos.end(), matches);
    return found == infos.end() ? -1 : found->index;
  };
  int chosen = -1;
  if (selector.empty()) {
    chosen = index_of([](const DeviceInfo& info) { return info.cpu; });
    if (chosen < 0 && !infos.empty()) chosen = 0;
  } else {
    chosen = index_of([&](const DeviceInfo& info) { return matches(info, selector); });
  }
  if (chosen < 0 && infos.empty()) {
    report_unusable("there is no device", diagnostics);
  } else if (chosen < 0) {
    support::Diagnostic& report =
        diagnostics.report(support::Id::no_device, "no Vulkan device matches " + support::quote(selector));
    for (const DeviceInfo& info : infos)
      report.note("device " + std::to_string(info.index) + ": " + info.name);
  }
  return chosen;
}

int graphics_family(const vk::raii::PhysicalDevice& device) {
  constexpr auto needed = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
  const auto families = device.getQueueFamilyProperties();
  for (size_t i = 0; i < families.size(); ++i)
    if ((families[i].queueFlags & needed) == needed) return static_cast<int>(i);
  return -1;
}

std::vector<std::string> shortcomings(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceProperties properties = device.getProperties();
  if (properties.apiVersion < VK_API_VERSION_1_1) return {"it offers Vulkan 1.0 only; 1.1 is needed"};

  std::vector<std::string> lacks;
  const auto need = [&](bool met, const char* lack) {
    if (!met) lacks.emplace_back(lack);
  };
  if (has_extension(device, VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME)) {
    const auto chain =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceFloatControlsProperties>();
    const auto& controls = chain.get<vk::PhysicalDeviceFloatControlsProperties>();
    need(controls.shaderSignedZeroInfNanPreserveFloat32,
         "it cannot promise to preserve -0, infinity and NaN");
  } else {
    lacks.emplace_back("it lacks VK_KHR_shader_float_controls");
  }
  need(device.getFeatures().vertexPipelineStoresAndAtomics, "its vertex shaders cannot store");
  need(graphics_family(device) >= 0, "it has no queue for graphics and compute");

  const vk::PhysicalDeviceLimits& limits = properties.limits;
  need(limits.maxPerStageDescriptorStorageBuffers >= binding_count - image_bindings,
       "it has too few storage buffers a stage");
  need(limits.maxColorAttachments >= max_attachments, "it has fewer than 8 color attachments");
  const float edge = static_cast<float>(guard_band);
  need(limits.maxViewportDimensions[0] >= 2 * guard_band &&
           limits.maxViewportDimensions[1] >= 2 * guard_band && limits.viewportBoundsRange[0] <= -edge &&
           limits.viewportBoundsRange[1] >= edge,
       "its viewports are smaller than the guard band");
  const auto depth = device.getFormatProperties(vk::Format::eD32Sfloat).optimalTilingFeatures;
  need(!!(depth & vk::FormatFeatureFlagBits::eDepthStencilAttachment), "it has no 32-bit float depth");
  return lacks;
}

}  // namespace isoshade::vulkan
