// SPDX-License-Identifier: Apache-2.0
// A scene drawn with forward pairs on a Vulkan device, as a program would that knows of a pair only what its layout says. It is
// close to the contract's picture; how close is printed.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <unistd.h>

#include "backends/vulkan/instance.h"
#include "compiler/driver/forward.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/targets/targets.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

using namespace lower;
using emit::ForwardBlock;
using emit::ForwardLayout;
using emit::ForwardMember;

std::vector<uint32_t> spirv_of(const std::string& text, const char* stage) {
  const std::string stem = (std::filesystem::temp_directory_path() / ("isoshade-pair-" + std::to_string(getpid()))).string();
  const std::string source = stem + "." + stage, binary = stem + ".spv";
  std::ofstream(source) << text;
  EXPECT_EQ(std::system(("glslangValidator -V -o " + binary + " " + source + " >&2").c_str()), 0);
  std::ifstream file(binary, std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
  std::vector<uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), 4 * words.size());
  std::filesystem::remove(source);
  std::filesystem::remove(binary);
  return words;
}

/// Writes members of a block by their names.
class BlockWriter {
 public:
  BlockWriter(std::span<std::byte> bytes, std::span<const ForwardMember> members) : bytes_(bytes), members_(members) {}

  void write(const std::string& name, std::span<const float> values, int at = 0) {
    for (const ForwardMember& member : members_)
      if (member.name == name) std::memcpy(&bytes_[static_cast<size_t>(member.offset + at)], values.data(), values.size_bytes());
  }
  /// Four columns, of which `words` has three rows.
  void write_affine(const std::string& name, const float* words) {
    for (int column = 0; column < 4; ++column) {
      const float* from = words + 3 * column;
      write(name, std::array{from[0], from[1], from[2], column == 3 ? 1.0f : 0.0f}, 16 * column);
    }
  }
  /// All members, from the words of a record.
  void write_record(const float* words) {
    for (const ForwardMember& member : members_) {
      const int count = member.type.starts_with("vec") ? member.type[3] - '0' : 1;
      std::byte* to = &bytes_[static_cast<size_t>(member.offset)];
      const auto number = static_cast<int32_t>(*words);
      std::memcpy(to, member.type == "int" ? static_cast<const void*>(&number) : words, 4 * static_cast<size_t>(count));
      words += count;
    }
  }

 private:
  std::span<std::byte> bytes_;
  std::span<const ForwardMember> members_;
};

/// What a draw gives each block of its pair.
void fill(const ForwardLayout& layout, const ForwardLayout::Block& block, const render::Plan& plan,
          const backends::Draw& draw, std::span<std::byte> bytes) {
  const float* view = plan.frame.picture().words.data();
  const float* object = &plan.frame.objects[static_cast<size_t>(draw.object)];
  BlockWriter writer(bytes, block.members);
  switch (block.block) {
    case ForwardBlock::view:
      writer.write_affine("view_from_world", view + view_word::view);
      writer.write_affine("world_from_view", view + view_word::inverse_view);
      writer.write("clip_from_view", {view + view_word::projection, 16});
      writer.write("eye", {view + view_word::eye, 4});
      writer.write("pixel_size", {view + view_word::pixel_size, 2});
      writer.write("time", {&plan.frame.frame[frame_word::time], 1});
      break;
    case ForwardBlock::object:
      writer.write_affine("world_from_object", object + object_word::model);
      writer.write_affine("object_from_world", object + object_word::inverse);
      break;
    case ForwardBlock::parameters: writer.write_record(object + object_word::parameters); break;
    case ForwardBlock::lights:
      std::memcpy(bytes.data(), &plan.frame.light_count, 4);
      for (int i = 0; i < plan.frame.light_count; ++i) {
        const float* light = &plan.frame.lights[static_cast<size_t>(i * light_word::stride)];
        BlockWriter one(bytes.subspan(static_cast<size_t>(16 + i * layout.light_size)), layout.light);
#define LIGHT(name, words) one.write(#name, {light + light_word::name, words});
#include "compiler/interface/records.def"
      }
      break;
    case ForwardBlock::screen: break;
  }
}

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
  vk::raii::DescriptorSetLayout set{nullptr};
  vk::raii::PipelineLayout pipeline_layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

constexpr vk::Format color_format = vk::Format::eR32G32B32A32Sfloat, depth_format = vk::Format::eD32Sfloat;

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

  Pair pair(const driver::ForwardPair& made) {
    Pair pair;
    pair.layout = made.layout;
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (const ForwardLayout::Block& block : made.layout.blocks)
      bindings.push_back({.binding = static_cast<uint32_t>(block.binding),
                          .descriptorType = vk::DescriptorType::eUniformBuffer,
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
    size_t uniform_bytes = 0, index_count = 0, blocks = 0;
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
    }
    const Memory uniforms = memory(uniform_bytes, vk::BufferUsageFlagBits::eUniformBuffer);
    const Memory vertices = memory(4 * plan.frame.vertices.size(), vk::BufferUsageFlagBits::eVertexBuffer);
    const Memory indices = memory(4 * index_count, vk::BufferUsageFlagBits::eIndexBuffer);
    const Memory read = memory(size_t{16} * width_ * height_, vk::BufferUsageFlagBits::eTransferDst);
    std::memcpy(vertices.data, plan.frame.vertices.data(), 4 * plan.frame.vertices.size());

    const vk::DescriptorPoolSize size{vk::DescriptorType::eUniformBuffer, static_cast<uint32_t>(blocks)};
    const vk::raii::DescriptorPool pool(device_, {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                  .maxSets = static_cast<uint32_t>(draws.size()),
                                                  .poolSizeCount = 1,
                                                  .pPoolSizes = &size});
    std::vector<vk::raii::DescriptorSet> sets;
    const vk::raii::CommandBuffer commands =
        std::move(vk::raii::CommandBuffers(device_, {.commandPool = *pool_, .commandBufferCount = 1})[0]);
    commands.begin({});
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
    commands.end();
    const vk::CommandBuffer handle = *commands;
    queue_.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle});
    device_.waitIdle();
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

  Target target(vk::Format format, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect) {
    Target made;
    made.image = vk::raii::Image(device_, {.imageType = vk::ImageType::e2D,
                                           .format = format,
                                           .extent = {width_, height_, 1},
                                           .mipLevels = 1,
                                           .arrayLayers = 1,
                                           .usage = usage});
    made.memory = allocate(made.image.getMemoryRequirements(), {});
    made.image.bindMemory(*made.memory, 0);
    made.view = vk::raii::ImageView(device_, {.image = *made.image,
                                              .viewType = vk::ImageViewType::e2D,
                                              .format = format,
                                              .subresourceRange = {aspect, 0, 1, 0, 1}});
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
    const vk::PipelineRasterizationStateCreateInfo rasterization{.cullMode = vk::CullModeFlagBits::eNone, .lineWidth = 1};
    const vk::PipelineMultisampleStateCreateInfo samples{};
    const vk::PipelineDepthStencilStateCreateInfo depth{
        .depthTestEnable = true, .depthWriteEnable = true, .depthCompareOp = vk::CompareOp::eGreater};
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

/// The pairs of all effects of a plan, each with one pass, by their first pass.
std::map<const driver::EffectPass*, driver::ForwardPair> pairs_of(const render::Plan& plan) {
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  std::map<const driver::EffectPass*, driver::ForwardPair> pairs;
  for (const driver::Effect& effect : plan.effects) {
    const support::Source source = graph::read_source(ISOSHADE_GRAPHS "/" + effect.document, diagnostics);
    const auto shader = driver::compile_shader(source, options, {}, diagnostics);
    EXPECT_TRUE(shader && effect.passes.size() == 1) << diagnostics.text();
    pairs[&effect.passes[0]] = driver::forward_pairs(*shader, targets::get(emit::TargetId::glsl)).at(0);
  }
  return pairs;
}

/// Whether depth jumps around a pixel: there rounding may decide which surface it shows.
bool is_at_edge(const backends::Image& image, int x, int y) {
  float least = 1, most = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.width - 1); ++u) {
      const float depth = image.depth[static_cast<size_t>(v * image.width + u)];
      least = std::min(least, depth);
      most = std::max(most, depth);
    }
  return most > 1.02f * least;
}

TEST(ForwardPicture, OfMaterialBallsIsCloseToTheContracts) {
  constexpr int width = 1280, height = 720;
  const render::Plan plan = equivalence::plan(scene_path("material_balls"), width, height);
  const backends::Image expected = equivalence::draw(plan, *vulkan_backend());

  support::Diagnostics diagnostics;
  const vulkan::Instance instance;
  const int index = vulkan::choose(instance, "", diagnostics);
  ASSERT_GE(index, 0) << diagnostics.text();
  Renderer renderer(instance.devices[static_cast<size_t>(index)], width, height);
  std::map<const driver::EffectPass*, Pair> pairs;
  for (const auto& [pass, pair] : pairs_of(plan)) pairs.emplace(pass, renderer.pair(pair));
  std::vector<const Pair*> of_draws;
  for (const backends::Draw& draw : plan.frame.picture().draws)
    for (const render::RecordOrigin& origin : plan.origins)
      if (origin.record == draw.object) of_draws.push_back(&pairs.at(origin.pass));
  ASSERT_EQ(of_draws.size(), plan.frame.picture().draws.size());
  const std::vector<float> rgba = renderer.draw(plan, of_draws);

  double sum = 0, largest = 0, largest_inside = 0;
  size_t far = 0, pixels = rgba.size() / 4;
  for (size_t p = 0; p < pixels; ++p) {
    double of_pixel = 0;
    for (size_t c = 0; c < 3; ++c) {
      // Highlights reach 460: relative above 1.
      const double wanted = expected.rgba[4 * p + c];
      const double difference = std::abs(double{rgba[4 * p + c]} - wanted) / std::max(1.0, wanted);
      sum += difference;
      of_pixel = std::max(of_pixel, difference);
    }
    largest = std::max(largest, of_pixel);
    const auto place = static_cast<int>(p);
    if (!is_at_edge(expected, place % width, place / width)) largest_inside = std::max(largest_inside, of_pixel);
    far += of_pixel > 1.0 / 255;
  }
  const double mean = sum / (3.0 * static_cast<double>(pixels));
  std::printf(
      "difference to the contract's picture: mean %.3g, largest %.3g, away from edges %.3g; %zu of %zu pixels differ by more "
      "than 1/255\n",
      mean, largest, largest_inside, far, pixels);
  EXPECT_LT(mean, 1e-4);
  EXPECT_LT(largest_inside, 1e-2);
  EXPECT_LT(far, pixels / 1000);
  // Not an empty picture.
  size_t lit = 0;
  for (size_t p = 0; p < pixels; ++p) lit += rgba[4 * p] > 0.1f;
  EXPECT_GT(lit, pixels / 20);
}

}  // namespace
}  // namespace isoshade::equivalence
