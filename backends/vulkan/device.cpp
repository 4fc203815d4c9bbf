// SPDX-License-Identifier: Apache-2.0
// Opening a device, its descriptor sets and submissions.
#include "backends/vulkan/device.h"

#include <algorithm>
#include <array>
#include <limits>

#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/stages.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::vulkan {

namespace {

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
        .descriptorType = is_image_binding(i) ? vk::DescriptorType::eCombinedImageSampler
                                              : vk::DescriptorType::eStorageBuffer,
        .descriptorCount = 1,
        .stageFlags = shader_stages};
  return {device, vk::DescriptorSetLayoutCreateInfo{.bindingCount = static_cast<uint32_t>(bindings.size()),
                                                    .pBindings = bindings.data()}};
}

vk::raii::PipelineLayout make_layout(const vk::raii::Device& device,
                                     const vk::raii::DescriptorSetLayout& set_layout) {
  const vk::DescriptorSetLayout set = *set_layout;
  const vk::PushConstantRange push{.stageFlags = shader_stages, .size = sizeof(Push)};
  return {device, vk::PipelineLayoutCreateInfo{.setLayoutCount = 1,
                                               .pSetLayouts = &set,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &push}};
}

vk::raii::DescriptorPool make_descriptor_pool(const vk::raii::Device& device) {
  const std::array sizes = {vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, max_sets * (binding_count - image_bindings)},
                            vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, max_sets * image_bindings}};
  return {device, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                               .maxSets = max_sets,
                                               .poolSizeCount = static_cast<uint32_t>(sizes.size()),
                                               .pPoolSizes = sizes.data()}};
}

/// Whether every memory is the device's: the host can write there, and copies would gain nothing.
bool shares_memory(const vk::PhysicalDeviceMemoryProperties& memory) {
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (!(memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)) return false;
  return true;
}

}  // namespace

Device::Impl::Impl(std::unique_ptr<Instance> owner, int index, const VulkanOptions& options)
    : instance(std::move(owner)),
      physical(std::move(instance->devices[static_cast<size_t>(index)])),
      info(describe(physical, index)),
      identity(vulkan::identity(*instance, physical, info)),
      disk_cache(options.cache) {
  limits = physical.getProperties().limits;
  memory = physical.getMemoryProperties();
  own_memory = options.own_memory || !shares_memory(memory);
  computes = options.compute.value_or(!info.cpu) && !options.glsl;
  if (computes) identity += ", computing";  // the probe looks at more
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
  const std::vector<vk::DescriptorSetLayout> layouts(max_sets, *set_layout);
  vk::raii::DescriptorSets made(
      device, {.descriptorPool = *descriptor_pool, .descriptorSetCount = max_sets, .pSetLayouts = layouts.data()});
  for (size_t i = 0; i < sets.size(); ++i) sets[i].set = std::move(made[i]);
  sampler = vk::raii::Sampler(
      device, vk::SamplerCreateInfo{.magFilter = vk::Filter::eNearest, .minFilter = vk::Filter::eNearest});
  samples_passed =
      vk::raii::QueryPool(device, {.queryType = vk::QueryType::eOcclusion, .queryCount = max_layers_at_once});
  if (const uint32_t bits = physical.getQueueFamilyProperties()[family].timestampValidBits; bits > 0) {
    timestamps =
        vk::raii::QueryPool(device, {.queryType = vk::QueryType::eTimestamp, .queryCount = 2 * max_timed_steps});
    timestamp_mask = std::numeric_limits<uint64_t>::max() >> (64 - bits);
  }
  constexpr std::array<char, smallest_buffer> zeros{};
  for (Array& array : arrays) upload(array, zeros.data(), zeros.size(), {});
  upload(zero, zeros.data(), zeros.size(), {});
  upload(indices, zeros.data(), zeros.size(), {});
  const BufferUse use = own_memory ? BufferUse::device : BufferUse::shared;
  for (Buffer* buffer : {&positions, &cuts, &seen, &tiles, &orders}) reserve(*buffer, smallest_buffer, use);
  reserve(output, smallest_buffer, use);
  prepare_attachments(1, 1, true);
  no_target = vk::raii::Framebuffer(
      device, {.renderPass = *render_pass(Output::buffer, 0), .width = 1, .height = 1, .layers = 1});
  open_pipeline_cache();
}

void Device::Impl::write_descriptors(vk::DescriptorSet set, const ImagesRead& images) {
  std::array<vk::DescriptorBufferInfo, binding_count> buffer_infos;
  std::array<vk::DescriptorImageInfo, binding_count> image_infos;
  std::array<vk::WriteDescriptorSet, binding_count> writes;
  const auto write_buffer = [&](uint32_t i, const Buffer& buffer) {
    buffer_infos[i] = vk::DescriptorBufferInfo{.buffer = *buffer.buffer, .range = VK_WHOLE_SIZE};
    writes[i] = vk::WriteDescriptorSet{.dstSet = set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = vk::DescriptorType::eStorageBuffer,
                                       .pBufferInfo = &buffer_infos[i]};
  };
  const auto write_image = [&](uint32_t i, vk::ImageView view) {
    image_infos[i] = vk::DescriptorImageInfo{
        .sampler = *sampler, .imageView = view, .imageLayout = vk::ImageLayout::eShaderReadOnlyOptimal};
    writes[i] = vk::WriteDescriptorSet{.dstSet = set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                       .pImageInfo = &image_infos[i]};
  };
  for (uint32_t i = 0; i < frame_bindings; ++i) write_buffer(i, arrays[i].buffer);
  write_buffer(output_binding, output);
  write_buffer(positions_binding, positions);
  write_buffer(indices_binding, indices.buffer);
  write_buffer(cuts_binding, cuts);
  write_buffer(seen_binding, seen);
  write_buffer(tiles_binding, tiles);
  write_buffer(orders_binding, orders);
  write_buffer(zero_binding, zero.buffer);
  write_image(ids_binding, images.ids);
  write_image(former_ids_binding, images.former_ids);
  write_image(former_depth_binding, images.former_depth);
  write_image(former_color_binding, images.former_color);
  device.updateDescriptorSets(writes, {});
}

void Device::Impl::read(const ImagesRead& images) {
  const auto fits = [&](const DescriptorSet& set) { return set.generation == generation && set.images == images; };
  auto found = std::ranges::find_if(sets, fits);
  if (found == sets.end()) {
    found = std::ranges::min_element(sets, {}, &DescriptorSet::recording);
    support::assert_that(found->recording < recording, "a recording needs more descriptor sets than there are");
    write_descriptors(*found->set, images);
    found->images = images;
    found->generation = generation;
  }
  found->recording = recording;
  current_set = *found->set;
}

const vk::raii::CommandBuffer& Device::Impl::begin() {
  const vk::ImageView ids = *attachments.ids.view;
  return begin({ids, ids, ids, ids});
}

const vk::raii::CommandBuffer& Device::Impl::begin(const ImagesRead& images) {
  commands.reset();
  commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  ++recording;
  state = {};
  timed.clear();
  if (*timestamps) commands.resetQueryPool(*timestamps, 0, 2 * max_timed_steps);
  read(images);
  copy_pending();
  return commands;
}

void Device::Impl::copy_pending() {
  std::vector<Array*> waiting;
  const auto add = [&](Array& array) {
    if (!array.pending.empty()) waiting.push_back(&array);
  };
  std::ranges::for_each(arrays, add);
  add(zero);
  add(indices);
  if (waiting.empty()) return;
  const TimedStep step(*this, &DeviceSeconds::copies);
  for (const Array* array : waiting) commands.copyBuffer(*array->staging.buffer, *array->buffer.buffer, array->pending);
  const vk::MemoryBarrier barrier{.srcAccessMask = vk::AccessFlagBits::eTransferWrite,
                                  .dstAccessMask = vk::AccessFlagBits::eShaderRead};
  commands.pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eAllCommands, {},
                           barrier, {}, {});
}

void Device::Impl::bind_computing(const Call& call) {
  constexpr auto point = vk::PipelineBindPoint::eCompute;
  if (state.computing_pipeline != call.pipeline)
    commands.bindPipeline(point, *pipelines[call.pipeline].pipeline);
  if (state.computing_set != current_set) commands.bindDescriptorSets(point, *layout, 0, current_set, {});
  state.computing_pipeline = call.pipeline;
  state.computing_set = current_set;
}

void Device::Impl::compute_groups(const Call& call, uint32_t groups) {
  bind_computing(call);
  Push push = call.push;
  push.left = static_cast<int32_t>(call.first_vertex);
  push.columns = static_cast<int32_t>(call.vertex_count);
  commands.pushConstants<Push>(*layout, shader_stages, 0, push);
  commands.dispatch(groups, 1, 1);
}

void Device::Impl::compute(const Call& call) {
  bind_computing(call);
  const Output output = pipelines[call.pipeline].output;
  const auto groups = [](int32_t of, int side) { return static_cast<uint32_t>((of + side - 1) / side); };
  Push push = call.push;
  if (output == Output::pixels) {
    push.left = call.scissor.x - push.origin_x;
    push.top = call.scissor.y - push.origin_y;
    push.columns = call.scissor.width;
    push.rows = call.scissor.height;
    commands.pushConstants<Push>(*layout, shader_stages, 0, push);
    commands.dispatch(groups(push.columns, glsl::compute_side), groups(push.rows, glsl::compute_side), 1);
    return;
  }
  constexpr uint32_t most = 65535 * glsl::compute_length;  // every device takes so many groups
  for (uint32_t done = 0; done < call.vertex_count; done += most) {
    push.left = static_cast<int32_t>(call.first_vertex + done);
    push.columns = static_cast<int32_t>(std::min(most, call.vertex_count - done));
    commands.pushConstants<Push>(*layout, shader_stages, 0, push);
    commands.dispatch(groups(push.columns, glsl::compute_length), 1, 1);
  }
}

void Device::Impl::record(const Call& call) {
  if (vulkan::computes(pipelines[call.pipeline].output)) return compute(call);
  if (state.pipeline != call.pipeline)
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipelines[call.pipeline].pipeline);
  if (state.set != current_set)
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout, 0, current_set, {});
  state.pipeline = call.pipeline;
  state.set = current_set;
  commands.pushConstants<Push>(*layout, shader_stages, 0, call.push);
  const std::pair origin{call.push.origin_x, call.push.origin_y};
  if (state.viewport != origin) {
    // A viewport of the size of the image does not map clip space exactly to 1/256 pixel; a power of two does.
    constexpr float edge = guard_band;
    commands.setViewport(0, vk::Viewport{.x = -edge - static_cast<float>(origin.first),
                                         .y = -edge - static_cast<float>(origin.second),
                                         .width = 2 * edge,
                                         .height = 2 * edge,
                                         .minDepth = 0,
                                         .maxDepth = 1});
    state.viewport = origin;
  }
  const vk::Rect2D scissor{
      .offset = {call.scissor.x - origin.first, call.scissor.y - origin.second},
      .extent = {static_cast<uint32_t>(call.scissor.width), static_cast<uint32_t>(call.scissor.height)}};
  if (state.scissor != scissor) commands.setScissor(0, scissor);
  state.scissor = scissor;
  commands.draw(call.vertex_count, 1, call.first_vertex, 0);
}

void Device::Impl::finish() {
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
  for (Array& array : arrays) array.pending.clear();
  zero.pending.clear();
  indices.pending.clear();
  add_times();
}

void Device::Impl::add_times() {
  if (timed.empty()) return;
  const auto count = static_cast<uint32_t>(2 * timed.size());
  const auto [result, times] = timestamps.getResults<uint64_t>(
      0, count, count * sizeof(uint64_t), sizeof(uint64_t), vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
  if (result != vk::Result::eSuccess) throw std::runtime_error("the device did not tell the time");
  for (size_t i = 0; i < timed.size(); ++i) {
    const uint64_t ticks = (times[2 * i + 1] - times[2 * i]) & timestamp_mask;
    seconds.*timed[i] += static_cast<double>(ticks) * 1e-9 * static_cast<double>(limits.timestampPeriod);
  }
}

Device::Impl::TimedStep::TimedStep(Impl& device, double DeviceSeconds::*sum) : device_(device) {
  if (!*device.timestamps || device.timed.size() == max_timed_steps) return;
  index_ = static_cast<uint32_t>(device.timed.size());
  device.timed.push_back(sum);
  device.commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *device.timestamps, 2 * index_);
}

Device::Impl::TimedStep::~TimedStep() {
  if (index_ < max_timed_steps)
    device_.commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *device_.timestamps, 2 * index_ + 1);
}

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Device::~Device() {
  impl_->keep_pipelines();
  if (!impl_->instance->validates) return;
  // The layers report leaked objects when the device is destroyed, too late for a diagnostic.
  const std::unique_ptr<Instance> instance = std::move(impl_->instance);
  impl_.reset();
  for (const std::string& message : instance->messages->take()) support::bug(message);
}

std::unique_ptr<Device> Device::open(const VulkanOptions& options, support::Diagnostics& diagnostics) {
  auto instance = std::make_unique<Instance>();
  // Threads have the float mode of the thread that starts them, and those in which lavapipe runs compute shaders keep it:
  // they flush denormals only if this one does.
  const lanes::FpGuard guard_floats;
  const int index = choose(*instance, options.device, diagnostics);
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
  return std::unique_ptr<Device>(new Device(std::make_unique<Impl>(std::move(instance), index, options)));
}

const DeviceInfo& Device::info() const { return impl_->info; }
const std::string& Device::identity() const { return impl_->identity; }
const DiskCache& Device::disk_cache() const { return impl_->disk_cache; }
std::optional<DeviceSeconds> Device::seconds() const {
  return *impl_->timestamps ? std::optional(impl_->seconds) : std::nullopt;
}
bool Device::computes() const { return impl_->computes; }
bool Device::validates() const { return impl_->instance->validates; }
std::vector<std::string> Device::take_messages() { return impl_->instance->messages->take(); }
size_t Device::max_buffer_bytes() const { return impl_->limits.maxStorageBufferRange; }

int Device::max_frame_side() const {
  const uint32_t side = std::min({impl_->limits.maxImageDimension2D, impl_->limits.maxFramebufferWidth,
                                  impl_->limits.maxFramebufferHeight, uint32_t{guard_band}});
  return static_cast<int>(side);
}

}  // namespace isoshade::vulkan
