// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/forward_pipeline.h"

#include <array>
#include <vector>

#include "compiler/lower/frame_layout.h"

namespace isoshade::vulkan::forward {

using emit::ForwardLayout;
using namespace lower;

vk::raii::RenderPass render_pass(const Device& device, bool has_depth) {
  const auto attachment = [](vk::Format format, vk::AttachmentLoadOp load, vk::ImageLayout last) {
    return vk::AttachmentDescription{
        .format = format, .loadOp = load, .storeOp = vk::AttachmentStoreOp::eStore, .finalLayout = last};
  };
  const auto load = has_depth ? vk::AttachmentLoadOp::eClear : vk::AttachmentLoadOp::eDontCare;
  const std::array attachments{attachment(color_format, load, vk::ImageLayout::eShaderReadOnlyOptimal),
                               attachment(depth_format, load, vk::ImageLayout::eDepthStencilReadOnlyOptimal)};
  const vk::AttachmentReference color{0, vk::ImageLayout::eColorAttachmentOptimal},
      depth{1, vk::ImageLayout::eDepthStencilAttachmentOptimal};
  const vk::SubpassDescription subpass{
      .colorAttachmentCount = 1, .pColorAttachments = &color, .pDepthStencilAttachment = has_depth ? &depth : nullptr};
  // The posts that follow read what was drawn.
  const vk::SubpassDependency then{
      .srcSubpass = 0,
      .dstSubpass = VK_SUBPASS_EXTERNAL,
      .srcStageMask = vk::PipelineStageFlagBits::eColorAttachmentOutput | vk::PipelineStageFlagBits::eLateFragmentTests,
      .dstStageMask = vk::PipelineStageFlagBits::eFragmentShader,
      .srcAccessMask = vk::AccessFlagBits::eColorAttachmentWrite | vk::AccessFlagBits::eDepthStencilAttachmentWrite,
      .dstAccessMask = vk::AccessFlagBits::eShaderRead};
  return {*device, {.attachmentCount = has_depth ? 2u : 1u,
                      .pAttachments = attachments.data(),
                      .subpassCount = 1,
                      .pSubpasses = &subpass,
                      .dependencyCount = 1,
                      .pDependencies = &then}};
}

std::optional<Pipeline> pipeline(const Device& device, const driver::ForwardPair& pair, const std::optional<State>& state,
                                 const vk::raii::RenderPass& pass, glsl::Contract contract,
                                 support::Diagnostics& diagnostics) {
  Pipeline made;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  const auto bind = [&](int binding, vk::DescriptorType type) {
    bindings.push_back({.binding = static_cast<uint32_t>(binding),
                        .descriptorType = type,
                        .descriptorCount = 1,
                        .stageFlags = vk::ShaderStageFlagBits::eAllGraphics});
  };
  for (const ForwardLayout::Block& block : pair.layout.blocks) bind(block.binding, vk::DescriptorType::eUniformBuffer);
  for (const ForwardLayout::Sampler& sampler : pair.layout.samplers)
    bind(sampler.binding, vk::DescriptorType::eCombinedImageSampler);
  made.set = vk::raii::DescriptorSetLayout(
      *device, {.bindingCount = static_cast<uint32_t>(bindings.size()), .pBindings = bindings.data()});
  const vk::DescriptorSetLayout set = *made.set;
  made.layout = vk::raii::PipelineLayout(*device, {.setLayoutCount = 1, .pSetLayouts = &set});

  std::vector<vk::raii::ShaderModule> modules;
  std::vector<vk::PipelineShaderStageCreateInfo> stages;
  for (const auto& [kind, text, stage] :
       {std::tuple{glsl::ShaderKind::vertex, &pair.text.vertex, vk::ShaderStageFlagBits::eVertex},
        std::tuple{glsl::ShaderKind::fragment, &pair.text.fragment, vk::ShaderStageFlagBits::eFragment}}) {
    const auto words = glsl::compile_spirv(*text, kind, diagnostics, "the forward pair " + pair.stem, contract);
    if (!words) return std::nullopt;
    modules.emplace_back(*device, vk::ShaderModuleCreateInfo{.codeSize = 4 * words->size(), .pCode = words->data()});
    stages.push_back({.stage = stage, .module = *modules.back(), .pName = "main"});
  }
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
  // A post makes its triangle of the numbers of the vertices.
  const bool is_post = !state;
  const vk::PipelineVertexInputStateCreateInfo input{
      .vertexBindingDescriptionCount = is_post ? 0u : 1u,
      .pVertexBindingDescriptions = &binding,
      .vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size()),
      .pVertexAttributeDescriptions = attributes.data()};
  const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
  const vk::PipelineViewportStateCreateInfo viewports{.viewportCount = 1, .scissorCount = 1};
  const auto [cull, mirrored, depth_test] =
      state.value_or(State(interface::Cull::none, false, interface::DepthTest::always));
  const vk::PipelineRasterizationStateCreateInfo rasterization{
      .cullMode = cull == interface::Cull::none   ? vk::CullModeFlagBits::eNone
                  : cull == interface::Cull::back ? vk::CullModeFlagBits::eBack
                                                  : vk::CullModeFlagBits::eFront,
      .frontFace = mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise,
      .lineWidth = 1};
  const vk::PipelineMultisampleStateCreateInfo samples{};
  const vk::PipelineDepthStencilStateCreateInfo depth{
      .depthTestEnable = true,
      .depthWriteEnable = true,
      .depthCompareOp = depth_test == interface::DepthTest::always ? vk::CompareOp::eAlways : vk::CompareOp::eGreater};
  const vk::PipelineColorBlendAttachmentState all{
      .colorWriteMask = vk::ColorComponentFlagBits::eR | vk::ColorComponentFlagBits::eG | vk::ColorComponentFlagBits::eB |
                        vk::ColorComponentFlagBits::eA};
  const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = 1, .pAttachments = &all};
  constexpr std::array dynamic_states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = 2, .pDynamicStates = dynamic_states.data()};
  made.pipeline = vk::raii::Pipeline(*device, nullptr,
                                     {.stageCount = static_cast<uint32_t>(stages.size()),
                                      .pStages = stages.data(),
                                      .pVertexInputState = &input,
                                      .pInputAssemblyState = &assembly,
                                      .pViewportState = &viewports,
                                      .pRasterizationState = &rasterization,
                                      .pMultisampleState = &samples,
                                      .pDepthStencilState = is_post ? nullptr : &depth,
                                      .pColorBlendState = &blend,
                                      .pDynamicState = &dynamic,
                                      .layout = *made.layout,
                                      .renderPass = *pass});
  return made;
}

vk::raii::Sampler sampler(const Device& device, const Sampling& sampling) {
  const auto filter = sampling.filter == nodes::Filter::closest ? vk::Filter::eNearest : vk::Filter::eLinear;
  const auto address = [](nodes::AddressMode mode) {
    return mode == nodes::AddressMode::periodic ? vk::SamplerAddressMode::eRepeat
           : mode == nodes::AddressMode::mirror ? vk::SamplerAddressMode::eMirroredRepeat
                                                : vk::SamplerAddressMode::eClampToEdge;
  };
  return {*device, {.magFilter = filter,
                    .minFilter = filter,
                    .mipmapMode = sampling.filter == nodes::Filter::trilinear ? vk::SamplerMipmapMode::eLinear
                                                                              : vk::SamplerMipmapMode::eNearest,
                    .addressModeU = address(sampling.u),
                    .addressModeV = address(sampling.v),
                    .maxLod = VK_LOD_CLAMP_NONE}};
}

}  // namespace isoshade::vulkan::forward
