// SPDX-License-Identifier: Apache-2.0
// Plain Vulkan 1.3, as any program has it: a device, memory, images, descriptors, pipelines, drawing off
// screen. Nothing here knows of isoshade.
#pragma once

#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

inline void check(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("Vulkan returned " + std::to_string(result));
}

/// What adds commands to a list.
using Commands = std::function<void(VkCommandBuffer)>;

struct Buffer {
  VkBuffer buffer;
  std::byte* data;
};
struct Image {
  VkImage image;
  VkImageView view;
};

struct PipelineOptions {
  std::string vertex_code, fragment_code;  ///< SPIR-V
  std::vector<VkVertexInputBindingDescription> buffers;
  std::vector<VkVertexInputAttributeDescription> attributes;
  VkCullModeFlags cull;
  VkCompareOp depth;
  VkPipelineLayout layout;
};

class Device {
 public:
  Device() {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    check(vkCreateInstance(&info, nullptr, &instance_));
    uint32_t count = 1;  // the first
    vkEnumeratePhysicalDevices(instance_, &count, &physical_);
    if (count == 0) throw std::runtime_error("there is no Vulkan device");
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    std::vector<VkQueueFamilyProperties> families(16);
    count = static_cast<uint32_t>(families.size());
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    uint32_t family = 0;
    while ((families.at(family).queueFlags & VK_QUEUE_GRAPHICS_BIT) == 0) ++family;

    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
    const VkPhysicalDeviceVulkan13Features features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                    .dynamicRendering = VK_TRUE};
    const VkDeviceCreateInfo device{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &features,
                                    .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
    check(vkCreateDevice(physical_, &device, nullptr, &device_));
    vkGetDeviceQueue(device_, family, 0, &queue_);
    pool_ = make(vkCreateCommandPool, vkDestroyCommandPool,
                 VkCommandPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, .queueFamilyIndex = family});
  }
  ~Device() {
    for (auto deletion = deletions_.rbegin(); deletion != deletions_.rend(); ++deletion) (*deletion)();
    if (device_ != nullptr) vkDestroyDevice(device_, nullptr);
    vkDestroyInstance(instance_, nullptr);
  }
  Device(const Device&) = delete;

  /// Creates an object, which lives as long as the device.
  template <class Handle, class Info>
  Handle make(VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
              void (*destroy)(VkDevice, Handle, const VkAllocationCallbacks*), const Info& info) {
    Handle made;
    check(create(device_, &info, nullptr, &made));
    deletions_.push_back([this, destroy, made] { destroy(device_, made, nullptr); });
    return made;
  }

  Buffer buffer(size_t size, VkBufferUsageFlags usage) {
    Buffer made{make(vkCreateBuffer, vkDestroyBuffer,
                     VkBufferCreateInfo{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage}), {}};
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, made.buffer, &needs);
    const VkDeviceMemory memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vkBindBufferMemory(device_, made.buffer, memory, 0));
    check(vkMapMemory(device_, memory, 0, size, 0, reinterpret_cast<void**>(&made.data)));
    return made;
  }
  template <class T>
  Buffer buffer(const std::vector<T>& contents, VkBufferUsageFlags usage) {
    const Buffer made = buffer(contents.size() * sizeof(T), usage);
    std::memcpy(made.data, contents.data(), contents.size() * sizeof(T));
    return made;
  }

  Image image(VkFormat format, VkExtent3D size, uint32_t levels, VkImageUsageFlags usage,
              VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT) {
    Image made{};
    made.image = make(vkCreateImage, vkDestroyImage,
                      VkImageCreateInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
                                        .format = format, .extent = size, .mipLevels = levels, .arrayLayers = 1,
                                        .samples = VK_SAMPLE_COUNT_1_BIT, .usage = usage});
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_, made.image, &needs);
    check(vkBindImageMemory(device_, made.image, allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), 0));
    made.view = make(vkCreateImageView, vkDestroyImageView,
                     VkImageViewCreateInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = made.image,
                                           .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = format,
                                           .subresourceRange = {aspect, 0, levels, 0, 1}});
    return made;
  }

  /// Runs commands and waits for them.
  void run(const Commands& record) {
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool_,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY, .commandBufferCount = 1};
    VkCommandBuffer commands;
    check(vkAllocateCommandBuffers(device_, &info, &commands));
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands, &begin));
    record(commands);
    check(vkEndCommandBuffer(commands));
    const VkSubmitInfo submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    check(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE));
    check(vkQueueWaitIdle(queue_));
    vkFreeCommandBuffers(device_, pool_, 1, &commands);
  }

  /// A set of descriptors with room for the bindings of its layout.
  VkDescriptorSet descriptor_set(VkDescriptorSetLayout layout, const std::vector<VkDescriptorSetLayoutBinding>& bindings) {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const VkDescriptorSetLayoutBinding& binding : bindings) sizes.push_back({binding.descriptorType, 1});
    const VkDescriptorPool pool =
        make(vkCreateDescriptorPool, vkDestroyDescriptorPool,
             VkDescriptorPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1,
                                        .poolSizeCount = static_cast<uint32_t>(sizes.size()), .pPoolSizes = sizes.data()});
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, .descriptorPool = pool,
                                           .descriptorSetCount = 1, .pSetLayouts = &layout};
    VkDescriptorSet set;
    check(vkAllocateDescriptorSets(device_, &info, &set));
    return set;
  }
  /// One of the two is null.
  void write(VkDescriptorSet set, uint32_t binding, const VkDescriptorBufferInfo* buffer, const VkDescriptorImageInfo* image) {
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = set, .dstBinding = binding,
                                     .descriptorCount = 1,
                                     .descriptorType = buffer != nullptr ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                                         : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                     .pImageInfo = image, .pBufferInfo = buffer};
    vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
  }

  /// A texture of texels of 4 bytes, if wanted with all mip levels.
  Image texture(VkFormat format, VkExtent3D size, const std::vector<std::byte>& texels, bool with_mips) {
    uint32_t levels = 1;
    if (with_mips)
      while ((std::max(size.width, size.height) >> levels) != 0) ++levels;
    const Image made = image(format, size, levels, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                       VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    const Buffer staged = buffer(texels, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    run([&](VkCommandBuffer commands) {
      const auto change = [&](uint32_t level, uint32_t count, VkImageLayout from, VkImageLayout to) {
        change_layout(commands, made, {VK_IMAGE_ASPECT_COLOR_BIT, level, count, 0, 1}, from, to);
      };
      constexpr VkImageLayout written = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, read = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
      change(0, levels, VK_IMAGE_LAYOUT_UNDEFINED, written);
      const VkBufferImageCopy all{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = size};
      vkCmdCopyBufferToImage(commands, staged.buffer, made.image, written, 1, &all);
      const auto corner = [&](uint32_t level) {
        return VkOffset3D{std::max(static_cast<int32_t>(size.width >> level), 1),
                          std::max(static_cast<int32_t>(size.height >> level), 1), 1};
      };
      for (uint32_t level = 1; level < levels; ++level) {
        change(level - 1, 1, written, read);
        const VkImageBlit half{{VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1}, {{}, corner(level - 1)},
                               {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1}, {{}, corner(level)}};
        vkCmdBlitImage(commands, made.image, read, made.image, written, 1, &half, VK_FILTER_LINEAR);
      }
      if (levels > 1) change(0, levels - 1, read, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
      change(levels - 1, 1, written, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    });
    return made;
  }

  /// A pipeline for draw(). Its clip space is y up, and gl_FragCoord y down.
  VkPipeline pipeline(const PipelineOptions& options) {
    const VkPipelineShaderStageCreateInfo stages[] = {stage(VK_SHADER_STAGE_VERTEX_BIT, options.vertex_code),
                                                      stage(VK_SHADER_STAGE_FRAGMENT_BIT, options.fragment_code)};
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = static_cast<uint32_t>(options.buffers.size()),
        .pVertexBindingDescriptions = options.buffers.data(),
        .vertexAttributeDescriptionCount = static_cast<uint32_t>(options.attributes.size()),
        .pVertexAttributeDescriptions = options.attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
                                                          .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewports{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                                      .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .cullMode = options.cull,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples{.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                       .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth{.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                      .depthTestEnable = VK_TRUE, .depthWriteEnable = VK_TRUE,
                                                      .depthCompareOp = options.depth};
    const VkPipelineColorBlendAttachmentState all{.colorWriteMask = 0xf};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = 1, .pAttachments = &all};
    const VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo set_later{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                     .dynamicStateCount = 2, .pDynamicStates = dynamic};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = 1, .pColorAttachmentFormats = &color_format,
                                                  .depthAttachmentFormat = depth_format};
    const VkGraphicsPipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, .pNext = &rendering, .stageCount = 2, .pStages = stages,
        .pVertexInputState = &input, .pInputAssemblyState = &assembly, .pViewportState = &viewports,
        .pRasterizationState = &rasterization, .pMultisampleState = &samples, .pDepthStencilState = &depth,
        .pColorBlendState = &blend, .pDynamicState = &set_later, .layout = options.layout};
    VkPipeline made;
    check(vkCreateGraphicsPipelines(device_, VK_NULL_HANDLE, 1, &info, nullptr, &made));
    deletions_.push_back([this, made] { vkDestroyPipeline(device_, made, nullptr); });
    return made;
  }

  /// Draws a picture; returns red, green, blue and alpha of its pixels, sRGB, from the upper left.
  std::vector<uint8_t> draw(const std::vector<Commands>& draws, uint32_t width, uint32_t height,
                            const std::array<float, 4>& background) {
    const VkExtent3D size{width, height, 1};
    const Image color = image(color_format, size, 1, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    const Image depth = image(depth_format, size, 1, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
    const Buffer read = buffer(size_t{4} * width * height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    run([&](VkCommandBuffer commands) {
      const VkImageSubresourceRange of_color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
      change_layout(commands, color, of_color, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
      change_layout(commands, depth, {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1}, VK_IMAGE_LAYOUT_UNDEFINED,
                    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
      VkRenderingAttachmentInfo color_target{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = color.view,
                                             .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
      std::copy(background.begin(), background.end(), color_target.clearValue.color.float32);
      const VkRenderingAttachmentInfo depth_target{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                                   .imageView = depth.view,
                                                   .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                                   .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                                   .clearValue = {.depthStencil = {1, 0}}};
      const VkRect2D area{{}, {width, height}};
      const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO, .renderArea = area, .layerCount = 1,
                                      .colorAttachmentCount = 1, .pColorAttachments = &color_target,
                                      .pDepthAttachment = &depth_target};
      vkCmdBeginRendering(commands, &rendering);
      const auto w = static_cast<float>(width), h = static_cast<float>(height);
      const VkViewport viewport{0, h, w, -h, 0, 1};
      vkCmdSetViewport(commands, 0, 1, &viewport);
      vkCmdSetScissor(commands, 0, 1, &area);
      for (const Commands& draw : draws) draw(commands);
      vkCmdEndRendering(commands);
      change_layout(commands, color, of_color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
      const VkBufferImageCopy all{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = size};
      vkCmdCopyImageToBuffer(commands, color.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, read.buffer, 1, &all);
    });
    std::vector<uint8_t> pixels(size_t{4} * width * height);
    std::memcpy(pixels.data(), read.data, pixels.size());
    return pixels;
  }

 private:
  static constexpr VkFormat color_format = VK_FORMAT_R8G8B8A8_SRGB, depth_format = VK_FORMAT_D32_SFLOAT;

  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) {
    uint32_t type = 0;
    while ((needs.memoryTypeBits >> type & 1) == 0 || (memory_.memoryTypes[type].propertyFlags & wanted) != wanted)
      if (++type == memory_.memoryTypeCount) throw std::runtime_error("there is no memory of the kind needed");
    return make(vkAllocateMemory, vkFreeMemory,
                VkMemoryAllocateInfo{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
                                     .memoryTypeIndex = type});
  }

  VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits which, const std::string& code) {
    std::vector<uint32_t> words(code.size() / sizeof(uint32_t));
    std::memcpy(words.data(), code.data(), words.size() * sizeof(uint32_t));
    const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = words.size() * sizeof(uint32_t), .pCode = words.data()};
    return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = which,
            .module = make(vkCreateShaderModule, vkDestroyShaderModule, info), .pName = "main"};
  }

  static void change_layout(VkCommandBuffer commands, const Image& image, VkImageSubresourceRange range, VkImageLayout from,
                            VkImageLayout to) {
    const VkImageMemoryBarrier barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                       .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                       .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                       .oldLayout = from, .newLayout = to, .image = image.image, .subresourceRange = range};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0,
                         nullptr, 1, &barrier);
  }

  VkInstance instance_{};
  VkPhysicalDevice physical_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  VkDevice device_{};
  VkQueue queue_{};
  VkCommandPool pool_{};
  std::vector<std::function<void()>> deletions_;
};
