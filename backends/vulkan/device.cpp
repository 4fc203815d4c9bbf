// SPDX-License-Identifier: Apache-2.0
// Opening a device, and the memory of its arrays and attachments.
#include "backends/vulkan/device.h"

#include <algorithm>
#include <cstring>

#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"

namespace isoshade::vulkan {

namespace {

using Memory = vk::MemoryPropertyFlagBits;
using Stage = vk::ShaderStageFlagBits;

constexpr vk::MemoryPropertyFlags mapped = Memory::eHostVisible | Memory::eHostCoherent;
constexpr size_t smallest_buffer = 256;

vk::raii::Device make_device(const vk::raii::PhysicalDevice& physical, uint32_t family) {
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue{
      .queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
  const char* float_controls = VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME;
  const vk::PhysicalDeviceFeatures features{.vertexPipelineStoresAndAtomics = true};
  return {physical, vk::DeviceCreateInfo{.queueCreateInfoCount = 1,
                                         .pQueueCreateInfos = &queue,
                                         .enabledExtensionCount = 1,
                                         .ppEnabledExtensionNames = &float_controls,
                                         .pEnabledFeatures = &features}};
}

vk::raii::DescriptorSetLayout make_set_layout(const vk::raii::Device& device) {
  std::array<vk::DescriptorSetLayoutBinding, binding_count> bindings;
  for (uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = vk::DescriptorSetLayoutBinding{
        .binding = i,
        .descriptorType =
            is_image_binding(i) ? vk::DescriptorType::eCombinedImageSampler : vk::DescriptorType::eStorageBuffer,
        .descriptorCount = 1,
        .stageFlags = Stage::eVertex | Stage::eFragment};
  return {device, vk::DescriptorSetLayoutCreateInfo{.bindingCount = static_cast<uint32_t>(bindings.size()),
                                                    .pBindings = bindings.data()}};
}

vk::raii::PipelineLayout make_layout(const vk::raii::Device& device,
                                     const vk::raii::DescriptorSetLayout& set_layout) {
  const vk::DescriptorSetLayout set = *set_layout;
  const vk::PushConstantRange push{.stageFlags = Stage::eVertex | Stage::eFragment, .size = sizeof(Push)};
  return {device, vk::PipelineLayoutCreateInfo{.setLayoutCount = 1,
                                               .pSetLayouts = &set,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &push}};
}

vk::raii::DescriptorPool make_descriptor_pool(const vk::raii::Device& device) {
  const std::array sizes = {vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, binding_count - image_bindings},
                            vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, image_bindings}};
  return {device, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                               .maxSets = 1,
                                               .poolSizeCount = static_cast<uint32_t>(sizes.size()),
                                               .pPoolSizes = sizes.data()}};
}

}  // namespace

Device::Impl::Impl(std::unique_ptr<Instance> owner, int index)
    : instance(std::move(owner)), physical(std::move(instance->devices[static_cast<size_t>(index)])) {
  info = describe(physical, index);
  limits = physical.getProperties().limits;
  memory = physical.getMemoryProperties();
  const auto family = static_cast<uint32_t>(graphics_family(physical));
  device = make_device(physical, family);
  queue = device.getQueue(family, 0);
  pool = vk::raii::CommandPool(
      device, {.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer, .queueFamilyIndex = family});
  commands =
      std::move(vk::raii::CommandBuffers(device, {.commandPool = *pool, .commandBufferCount = 1}).front());
  fence = vk::raii::Fence(device, vk::FenceCreateInfo{});

  set_layout = make_set_layout(device);
  layout = make_layout(device, set_layout);
  descriptor_pool = make_descriptor_pool(device);
  const vk::DescriptorSetLayout set_layout_handle = *set_layout;
  set = std::move(vk::raii::DescriptorSets(device, {.descriptorPool = *descriptor_pool,
                                                    .descriptorSetCount = 1,
                                                    .pSetLayouts = &set_layout_handle})
                      .front());
  sampler = vk::raii::Sampler(
      device, vk::SamplerCreateInfo{.magFilter = vk::Filter::eNearest, .minFilter = vk::Filter::eNearest});
  samples_passed =
      vk::raii::QueryPool(device, {.queryType = vk::QueryType::eOcclusion, .queryCount = 1});
  for (Buffer& buffer : buffers) reserve(buffer, smallest_buffer, {});
  reserve(zero, smallest_buffer, {});
  std::memset(zero.data, 0, smallest_buffer);
  prepare_attachments(1, 1, true);
  no_target = vk::raii::Framebuffer(
      device, {.renderPass = *render_pass(Output::buffer, 0), .width = 1, .height = 1, .layers = 1});
}

Buffer Device::Impl::make_buffer(size_t bytes, vk::MemoryPropertyFlags preferred) {
  Buffer made;
  made.buffer = vk::raii::Buffer(
      device, {.size = bytes,
               .usage = vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eTransferDst});
  const vk::MemoryRequirements needs = made.buffer.getMemoryRequirements();
  made.memory = allocate(needs, mapped, preferred);
  made.buffer.bindMemory(*made.memory, 0);
  made.data = made.memory.mapMemory(0, VK_WHOLE_SIZE);
  made.bytes = bytes;
  return made;
}

Attachment Device::Impl::make_attachment(vk::Format format, int width, int height,
                                         vk::ImageUsageFlags usage) {
  const vk::Extent3D extent{static_cast<uint32_t>(width), static_cast<uint32_t>(height), 1};
  const bool is_depth = format == depth_format;
  Attachment made;
  made.image =
      vk::raii::Image(device, {.imageType = vk::ImageType::e2D,
                               .format = format,
                               .extent = extent,
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .usage = usage | (is_depth ? vk::ImageUsageFlagBits::eDepthStencilAttachment
                                                          : vk::ImageUsageFlagBits::eColorAttachment)});
  made.memory = allocate(made.image.getMemoryRequirements(), {}, Memory::eDeviceLocal);
  made.image.bindMemory(*made.memory, 0);
  made.view = vk::raii::ImageView(device, {.image = *made.image,
                                           .viewType = vk::ImageViewType::e2D,
                                           .format = format,
                                           .subresourceRange = whole(format)});
  return made;
}

vk::raii::DeviceMemory Device::Impl::allocate(const vk::MemoryRequirements& needs,
                                              vk::MemoryPropertyFlags required,
                                              vk::MemoryPropertyFlags preferred) {
  const auto allocate_from = [&](vk::MemoryPropertyFlags wanted) -> vk::raii::DeviceMemory {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((needs.memoryTypeBits >> i & 1) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted)
        return {device, {.allocationSize = needs.size, .memoryTypeIndex = i}};
    return nullptr;
  };
  // The preferred memory is scarce on some devices (memory that host and device share), so it may be full.
  try {
    vk::raii::DeviceMemory made = allocate_from(required | preferred);
    if (*made) return made;
  } catch (const vk::OutOfDeviceMemoryError&) {
    if (!preferred) throw;
  }
  vk::raii::DeviceMemory made = allocate_from(required);
  if (!*made) throw std::runtime_error("no memory type fits");
  return made;
}

void Device::Impl::reserve(Buffer& buffer, size_t bytes, vk::MemoryPropertyFlags preferred) {
  if (buffer.bytes >= bytes) return;
  buffer = {};  // first, because both might not fit
  buffer = make_buffer(bytes, preferred);
}

void Device::Impl::write_descriptors(const ImagesRead& images) {
  std::array<vk::DescriptorBufferInfo, binding_count> buffer_infos;
  std::array<vk::DescriptorImageInfo, binding_count> image_infos;
  std::array<vk::WriteDescriptorSet, binding_count> writes;
  const auto write_buffer = [&](uint32_t i, const Buffer& buffer) {
    buffer_infos[i] = vk::DescriptorBufferInfo{.buffer = *buffer.buffer, .range = VK_WHOLE_SIZE};
    writes[i] = vk::WriteDescriptorSet{.dstSet = *set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = vk::DescriptorType::eStorageBuffer,
                                       .pBufferInfo = &buffer_infos[i]};
  };
  const auto write_image = [&](uint32_t i, vk::ImageView view) {
    image_infos[i] = vk::DescriptorImageInfo{
        .sampler = *sampler, .imageView = view, .imageLayout = vk::ImageLayout::eShaderReadOnlyOptimal};
    writes[i] = vk::WriteDescriptorSet{.dstSet = *set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                       .pImageInfo = &image_infos[i]};
  };
  for (uint32_t i = 0; i < storage_bindings; ++i) write_buffer(i, buffers[i]);
  write_buffer(zero_binding, zero);
  write_image(ids_binding, images.ids);
  write_image(former_ids_binding, images.former_ids);
  write_image(former_depth_binding, images.former_depth);
  write_image(former_color_binding, images.former_color);
  device.updateDescriptorSets(writes, {});
}

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Device::~Device() {
  if (!impl_->instance->validates) return;
  // The layers report leaked objects when the device is destroyed, too late for a diagnostic.
  const std::unique_ptr<Instance> instance = std::move(impl_->instance);
  impl_.reset();
  for (const std::string& message : instance->messages->take()) support::bug(message);
}

std::unique_ptr<Device> Device::open(std::string_view selector, support::Diagnostics& diagnostics) {
  auto instance = std::make_unique<Instance>();
  const int index = choose(*instance, selector, diagnostics);
  if (index < 0) return nullptr;
  const vk::raii::PhysicalDevice& physical = instance->devices[static_cast<size_t>(index)];
  const std::vector<std::string> lacks = shortcomings(physical);
  if (!lacks.empty()) {
    support::Diagnostic& report =
        diagnostics.report(support::Id::unfit_device,
                           describe(physical, index).name + " cannot run the shaders: " + lacks.front());
    for (size_t i = 1; i < lacks.size(); ++i) report.note(lacks[i]);
    return nullptr;
  }
  return std::unique_ptr<Device>(new Device(std::make_unique<Impl>(std::move(instance), index)));
}

const DeviceInfo& Device::info() const { return impl_->info; }
bool Device::validates() const { return impl_->instance->validates; }
std::vector<std::string> Device::take_messages() { return impl_->instance->messages->take(); }
size_t Device::max_buffer_bytes() const { return impl_->limits.maxStorageBufferRange; }

int Device::max_frame_side() const {
  const uint32_t side = std::min({impl_->limits.maxImageDimension2D, impl_->limits.maxFramebufferWidth,
                                  impl_->limits.maxFramebufferHeight, uint32_t{guard_band}});
  return static_cast<int>(side);
}

void Device::upload(lower::FrameBuffer buffer, const void* data, size_t bytes) {
  if (bytes == 0) return;
  Buffer& destination = impl_->buffers[static_cast<size_t>(buffer)];
  impl_->reserve(destination, bytes, Memory::eDeviceLocal);
  std::memcpy(destination.data, data, bytes);
}

}  // namespace isoshade::vulkan
