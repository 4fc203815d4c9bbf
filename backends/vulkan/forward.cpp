// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/forward.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <tuple>
#include <utility>

#include "backends/vulkan/forward_blocks.h"
#include "backends/vulkan/forward_device.h"
#include "backends/vulkan/forward_pipeline.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"

namespace isoshade::vulkan {

using emit::ForwardBlock;
using emit::ForwardLayout;
using forward::color_format;
using forward::depth_format;
using forward::Memory;
using forward::Pipeline;
using forward::State;
using forward::Target;
using support::Diagnostics;
using namespace lower;

namespace {

/// A block of a draw or a post in the buffer of uniforms.
struct Filled {
  const ForwardLayout* layout;
  const ForwardLayout::Block* block;
  size_t offset;
  ForwardSource source;
};

/// The number of the texture that a record gives an image; -1: none.
int texture_of(const ForwardLayout& layout, const std::string& image, const float* record) {
  const auto block = std::ranges::find(layout.blocks, ForwardBlock::parameters, &ForwardLayout::Block::block);
  if (block == layout.blocks.end()) return -1;
  for (const emit::ForwardMember& member : block->members) {
    if (member.name == image) return static_cast<int>(*record);
    record += words_of(member);
  }
  return -1;
}

}  // namespace

class ForwardRenderer::Impl {
 public:
  Impl(const ForwardScene& scene, const std::string& selector, glsl::Contract contract, Diagnostics& diagnostics)
      : scene_(scene), frame_(*scene.frame), contract_(contract) {
    const int index = choose(instance_, selector, diagnostics);
    if (index >= 0) device_.emplace(instance_.devices[static_cast<size_t>(index)]);
  }

  bool has_device() const { return device_.has_value(); }

  bool prepare(Diagnostics& diagnostics) {
    make_targets();
    upload_mesh();
    for (size_t d = 0; d < draws().size(); ++d) {
      const backends::Draw& draw = draws()[d];
      const State state(draw.state.cull, draw.mirrored, draw.state.depth);
      if (!add(*scene_.shaders[d], state, diagnostics)) return false;
    }
    for (const ForwardPost& post : scene_.posts)
      if (!add(*post.shader, std::nullopt, diagnostics)) return false;
    make_sets();
    return true;
  }

  void draw() {
    for (const Filled& filled : filled_)
      fill(*filled.layout, *filled.block, filled.source,
           {uniforms_.data + filled.offset, static_cast<size_t>(filled.block->size)});
    const vk::raii::CommandBuffer commands = device_->begin();
    draw_objects(commands);
    for (size_t p = 0; p < scene_.posts.size(); ++p) draw_post(commands, p);
    device_->submit(commands);
  }

  void read(backends::Image& image) {
    const auto [width, height] = size_of(scene_.result);
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    image.rgba.resize(size_t{4} * width * height);
    image.depth.clear();
    const Memory read = device_->memory(4 * image.rgba.size(), vk::BufferUsageFlagBits::eTransferDst);
    const Target& result = colors_[static_cast<size_t>(scene_.result)];
    const vk::raii::CommandBuffer commands = device_->begin();
    change(commands, result, vk::ImageLayout::eShaderReadOnlyOptimal, vk::ImageLayout::eTransferSrcOptimal);
    commands.copyImageToBuffer(*result.image, vk::ImageLayout::eTransferSrcOptimal, *read.buffer,
                               vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                                   .imageExtent = {width, height, 1}});
    change(commands, result, vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    device_->submit(commands);
    std::memcpy(image.rgba.data(), read.data, 4 * image.rgba.size());
  }

  bool report(const std::string& what, Diagnostics& diagnostics) const {
    diagnostics.report(support::Id::device_failed, what);
    return false;
  }
  /// Reports what the validation layers said; whether that was nothing.
  bool is_valid(Diagnostics& diagnostics) {
    const std::vector<std::string> messages = instance_.messages->take();
    for (const std::string& message : messages) diagnostics.report(support::Id::validation, support::visible(message));
    return messages.empty();
  }

 private:
  const std::vector<backends::Draw>& draws() const { return frame_.picture().draws; }
  std::pair<uint32_t, uint32_t> size_of(int image) const {
    const backends::Target& target = frame_.picture().target;
    const auto [width, height] = image == 0 ? std::pair(target.width, target.height)
                                            : std::pair(scene_.posts[static_cast<size_t>(image) - 1].width,
                                                        scene_.posts[static_cast<size_t>(image) - 1].height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  }

  void make_targets() {
    object_pass_ = forward::render_pass(*device_, true);
    post_pass_ = forward::render_pass(*device_, false);
    const auto [w, h] = size_of(0);
    depth_ = device_->target(depth_format, vk::ImageUsageFlagBits::eDepthStencilAttachment | vk::ImageUsageFlagBits::eSampled,
                             {w, h, 1});
    for (size_t i = 0; i <= scene_.posts.size(); ++i) {
      const auto [width, height] = size_of(static_cast<int>(i));
      colors_.push_back(device_->target(color_format,
                                        vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eSampled |
                                            vk::ImageUsageFlagBits::eTransferSrc,
                                        {width, height, 1}));
      const std::array views{*colors_[i].view, *depth_.view};
      framebuffers_.emplace_back(**device_, vk::FramebufferCreateInfo{.renderPass = i == 0 ? *object_pass_ : *post_pass_,
                                                                      .attachmentCount = i == 0 ? 2u : 1u,
                                                                      .pAttachments = views.data(),
                                                                      .width = width,
                                                                      .height = height,
                                                                      .layers = 1});
    }
  }

  void upload_mesh() {
    size_t count = 0;
    for (const backends::Draw& draw : draws()) count += draw.indices.size();
    vertices_ = device_->memory(4 * frame_.vertices.size(), vk::BufferUsageFlagBits::eVertexBuffer);
    indices_ = device_->memory(4 * count, vk::BufferUsageFlagBits::eIndexBuffer);
    std::memcpy(vertices_.data, frame_.vertices.data(), 4 * frame_.vertices.size());
    std::byte* to = indices_.data;
    for (const backends::Draw& draw : draws()) {
      std::memcpy(to, draw.indices.data(), draw.indices.size_bytes());
      to += draw.indices.size_bytes();
    }
  }

  /// Adds what the next draw or post is drawn with. A post has no state.
  bool add(const ForwardShader& shader, const std::optional<State>& state, Diagnostics& diagnostics) {
    const auto [found, is_new] = pipelines_.try_emplace({&shader, state});
    if (is_new) {
      auto made = forward::pipeline(*device_, shader.pair, state, state ? object_pass_ : post_pass_, contract_, diagnostics);
      if (!made) return false;
      found->second = *std::move(made);
    }
    used_.push_back(&found->second);
    return true;
  }

  /// Of all draws, then of all posts.
  template <class Visit>
  void for_each_shader(const Visit& visit) const {
    for (size_t d = 0; d < draws().size(); ++d) {
      const float* object = &frame_.objects[static_cast<size_t>(draws()[d].object)];
      const size_t words = frame_.objects.size() - static_cast<size_t>(draws()[d].object);
      const std::span<const float> record = std::span(object, words).subspan(object_word::parameters);
      visit(*scene_.shaders[d], ForwardSource{frame_, record, &draws()[d]}, nullptr);
    }
    for (const ForwardPost& post : scene_.posts)
      visit(*post.shader, ForwardSource{frame_, post.record, nullptr, post.width, post.height}, &post);
  }

  /// Places the blocks in one buffer, and makes a set for each draw and post.
  void make_sets() {
    const size_t alignment = device_->uniform_alignment();
    size_t bytes = 0;
    uint32_t samplers = 0;
    for_each_shader([&](const ForwardShader& shader, const ForwardSource& source, const ForwardPost*) {
      const ForwardLayout& layout = shader.pair.layout;
      for (const ForwardLayout::Block& block : layout.blocks) {
        const size_t at = (bytes + alignment - 1) / alignment * alignment;
        filled_.push_back({&layout, &block, at, source});
        bytes = at + static_cast<size_t>(block.size);
      }
      samplers += static_cast<uint32_t>(layout.samplers.size());
    });
    uniforms_ = device_->memory(bytes, vk::BufferUsageFlagBits::eUniformBuffer);
    const std::array sizes{
        vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, static_cast<uint32_t>(filled_.size() + 1)},
        vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, samplers + 1}};
    descriptors_ = vk::raii::DescriptorPool(**device_, {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                        .maxSets = static_cast<uint32_t>(used_.size() + 1),
                                                        .poolSizeCount = 2,
                                                        .pPoolSizes = sizes.data()});
    auto block = filled_.begin();
    for_each_shader([&](const ForwardShader& shader, const ForwardSource& source, const ForwardPost* post) {
      const ForwardLayout& layout = shader.pair.layout;
      const vk::DescriptorSetLayout set_layout = *used_[sets_.size()]->set;
      sets_.push_back(std::move(vk::raii::DescriptorSets(
          **device_, {.descriptorPool = *descriptors_, .descriptorSetCount = 1, .pSetLayouts = &set_layout})[0]));
      for (size_t b = 0; b < layout.blocks.size(); ++b) bind_block(*block++);
      for (size_t i = 0; i < layout.samplers.size(); ++i) bind_image(shader, i, source, post);
    });
  }

  void bind_block(const Filled& filled) {
    const vk::DescriptorBufferInfo info{*uniforms_.buffer, filled.offset, static_cast<size_t>(filled.block->size)};
    (*device_)->updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *sets_.back(),
                                                            .dstBinding = static_cast<uint32_t>(filled.block->binding),
                                                            .descriptorCount = 1,
                                                            .descriptorType = vk::DescriptorType::eUniformBuffer,
                                                            .pBufferInfo = &info},
                                     nullptr);
  }

  void bind_image(const ForwardShader& shader, size_t number, const ForwardSource& source, const ForwardPost* post) {
    const ForwardLayout& layout = shader.pair.layout;
    const ForwardLayout::Sampler& sampler = layout.samplers[number];
    const lower::Sampling fetched{nodes::Filter::closest, nodes::AddressMode::clamp, nodes::AddressMode::clamp};
    vk::DescriptorImageInfo info{*sampler_of(number < shader.samplings.size() ? shader.samplings[number] : fetched), {},
                                 vk::ImageLayout::eShaderReadOnlyOptimal};
    if (post != nullptr && sampler.image == "depth") {
      info.imageView = *depth_.view;
      info.imageLayout = vk::ImageLayout::eDepthStencilReadOnlyOptimal;
    } else if (post != nullptr && std::ranges::all_of(sampler.image, [](char c) { return c >= '0' && c <= '9'; })) {
      const int image = post->sources.at(std::stoul(sampler.image));
      info.imageView = image < 0 ? *texture(-1).view : *colors_[static_cast<size_t>(image)].view;
    } else {
      info.imageView = *texture(texture_of(layout, sampler.image, source.parameters.data())).view;
    }
    (*device_)->updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *sets_.back(),
                                                            .dstBinding = static_cast<uint32_t>(sampler.binding),
                                                            .descriptorCount = 1,
                                                            .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                                            .pImageInfo = &info},
                                     nullptr);
  }

  const vk::raii::Sampler& sampler_of(const lower::Sampling& sampling) {
    const auto [found, is_new] = samplers_.try_emplace({sampling.filter, sampling.u, sampling.v}, nullptr);
    if (is_new) found->second = forward::sampler(*device_, sampling);
    return found->second;
  }

  const Target& texture(int number) {
    const auto found = textures_.find(number);
    return found != textures_.end() ? found->second : textures_.emplace(number, device_->texture(frame_, number)).first->second;
  }

  void begin_pass(const vk::raii::CommandBuffer& commands, const vk::raii::RenderPass& pass, size_t image) {
    const auto [width, height] = size_of(static_cast<int>(image));
    std::array<vk::ClearValue, 2> clear;
    std::memcpy(&clear[0], frame_.picture().background, 16);
    clear[1].depthStencil = vk::ClearDepthStencilValue{0, 0};
    commands.beginRenderPass({.renderPass = *pass,
                              .framebuffer = *framebuffers_[image],
                              .renderArea = {{0, 0}, {width, height}},
                              .clearValueCount = 2,
                              .pClearValues = clear.data()},
                             vk::SubpassContents::eInline);
    // Clip space is y up, and the picture y down. A post computes its pixel's place itself.
    const auto w = static_cast<float>(width), h = static_cast<float>(height);
    commands.setViewport(0, image == 0 ? vk::Viewport{0, h, w, -h, 0, 1} : vk::Viewport{0, 0, w, h, 0, 1});
    commands.setScissor(0, vk::Rect2D{{0, 0}, {width, height}});
  }

  void bind(const vk::raii::CommandBuffer& commands, size_t use) {
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *used_[use]->pipeline);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *used_[use]->layout, 0, *sets_[use], nullptr);
  }

  void draw_objects(const vk::raii::CommandBuffer& commands) {
    begin_pass(commands, object_pass_, 0);
    commands.bindVertexBuffers(0, *vertices_.buffer, {0});
    commands.bindIndexBuffer(*indices_.buffer, 0, vk::IndexType::eUint32);
    uint32_t first_index = 0;
    for (size_t d = 0; d < draws().size(); ++d) {
      const auto count = static_cast<uint32_t>(draws()[d].indices.size());
      bind(commands, d);
      commands.drawIndexed(count, 1, first_index, static_cast<int32_t>(draws()[d].first_vertex), 0);
      first_index += count;
    }
    commands.endRenderPass();
  }

  void draw_post(const vk::raii::CommandBuffer& commands, size_t post) {
    begin_pass(commands, post_pass_, 1 + post);
    bind(commands, draws().size() + post);
    commands.draw(3, 1, 0, 0);
    commands.endRenderPass();
  }

  const ForwardScene& scene_;
  const backends::Frame& frame_;
  glsl::Contract contract_;
  Instance instance_;
  std::optional<forward::Device> device_;
  vk::raii::RenderPass object_pass_{nullptr}, post_pass_{nullptr};
  std::map<std::tuple<nodes::Filter, nodes::AddressMode, nodes::AddressMode>, vk::raii::Sampler> samplers_;
  Target depth_;
  std::vector<Target> colors_;  ///< of the objects, then of each post
  std::vector<vk::raii::Framebuffer> framebuffers_;
  std::map<int, Target> textures_;  ///< by their numbers in the frame
  Memory vertices_, indices_, uniforms_;
  std::map<std::pair<const ForwardShader*, std::optional<State>>, Pipeline> pipelines_;
  std::vector<const Pipeline*> used_;  ///< by the draws, then by the posts
  std::vector<Filled> filled_;
  vk::raii::DescriptorPool descriptors_{nullptr};
  std::vector<vk::raii::DescriptorSet> sets_;
};

ForwardRenderer::ForwardRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ForwardRenderer::~ForwardRenderer() = default;

std::unique_ptr<ForwardRenderer> ForwardRenderer::create(const ForwardScene& scene, const std::string& device,
                                                         glsl::Contract contract, Diagnostics& diagnostics) {
  try {
    auto impl = std::make_unique<Impl>(scene, device, contract, diagnostics);
    if (!impl->has_device() || !impl->prepare(diagnostics) || !impl->is_valid(diagnostics)) return nullptr;
    return std::unique_ptr<ForwardRenderer>(new ForwardRenderer(std::move(impl)));
  } catch (const std::exception& error) {
    report_unusable(error.what(), diagnostics);
    return nullptr;
  }
}

bool ForwardRenderer::draw(Diagnostics& diagnostics) {
  try {
    impl_->draw();
    return impl_->is_valid(diagnostics);
  } catch (const std::exception& error) {
    return impl_->report(error.what(), diagnostics);
  }
}

bool ForwardRenderer::read(backends::Image& image, Diagnostics& diagnostics) {
  try {
    impl_->read(image);
    return impl_->is_valid(diagnostics);
  } catch (const std::exception& error) {
    return impl_->report(error.what(), diagnostics);
  }
}

}  // namespace isoshade::vulkan
