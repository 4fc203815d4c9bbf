// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/forward_device.h"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "compiler/lower/frame_layout.h"

namespace isoshade::vulkan::forward {

using namespace lower;

namespace {

/// A texture's format. Bytes are decoded by the device.
vk::Format format_of(const int32_t* record) {
  const int table = record[texture_word::table];
  return table < 0 ? color_format : table == byte_table::srgb ? vk::Format::eR8G8B8A8Srgb : vk::Format::eR8G8B8A8Unorm;
}

/// The texels of one level in that format.
std::span<const std::byte> texels_of(const backends::Frame& frame, const int32_t* record, size_t texels) {
  const auto first = static_cast<size_t>(record[texture_word::first]);
  return record[texture_word::table] < 0 ? std::as_bytes(std::span(frame.texels).subspan(first, 4 * texels))
                                         : std::as_bytes(std::span(frame.texel_bytes).subspan(first, texels));
}

}  // namespace

Device::Device(const vk::raii::PhysicalDevice& physical) : physical_(physical) {
  const auto family = static_cast<uint32_t>(graphics_family(physical));
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue{.queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
  device_ = vk::raii::Device(physical, {.queueCreateInfoCount = 1, .pQueueCreateInfos = &queue});
  queue_ = device_.getQueue(family, 0);
  pool_ = vk::raii::CommandPool(device_, {.queueFamilyIndex = family});
}

size_t Device::uniform_alignment() const { return physical_.getProperties().limits.minUniformBufferOffsetAlignment; }

Memory Device::memory(size_t bytes, vk::BufferUsageFlags usage) {
  Memory made;
  bytes = std::max<size_t>(bytes, 4);
  made.buffer = vk::raii::Buffer(device_, {.size = bytes, .usage = usage});
  made.memory = allocate(made.buffer.getMemoryRequirements(),
                         vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent);
  made.buffer.bindMemory(*made.memory, 0);
  made.data = static_cast<std::byte*>(made.memory.mapMemory(0, bytes));
  return made;
}

Target Device::target(vk::Format format, vk::ImageUsageFlags usage, vk::Extent3D extent, uint32_t levels) {
  const auto aspect = format == depth_format ? vk::ImageAspectFlagBits::eDepth : vk::ImageAspectFlagBits::eColor;
  Target made;
  made.image = vk::raii::Image(device_, {.imageType = vk::ImageType::e2D,
                                         .format = format,
                                         .extent = extent,
                                         .mipLevels = levels,
                                         .arrayLayers = 1,
                                         .usage = usage});
  made.memory = allocate(made.image.getMemoryRequirements(), {});
  made.image.bindMemory(*made.memory, 0);
  made.view = vk::raii::ImageView(device_, {.image = *made.image,
                                            .viewType = vk::ImageViewType::e2D,
                                            .format = format,
                                            .subresourceRange = {aspect, 0, levels, 0, 1}});
  return made;
}

Target Device::texture(const backends::Frame& frame, int number) {
  constexpr std::array<int32_t, texture_word::stride> none{};  // one texel, linear bytes
  const auto record = [&](uint32_t level) {
    return number < 0 ? none.data() : &frame.textures[(static_cast<size_t>(number) + level) * texture_word::stride];
  };
  const auto extent = [&](uint32_t level, int word) { return static_cast<uint32_t>(std::max(record(level)[word], 1)); };
  const auto levels = static_cast<uint32_t>(record(0)[texture_word::smaller] + 1);
  Target made = target(format_of(record(0)), vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                       {extent(0, texture_word::width), extent(0, texture_word::height), 1}, levels);
  const vk::raii::CommandBuffer commands = begin();
  change(commands, made, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
  std::vector<Memory> staged;
  for (uint32_t level = 0; level < levels; ++level) {
    const uint32_t width = extent(level, texture_word::width), height = extent(level, texture_word::height);
    constexpr std::array<std::byte, 4> black{};
    const std::span<const std::byte> texels =
        number < 0 ? std::span<const std::byte>(black) : texels_of(frame, record(level), size_t{width} * height);
    staged.push_back(memory(texels.size(), vk::BufferUsageFlagBits::eTransferSrc));
    std::ranges::copy(texels, staged.back().data);
    commands.copyBufferToImage(*staged.back().buffer, *made.image, vk::ImageLayout::eTransferDstOptimal,
                               vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, level, 0, 1},
                                                   .imageExtent = {width, height, 1}});
  }
  change(commands, made, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
  submit(commands);
  return made;
}

vk::raii::CommandBuffer Device::begin() {
  vk::raii::CommandBuffers made(device_, {.commandPool = *pool_, .commandBufferCount = 1});
  made[0].begin({});
  return std::move(made[0]);
}

void Device::submit(const vk::raii::CommandBuffer& commands) {
  commands.end();
  const vk::CommandBuffer handle = *commands;
  queue_.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle});
  device_.waitIdle();
}

vk::raii::DeviceMemory Device::allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags wanted) {
  const vk::PhysicalDeviceMemoryProperties types = physical_.getMemoryProperties();
  // The device's own memory where the host sees that, too.
  for (const vk::MemoryPropertyFlags flags : {wanted | vk::MemoryPropertyFlagBits::eDeviceLocal, wanted})
    for (uint32_t i = 0; i < types.memoryTypeCount; ++i)
      if ((needs.memoryTypeBits >> i & 1) != 0 && (types.memoryTypes[i].propertyFlags & flags) == flags)
        return {device_, {.allocationSize = needs.size, .memoryTypeIndex = i}};
  throw std::runtime_error("there is no memory that the host can write");
}

void change(const vk::raii::CommandBuffer& commands, const Target& target, vk::ImageLayout from, vk::ImageLayout to) {
  commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eAllCommands, {}, {}, {},
                           vk::ImageMemoryBarrier{.srcAccessMask = vk::AccessFlagBits::eMemoryWrite,
                                                  .dstAccessMask = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite,
                                                  .oldLayout = from,
                                                  .newLayout = to,
                                                  .image = *target.image,
                                                  .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0,
                                                                       VK_REMAINING_MIP_LEVELS, 0, 1}});
}

}  // namespace isoshade::vulkan::forward
