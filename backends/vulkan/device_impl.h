// SPDX-License-Identifier: Apache-2.0
// The implementation of Device. Internal: includes Vulkan-Hpp.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <unordered_map>

#include "backends/vulkan/device.h"
#include "backends/vulkan/instance.h"
#include "backends/vulkan/limits.h"

namespace isoshade::vulkan {

inline constexpr vk::Format ids_format = vk::Format::eR32Sint;
inline constexpr vk::Format depth_format = vk::Format::eD32Sfloat;
inline constexpr vk::Format color_format = vk::Format::eR32G32B32A32Sfloat;
inline constexpr vk::Format layer_depth_format = vk::Format::eR32Sfloat;
inline constexpr vk::Format words_format = vk::Format::eR32G32B32A32Sint;

/// All of an image that has one level and one layer.
inline vk::ImageSubresourceRange whole(vk::Format format) {
  return {.aspectMask =
              format == depth_format ? vk::ImageAspectFlagBits::eDepth : vk::ImageAspectFlagBits::eColor,
          .levelCount = 1,
          .layerCount = 1};
}

// Members that own memory stand before the objects in it, because members are destroyed in reverse order.

struct Buffer {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  void* data = nullptr;  ///< mapped as long as the buffer exists
  size_t bytes = 0;
};

struct Attachment {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Image image{nullptr};
  vk::raii::ImageView view{nullptr};
};

/// What layers of triangles that are blended need beside ids, depth and color of the window.
struct LayerAttachments {
  Attachment ids;       ///< layers write these and those of the window in turn
  Attachment order;     ///< the depth by which each pixel keeps the first triangle of a layer
  Attachment backdrop;  ///< the color before the layer, where it is drawn
  Attachment depth;     ///< if layers write depth
  std::array<vk::raii::Framebuffer, 2> visibility{nullptr, nullptr};  ///< of these ids, of those of the window
  vk::raii::Framebuffer blending{nullptr}, deep_blending{nullptr}, depth_copying{nullptr};
};

/// The attachments of a window; made again when its size changes.
struct WindowAttachments {
  int width = 0;
  int height = 0;
  bool has_color = false;   ///< otherwise `color` and `shading` are empty
  bool has_layers = false;  ///< otherwise `layers` is empty
  Attachment ids, depth, color;
  vk::raii::Framebuffer visibility{nullptr};
  vk::raii::Framebuffer shading{nullptr};
  LayerAttachments layers;
};

/// The images that shaders read. Those that a call does not read may be any.
struct ImagesRead {
  vk::ImageView ids, former_ids, former_depth, former_color;
};

/// The attachments of tables of one record size; grows with the rows.
struct TableAttachments {
  int height = 0;
  std::vector<Attachment> attachments;
  vk::raii::Framebuffer framebuffer{nullptr};
};

struct Device::Impl {
  /// Opens the device of this index, which must have no shortcomings().
  Impl(std::unique_ptr<Instance> instance, int index);

  vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags required,
                                  vk::MemoryPropertyFlags preferred);
  Buffer make_buffer(size_t bytes, vk::MemoryPropertyFlags preferred);
  Attachment make_attachment(vk::Format format, int width, int height, vk::ImageUsageFlags usage);
  /// A buffer that only grows, at least `bytes` long.
  void reserve(Buffer& buffer, size_t bytes, vk::MemoryPropertyFlags preferred);

  /// The render pass of an output; it clears every attachment and stores it. Made once.
  const vk::raii::RenderPass& render_pass(Output output, uint32_t attachments);
  vk::raii::Pipeline make_pipeline(const PipelineSource& source, std::span<const uint32_t> vertex,
                                   std::span<const uint32_t> fragment);

  void prepare_attachments(int width, int height, bool has_color, bool has_layers = false);
  void prepare_layers();
  vk::raii::Framebuffer make_framebuffer(Output output, std::span<const vk::ImageView> views, int width, int height);
  /// Draws a group over what is there. `depth`: what its triangles are tested against; (x, y): the pixel of the view at the
  /// attachments' first.
  void draw_group(const LayerGroup& group, const Attachment& depth, int x, int y);
  TableAttachments& prepare_table(uint32_t attachments, int height);

  /// Points the descriptor set at the current buffers. It always writes every descriptor: lavapipe crashes on one that
  /// is not written, even if no shader uses it.
  void write_descriptors(const ImagesRead& images);
  void record(const vk::raii::CommandBuffer& commands, const Call& call) const;
  /// With the attachments' first pixel at (x, y) of the view.
  void record_at(const vk::raii::CommandBuffer& commands, std::span<const Call> calls, int x, int y) const;

  /// Records, submits and waits. Afterwards the host sees what the device wrote. Shaders read the ids of the window.
  template <class Record>
  void submit(Record record) {
    const vk::ImageView ids = *attachments.ids.view;
    submit({ids, ids, ids, ids}, record);
  }
  template <class Record>
  void submit(const ImagesRead& images, Record record);

  std::unique_ptr<Instance> instance;
  vk::raii::PhysicalDevice physical;
  DeviceInfo info;
  vk::PhysicalDeviceLimits limits;
  vk::PhysicalDeviceMemoryProperties memory;

  vk::raii::Device device{nullptr};
  vk::raii::Queue queue{nullptr};
  vk::raii::CommandPool pool{nullptr};
  vk::raii::CommandBuffer commands{nullptr};
  vk::raii::Fence fence{nullptr};

  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::DescriptorPool descriptor_pool{nullptr};
  vk::raii::DescriptorSet set{nullptr};
  vk::raii::Sampler sampler{nullptr};
  vk::raii::QueryPool samples_passed{nullptr};  ///< one occlusion query

  std::array<Buffer, storage_bindings> buffers;
  Buffer zero;  ///< always 0
  Buffer readback;
  WindowAttachments attachments;
  vk::raii::Framebuffer no_target{nullptr};
  std::map<uint32_t, TableAttachments> tables;  ///< by the number of attachments

  std::map<std::pair<Output, uint32_t>, vk::raii::RenderPass> render_passes;
  std::vector<vk::raii::Pipeline> pipelines;
  std::unordered_map<std::string, PipelineIndex> pipeline_of;  ///< by source, see key()
  double build_seconds = 0;
};

template <class Record>
void Device::Impl::submit(const ImagesRead& images, Record record) {
  write_descriptors(images);
  commands.reset();
  commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  record(commands);
  const vk::MemoryBarrier to_host{.srcAccessMask = vk::AccessFlagBits::eMemoryWrite,
                                  .dstAccessMask = vk::AccessFlagBits::eHostRead};
  commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eHost, {},
                           to_host, {}, {});
  commands.end();
  const vk::CommandBuffer handle = *commands;
  queue.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle}, *fence);
  const auto result = device.waitForFences(*fence, true, std::numeric_limits<uint64_t>::max());
  if (result != vk::Result::eSuccess) throw std::runtime_error("the device did not finish");
  device.resetFences(*fence);
}

}  // namespace isoshade::vulkan
