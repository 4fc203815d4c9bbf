// SPDX-License-Identifier: Apache-2.0
// Draws a planned picture with forward pairs on a Vulkan device, as a program would that knows of a pair only what its layout
// says.
#pragma once

#include <map>

#include "backends/vulkan/instance.h"
#include "tests/equivalence/forward_blocks.h"

namespace isoshade::equivalence::forward {

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

/// A program and what it is bound to.
struct Pair {
  ForwardLayout layout;
  interface::PassState state;
  bool mirrored = false;
  vk::raii::DescriptorSetLayout set{nullptr};
  vk::raii::PipelineLayout pipeline_layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

inline constexpr vk::Format color_format = vk::Format::eR32G32B32A32Sfloat, depth_format = vk::Format::eD32Sfloat;

class Renderer {
 public:
  Renderer(const vk::raii::PhysicalDevice& physical, int width, int height)
      : physical_(physical), width_(static_cast<uint32_t>(width)), height_(static_cast<uint32_t>(height)) {
    const auto family = static_cast<uint32_t>(vulkan::graphics_family(physical));
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue{.queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
    device_ = vk::raii::Device(physical, {.queueCreateInfoCount = 1, .pQueueCreateInfos = &queue});
    queue_ = device_.getQueue(family, 0);
    pool_ = vk::raii::CommandPool(device_, {.queueFamilyIndex = family});
    color_ = target(color_format, vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc,
                    vk::ImageAspectFlagBits::eColor);
    depth_ = target(depth_format, vk::ImageUsageFlagBits::eDepthStencilAttachment, vk::ImageAspectFlagBits::eDepth);
    make_render_pass();
  }

  Pair pair(const driver::ForwardPair& made, const interface::PassState& state, bool mirrored) {
    Pair pair;
    pair.layout = made.layout;
    pair.state = state;
    pair.mirrored = mirrored;
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (const ForwardLayout::Block& block : made.layout.blocks)
      bindings.push_back({.binding = static_cast<uint32_t>(block.binding),
                          .descriptorType = vk::DescriptorType::eUniformBuffer,
                          .descriptorCount = 1,
                          .stageFlags = vk::ShaderStageFlagBits::eAllGraphics});
    for (const ForwardLayout::Sampler& sampler : made.layout.samplers)
      bindings.push_back({.binding = static_cast<uint32_t>(sampler.binding),
                          .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                          .descriptorCount = 1,
                          .stageFlags = vk::ShaderStageFlagBits::eAllGraphics});
    pair.set = vk::raii::DescriptorSetLayout(
        device_, {.bindingCount = static_cast<uint32_t>(bindings.size()), .pBindings = bindings.data()});
    const vk::DescriptorSetLayout set = *pair.set;
    pair.pipeline_layout = vk::raii::PipelineLayout(device_, {.setLayoutCount = 1, .pSetLayouts = &set});
    make_pipeline(pair, made.text);
    return pair;
  }

  Memory memory(size_t bytes, vk::BufferUsageFlags usage) {
    Memory made;
    made.buffer = vk::raii::Buffer(device_, {.size = bytes, .usage = usage});
    made.memory = allocate(made.buffer.getMemoryRequirements(), vk::MemoryPropertyFlagBits::eHostVisible |
                                                                    vk::MemoryPropertyFlagBits::eHostCoherent);
    made.buffer.bindMemory(*made.memory, 0);
    made.data = static_cast<std::byte*>(made.memory.mapMemory(0, bytes));
    return made;
  }

  /// Draws all draws of the plan's picture; returns rgba, rows top down.
  std::vector<float> draw(const render::Plan& plan, const std::vector<const Pair*>& pairs) {
    const std::vector<backends::Draw>& draws = plan.frame.picture().draws;
    const size_t alignment = physical_.getProperties().limits.minUniformBufferOffsetAlignment;
    size_t uniform_bytes = 0, index_count = 0, blocks = 0, samplers = 0;
    const auto place = [&](size_t bytes) {
      const size_t at = (uniform_bytes + alignment - 1) / alignment * alignment;
      uniform_bytes = at + bytes;
      return at;
    };
    std::vector<std::vector<size_t>> offsets(draws.size());
    for (size_t d = 0; d < draws.size(); ++d) {
      index_count += draws[d].indices.size();
      for (const ForwardLayout::Block& block : pairs[d]->layout.blocks)
        offsets[d].push_back(place(static_cast<size_t>(block.size)));
      blocks += offsets[d].size();
      samplers += pairs[d]->layout.samplers.size();
    }
    const Memory uniforms = memory(uniform_bytes, vk::BufferUsageFlagBits::eUniformBuffer);
    const Memory vertices = memory(4 * plan.frame.vertices.size(), vk::BufferUsageFlagBits::eVertexBuffer);
    const Memory indices = memory(4 * index_count, vk::BufferUsageFlagBits::eIndexBuffer);
    const Memory read = memory(size_t{16} * width_ * height_, vk::BufferUsageFlagBits::eTransferDst);
    std::memcpy(vertices.data, plan.frame.vertices.data(), 4 * plan.frame.vertices.size());

    const std::array sizes{
        vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, static_cast<uint32_t>(blocks)},
        vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, static_cast<uint32_t>(samplers + 1)}};
    const vk::raii::Sampler sampler(device_, {.maxLod = VK_LOD_CLAMP_NONE});
    std::map<int, Target> images;
    const vk::raii::DescriptorPool pool(device_, {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                  .maxSets = static_cast<uint32_t>(draws.size()),
                                                  .poolSizeCount = 2,
                                                  .pPoolSizes = sizes.data()});
    std::vector<vk::raii::DescriptorSet> sets;
    const vk::raii::CommandBuffer commands = begin();
    std::array<vk::ClearValue, 2> clear;
    std::memcpy(&clear[0], plan.frame.picture().background, 16);
    clear[1].depthStencil = vk::ClearDepthStencilValue{0, 0};
    commands.beginRenderPass({.renderPass = *render_pass_,
                              .framebuffer = *framebuffer_,
                              .renderArea = {{0, 0}, {width_, height_}},
                              .clearValueCount = 2,
                              .pClearValues = clear.data()},
                             vk::SubpassContents::eInline);
    commands.bindVertexBuffers(0, *vertices.buffer, {0});
    commands.bindIndexBuffer(*indices.buffer, 0, vk::IndexType::eUint32);
    size_t first_index = 0;
    for (size_t d = 0; d < draws.size(); ++d) {
      const Pair& pair = *pairs[d];
      const vk::DescriptorSetLayout layout = *pair.set;
      sets.push_back(std::move(vk::raii::DescriptorSets(
          device_, {.descriptorPool = *pool, .descriptorSetCount = 1, .pSetLayouts = &layout})[0]));
      for (size_t b = 0; b < pair.layout.blocks.size(); ++b) {
        const ForwardLayout::Block& block = pair.layout.blocks[b];
        fill(pair.layout, block, plan, draws[d], {uniforms.data + offsets[d][b], static_cast<size_t>(block.size)});
        const vk::DescriptorBufferInfo info{*uniforms.buffer, offsets[d][b], static_cast<size_t>(block.size)};
        device_.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *sets.back(),
                                                            .dstBinding = static_cast<uint32_t>(block.binding),
                                                            .descriptorCount = 1,
                                                            .descriptorType = vk::DescriptorType::eUniformBuffer,
                                                            .pBufferInfo = &info},
                                     nullptr);
      }
      for (const ForwardLayout::Sampler& bound : pair.layout.samplers) {
        const int texture = texture_of(pair.layout, bound.image, &plan.frame.objects[static_cast<size_t>(draws[d].object)]);
        if (!images.contains(texture)) images.emplace(texture, upload(plan.frame, texture));
        const vk::DescriptorImageInfo info{*sampler, *images.at(texture).view, vk::ImageLayout::eShaderReadOnlyOptimal};
        device_.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *sets.back(),
                                                            .dstBinding = static_cast<uint32_t>(bound.binding),
                                                            .descriptorCount = 1,
                                                            .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                                            .pImageInfo = &info},
                                     nullptr);
      }
      const std::span<const uint32_t> list = draws[d].indices;
      std::memcpy(indices.data + 4 * first_index, list.data(), list.size_bytes());
      commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pair.pipeline);
      commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *pair.pipeline_layout, 0, *sets.back(), nullptr);
      commands.drawIndexed(static_cast<uint32_t>(list.size()), 1, static_cast<uint32_t>(first_index),
                           static_cast<int32_t>(draws[d].first_vertex), 0);
      first_index += list.size();
    }
    commands.endRenderPass();
    commands.copyImageToBuffer(*color_.image, vk::ImageLayout::eTransferSrcOptimal, *read.buffer,
                               vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                                   .imageExtent = {width_, height_, 1}});
    submit(commands);
    std::vector<float> rgba(size_t{4} * width_ * height_);
    std::memcpy(rgba.data(), read.data, 4 * rgba.size());
    return rgba;
  }

 private:
  vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags wanted) {
    const vk::PhysicalDeviceMemoryProperties types = physical_.getMemoryProperties();
    for (uint32_t i = 0; i < types.memoryTypeCount; ++i)
      if ((needs.memoryTypeBits >> i & 1) != 0 && (types.memoryTypes[i].propertyFlags & wanted) == wanted)
        return {device_, {.allocationSize = needs.size, .memoryTypeIndex = i}};
    throw std::runtime_error("no such memory");
  }

  vk::raii::CommandBuffer begin() {
    vk::raii::CommandBuffers made(device_, {.commandPool = *pool_, .commandBufferCount = 1});
    made[0].begin({});
    return std::move(made[0]);
  }
  void submit(const vk::raii::CommandBuffer& commands) {
    commands.end();
    const vk::CommandBuffer handle = *commands;
    queue_.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle});
    device_.waitIdle();
  }

  /// The number of the texture that an object gives an image; -1: none.
  static int texture_of(const ForwardLayout& layout, const std::string& image, const float* object) {
    const auto block = std::ranges::find(layout.blocks, ForwardBlock::parameters, &ForwardLayout::Block::block);
    int word = object_word::parameters;
    for (const ForwardMember& member : block->members) {
      if (member.name == image) return static_cast<int>(object[word]);
      word += words_of(member);
    }
    return -1;
  }

  /// A texture of the frame with its mip levels, linear; one black texel for none.
  Target upload(const backends::Frame& frame, int texture) {
    constexpr std::array<int32_t, texture_word::stride> none{};
    const auto record = [&](uint32_t level) {
      return texture < 0 ? none.data() : &frame.textures[(static_cast<size_t>(texture) + level) * texture_word::stride];
    };
    const auto extent = [&](uint32_t level, int word) { return static_cast<uint32_t>(std::max(record(level)[word], 1)); };
    const auto levels = static_cast<uint32_t>(record(0)[texture_word::smaller] + 1);
    Target made = target(color_format, vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                         vk::ImageAspectFlagBits::eColor, {extent(0, texture_word::width), extent(0, texture_word::height), 1},
                         levels);
    const vk::raii::CommandBuffer commands = begin();
    const auto change = [&](vk::ImageLayout from, vk::ImageLayout to) {
      commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eAllCommands, {}, {}, {},
                               vk::ImageMemoryBarrier{.srcAccessMask = vk::AccessFlagBits::eMemoryWrite,
                                                      .dstAccessMask = vk::AccessFlagBits::eMemoryRead,
                                                      .oldLayout = from,
                                                      .newLayout = to,
                                                      .image = *made.image,
                                                      .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, levels, 0, 1}});
    };
    change(vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
    std::vector<Memory> staged;
    for (uint32_t level = 0; level < levels; ++level) {
      const uint32_t width = extent(level, texture_word::width), height = extent(level, texture_word::height);
      staged.push_back(memory(size_t{16} * width * height, vk::BufferUsageFlagBits::eTransferSrc));
      std::vector<float> texels(size_t{4} * width * height);
      if (texture >= 0)
        for (size_t i = 0; i < texels.size(); ++i) texels[i] = channel(frame, record(level), i / 4, static_cast<int>(i % 4));
      std::memcpy(staged.back().data, texels.data(), 4 * texels.size());
      commands.copyBufferToImage(*staged.back().buffer, *made.image, vk::ImageLayout::eTransferDstOptimal,
                                 vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, level, 0, 1},
                                                     .imageExtent = {width, height, 1}});
    }
    change(vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    submit(commands);
    return made;
  }

  static float channel(const backends::Frame& frame, const int32_t* record, size_t texel, int channel) {
    const auto first = static_cast<size_t>(record[texture_word::first]);
    const int table = record[texture_word::table];
    if (table < 0) return frame.texels[first + 4 * texel + static_cast<size_t>(channel)];
    const uint32_t byte = frame.texel_bytes[first + texel] >> 8 * channel & 255;
    return frame.texels[static_cast<size_t>(channel == 3 ? byte_table::linear : table) + byte];
  }

  Target target(vk::Format format, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect) {
    return target(format, usage, aspect, {width_, height_, 1}, 1);
  }
  Target target(vk::Format format, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect, vk::Extent3D extent,
                uint32_t levels) {
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

  void make_render_pass() {
    const auto attachment = [](vk::Format format, vk::ImageLayout last) {
      return vk::AttachmentDescription{.format = format,
                                       .loadOp = vk::AttachmentLoadOp::eClear,
                                       .storeOp = vk::AttachmentStoreOp::eStore,
                                       .finalLayout = last};
    };
    const std::array attachments{attachment(color_format, vk::ImageLayout::eTransferSrcOptimal),
                                 attachment(depth_format, vk::ImageLayout::eDepthStencilAttachmentOptimal)};
    const vk::AttachmentReference color{0, vk::ImageLayout::eColorAttachmentOptimal},
        depth{1, vk::ImageLayout::eDepthStencilAttachmentOptimal};
    const vk::SubpassDescription subpass{
        .colorAttachmentCount = 1, .pColorAttachments = &color, .pDepthStencilAttachment = &depth};
    render_pass_ = vk::raii::RenderPass(
        device_, {.attachmentCount = 2, .pAttachments = attachments.data(), .subpassCount = 1, .pSubpasses = &subpass});
    const std::array views{*color_.view, *depth_.view};
    framebuffer_ = vk::raii::Framebuffer(device_, {.renderPass = *render_pass_,
                                                   .attachmentCount = 2,
                                                   .pAttachments = views.data(),
                                                   .width = width_,
                                                   .height = height_,
                                                   .layers = 1});
  }

  void make_pipeline(Pair& pair, const emit::ForwardText& text) {
    const std::vector<uint32_t> vertex = spirv_of(text.vertex, "vert"), fragment = spirv_of(text.fragment, "frag");
    const vk::raii::ShaderModule vertex_module(device_, {.codeSize = 4 * vertex.size(), .pCode = vertex.data()});
    const vk::raii::ShaderModule fragment_module(device_, {.codeSize = 4 * fragment.size(), .pCode = fragment.data()});
    const std::array stages{vk::PipelineShaderStageCreateInfo{.stage = vk::ShaderStageFlagBits::eVertex,
                                                              .module = *vertex_module,
                                                              .pName = "main"},
                            vk::PipelineShaderStageCreateInfo{.stage = vk::ShaderStageFlagBits::eFragment,
                                                              .module = *fragment_module,
                                                              .pName = "main"}};
    const vk::VertexInputBindingDescription binding{0, 4 * vertex_word::stride, vk::VertexInputRate::eVertex};
    std::vector<vk::VertexInputAttributeDescription> attributes;
    constexpr vk::Format formats[] = {vk::Format::eR32Sfloat, vk::Format::eR32G32Sfloat, vk::Format::eR32G32B32Sfloat,
                                      vk::Format::eR32G32B32A32Sfloat};
    for (const ForwardLayout::Attribute& attribute : pair.layout.attributes) {
#define VERTEX(name, words)      \
  if (attribute.vertex == #name) \
    attributes.push_back({static_cast<uint32_t>(attribute.location), 0, formats[words - 1], 4 * vertex_word::name});
#include "compiler/interface/records.def"
    }
    const vk::PipelineVertexInputStateCreateInfo input{
        .vertexBindingDescriptionCount = 1,
        .pVertexBindingDescriptions = &binding,
        .vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size()),
        .pVertexAttributeDescriptions = attributes.data()};
    const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
    // Clip space is y up, and the picture y down.
    const vk::Viewport viewport{0, static_cast<float>(height_), static_cast<float>(width_), -static_cast<float>(height_), 0, 1};
    const vk::Rect2D scissor{{0, 0}, {width_, height_}};
    const vk::PipelineViewportStateCreateInfo viewports{
        .viewportCount = 1, .pViewports = &viewport, .scissorCount = 1, .pScissors = &scissor};
    const vk::CullModeFlags culled = pair.state.cull == interface::Cull::none   ? vk::CullModeFlagBits::eNone
                                     : pair.state.cull == interface::Cull::back ? vk::CullModeFlagBits::eBack
                                                                                : vk::CullModeFlagBits::eFront;
    const vk::PipelineRasterizationStateCreateInfo rasterization{
        .cullMode = culled,
        .frontFace = pair.mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise,
        .lineWidth = 1};
    const vk::PipelineMultisampleStateCreateInfo samples{};
    const vk::PipelineDepthStencilStateCreateInfo depth{
        .depthTestEnable = true,
        .depthWriteEnable = true,
        .depthCompareOp = pair.state.depth == interface::DepthTest::always ? vk::CompareOp::eAlways : vk::CompareOp::eGreater};
    const vk::PipelineColorBlendAttachmentState all{
        .colorWriteMask = vk::ColorComponentFlagBits::eR | vk::ColorComponentFlagBits::eG | vk::ColorComponentFlagBits::eB |
                          vk::ColorComponentFlagBits::eA};
    const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = 1, .pAttachments = &all};
    pair.pipeline = vk::raii::Pipeline(device_, nullptr,
                                       {.stageCount = 2,
                                        .pStages = stages.data(),
                                        .pVertexInputState = &input,
                                        .pInputAssemblyState = &assembly,
                                        .pViewportState = &viewports,
                                        .pRasterizationState = &rasterization,
                                        .pMultisampleState = &samples,
                                        .pDepthStencilState = &depth,
                                        .pColorBlendState = &blend,
                                        .layout = *pair.pipeline_layout,
                                        .renderPass = *render_pass_});
  }

  const vk::raii::PhysicalDevice& physical_;
  uint32_t width_, height_;
  vk::raii::Device device_{nullptr};
  vk::raii::Queue queue_{nullptr};
  vk::raii::CommandPool pool_{nullptr};
  Target color_, depth_;
  vk::raii::RenderPass render_pass_{nullptr};
  vk::raii::Framebuffer framebuffer_{nullptr};
};

}  // namespace isoshade::equivalence::forward
