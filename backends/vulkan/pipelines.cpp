// SPDX-License-Identifier: Apache-2.0
// Render passes, pipelines with the fixed state of each kind of output, and the vertex shaders that are not generated.
#include <stdexcept>

#include "backends/shared.h"
#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/glsl.h"

namespace isoshade::vulkan {

namespace {

/// The host waits for each submission, so dependencies that order everything cost nothing.
std::array<vk::SubpassDependency, 2> order_everything() {
  using Stage = vk::PipelineStageFlagBits;
  constexpr auto any_access = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
  const vk::SubpassDependency before{.srcSubpass = VK_SUBPASS_EXTERNAL,
                                     .dstSubpass = 0,
                                     .srcStageMask = Stage::eAllCommands,
                                     .dstStageMask = Stage::eAllGraphics,
                                     .srcAccessMask = any_access,
                                     .dstAccessMask = any_access};
  vk::SubpassDependency after = before;
  std::swap(after.srcSubpass, after.dstSubpass);
  std::swap(after.srcStageMask, after.dstStageMask);
  return {before, after};
}

/// A color attachment of a render pass, which clears it, or keeps what it finds in the layout in which it leaves it.
struct ColorTarget {
  vk::Format format;
  vk::ImageLayout ends_as;
  bool kept = false;
};

vk::raii::RenderPass make_render_pass(const vk::raii::Device& device, std::span<const ColorTarget> colors, bool depth) {
  std::vector<vk::AttachmentDescription> attachments;
  std::vector<vk::AttachmentReference> references;
  const auto add = [&](const ColorTarget& target, vk::ImageLayout drawn_as) {
    references.push_back({static_cast<uint32_t>(attachments.size()), drawn_as});
    attachments.push_back({.format = target.format,
                           .samples = vk::SampleCountFlagBits::e1,
                           .loadOp = target.kept ? vk::AttachmentLoadOp::eLoad : vk::AttachmentLoadOp::eClear,
                           .storeOp = vk::AttachmentStoreOp::eStore,
                           .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                           .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                           .initialLayout = target.kept ? target.ends_as : vk::ImageLayout::eUndefined,
                           .finalLayout = target.ends_as});
  };
  for (const ColorTarget& color : colors) add(color, vk::ImageLayout::eColorAttachmentOptimal);
  if (depth)
    add({depth_format, vk::ImageLayout::eTransferSrcOptimal}, vk::ImageLayout::eDepthStencilAttachmentOptimal);

  const vk::SubpassDescription subpass{.pipelineBindPoint = vk::PipelineBindPoint::eGraphics,
                                       .colorAttachmentCount = static_cast<uint32_t>(colors.size()),
                                       .pColorAttachments = references.data(),
                                       .pDepthStencilAttachment = depth ? &references.back() : nullptr};
  const auto order = order_everything();
  return {device, vk::RenderPassCreateInfo{.attachmentCount = static_cast<uint32_t>(attachments.size()),
                                           .pAttachments = attachments.data(),
                                           .subpassCount = 1,
                                           .pSubpasses = &subpass,
                                           .dependencyCount = static_cast<uint32_t>(order.size()),
                                           .pDependencies = order.data()}};
}

vk::raii::ShaderModule make_module(const vk::raii::Device& device, std::span<const uint32_t> spirv) {
  return {device, vk::ShaderModuleCreateInfo{.codeSize = spirv.size_bytes(), .pCode = spirv.data()}};
}

/// The key is unambiguous because texts contain no NUL.
std::string key(const PipelineSource& source) {
  std::string text{static_cast<char>('0' + static_cast<int>(source.output)),
                   static_cast<char>('0' + source.attachments), source.over ? '1' : '0'};
  return text + source.vertex_glsl + '\0' + source.fragment_glsl;
}

}  // namespace

const std::string& full_screen_vertex() {
  // Half of clip space is the image (see limits.h): from pixel 0 to the edge of the guard band.
  static const std::string text = glsl::head() + R"(
void main() {
  vec2 corner = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";
  return text;
}

const std::string& depth_copy_fragment() {
  static const std::string text = glsl::head() + "layout(set = 0, binding = " + std::to_string(former_depth_binding) +
                                  ") uniform sampler2D former_depth;" + R"(
layout(location = 0) out float depth;

void main() {
  depth = texelFetch(former_depth, ivec2(gl_FragCoord.xy), 0).x;
}
)";
  return text;
}

const std::string& triangle_vertex() {
  static_assert(guard_band * 256 == 2097152);
  using namespace lower;
  static const std::string text = glsl::head() + "layout(std430, set = 0, binding = " +
                                  std::to_string(static_cast<int>(FrameBuffer::triangles)) +
                                  ") readonly buffer triangles_block { int triangles[]; };" + R"(
layout(location = 0) flat out int triangle;

void main() {
  triangle = gl_VertexIndex / 3;
  int corner = gl_VertexIndex - 3 * triangle;
  int word = triangle * )" + std::to_string(triangle_word::stride) +
                                  " + " + std::to_string(triangle_word::position) + R"( + 2 * corner;
  vec2 position = vec2(float(triangles[word]), float(triangles[word + 1]));
  gl_Position = vec4(position * (1.0 / 2097152.0), 0.0, 1.0);
}
)";
  return text;
}

const vk::raii::RenderPass& Device::Impl::render_pass(Output output, uint32_t attachments) {
  const std::pair which{output, attachments};
  if (const auto found = render_passes.find(which); found != render_passes.end()) return found->second;

  constexpr auto copied = vk::ImageLayout::eTransferSrcOptimal, read = vk::ImageLayout::eShaderReadOnlyOptimal;
  std::vector<ColorTarget> colors;
  switch (output) {
    case Output::buffer: break;
    case Output::visibility: colors = {{ids_format, read}}; break;
    case Output::color: colors = {{color_format, copied}}; break;
    case Output::layer: colors = {{color_format, copied, true}}; break;
    case Output::deep_layer: colors = {{color_format, copied, true}, {layer_depth_format, read, true}}; break;
    case Output::depth_copy: colors = {{layer_depth_format, read}}; break;
    case Output::words: colors.assign(attachments, {words_format, copied}); break;
    case Output::row:
    case Output::pixels: support::bug("a compute shader has no render pass");
  }
  auto made = make_render_pass(device, colors, output == Output::visibility);
  return render_passes.emplace(which, std::move(made)).first->second;
}

vk::raii::Pipeline Device::Impl::make_pipeline(const PipelineSource& source, std::span<const uint32_t> vertex,
                                               std::span<const uint32_t> fragment) {
  const bool rasterises = source.output != Output::buffer;
  const vk::raii::ShaderModule vertex_module = make_module(device, vertex);
  vk::raii::ShaderModule fragment_module{nullptr};
  std::vector<vk::PipelineShaderStageCreateInfo> stages{
      {.stage = vk::ShaderStageFlagBits::eVertex, .module = *vertex_module, .pName = "main"}};
  if (rasterises) {
    fragment_module = make_module(device, fragment);
    stages.push_back(
        {.stage = vk::ShaderStageFlagBits::eFragment, .module = *fragment_module, .pName = "main"});
  }

  const vk::PipelineVertexInputStateCreateInfo vertex_input{};
  const vk::PipelineInputAssemblyStateCreateInfo assembly{
      .topology = rasterises ? vk::PrimitiveTopology::eTriangleList : vk::PrimitiveTopology::ePointList};
  const vk::PipelineViewportStateCreateInfo view{.viewportCount = 1, .scissorCount = 1};
  const vk::PipelineRasterizationStateCreateInfo raster{.rasterizerDiscardEnable = !rasterises,
                                                        .polygonMode = vk::PolygonMode::eFill,
                                                        .cullMode = vk::CullModeFlagBits::eNone,
                                                        .lineWidth = 1};
  const vk::PipelineMultisampleStateCreateInfo samples{.rasterizationSamples = vk::SampleCountFlagBits::e1};
  const vk::Bool32 depth = source.output == Output::visibility;
  const vk::PipelineDepthStencilStateCreateInfo depth_test{
      .depthTestEnable = depth,
      .depthWriteEnable = depth,
      .depthCompareOp = source.over ? vk::CompareOp::eAlways : vk::CompareOp::eGreater};
  using Component = vk::ColorComponentFlagBits;
  const std::vector<vk::PipelineColorBlendAttachmentState> written(
      rasterises ? source.attachments : 0,
      {.colorWriteMask = Component::eR | Component::eG | Component::eB | Component::eA});
  const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = static_cast<uint32_t>(written.size()),
                                                    .pAttachments = written.data()};
  constexpr std::array by_call{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = static_cast<uint32_t>(by_call.size()),
                                                   .pDynamicStates = by_call.data()};

  return {device, pipeline_cache,
          vk::GraphicsPipelineCreateInfo{.stageCount = static_cast<uint32_t>(stages.size()),
                                         .pStages = stages.data(),
                                         .pVertexInputState = &vertex_input,
                                         .pInputAssemblyState = &assembly,
                                         .pViewportState = &view,
                                         .pRasterizationState = &raster,
                                         .pMultisampleState = &samples,
                                         .pDepthStencilState = &depth_test,
                                         .pColorBlendState = &blend,
                                         .pDynamicState = &dynamic,
                                         .layout = *layout,
                                         .renderPass = *render_pass(source.output, source.attachments)}};
}

vk::raii::Pipeline Device::Impl::make_pipeline(std::span<const uint32_t> compute) {
  const vk::raii::ShaderModule module = make_module(device, compute);
  return {device, pipeline_cache,
          vk::ComputePipelineCreateInfo{
              .stage = {.stage = vk::ShaderStageFlagBits::eCompute, .module = *module, .pName = "main"},
              .layout = *layout}};
}

void Device::Impl::open_pipeline_cache() {
  kept_pipelines = disk_cache.pipelines(identity);
  pipeline_cache = vk::raii::PipelineCache(
      device, {.initialDataSize = kept_pipelines.size(), .pInitialData = kept_pipelines.data()});
}

void Device::Impl::keep_pipelines() noexcept {
  constexpr size_t header_bytes = 16 + VK_UUID_SIZE;
  try {
    const std::vector<uint8_t> bytes = pipeline_cache.getData();
    const std::string_view data(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    // lavapipe gives the header alone.
    if (data.size() > header_bytes && data != kept_pipelines) disk_cache.keep_pipelines(data, identity);
  } catch (const std::exception&) {
    // The driver compiles again.
  }
}

double Device::build_seconds() const { return impl_->build_seconds; }

std::optional<PipelineIndex> Device::pipeline(const PipelineSource& source,
                                              support::Diagnostics& diagnostics) {
  const backends::Timed timed(impl_->build_seconds);
  std::string source_key = key(source);
  if (const auto found = impl_->pipeline_of.find(source_key); found != impl_->pipeline_of.end())
    return found->second;

  const DiskCache& disk = impl_->disk_cache;
  const bool computes = vulkan::computes(source.output);
  const auto first_kind = computes ? glsl::ShaderKind::compute : glsl::ShaderKind::vertex;
  const auto first = disk.spirv(source.vertex_glsl, first_kind, diagnostics, source.what);
  if (!first) return std::nullopt;
  std::optional<std::vector<uint32_t>> fragment{std::in_place};
  if (!computes && source.output != Output::buffer)
    fragment = disk.spirv(source.fragment_glsl, glsl::ShaderKind::fragment, diagnostics, source.what);
  if (!fragment) return std::nullopt;

  impl_->pipelines.push_back({source.output, computes ? impl_->make_pipeline(*first)
                                                      : impl_->make_pipeline(source, *first, *fragment)});
  const auto made = static_cast<PipelineIndex>(impl_->pipelines.size() - 1);
  impl_->pipeline_of.emplace(std::move(source_key), made);
  return made;
}

}  // namespace isoshade::vulkan
