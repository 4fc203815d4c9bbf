// SPDX-License-Identifier: Apache-2.0
// Recording and reading back: vertex kernels, the passes of a view, full-screen passes, tables.
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"

namespace isoshade::vulkan {

namespace {

constexpr size_t pixel_bytes = 4 * sizeof(float);
constexpr size_t depth_bytes = sizeof(float);

vk::Rect2D area(int width, int height) {
  return {.extent = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)}};
}

vk::Rect2D area(const Window& rect) {
  return {.offset = {rect.x, rect.y}, .extent = area(rect.width, rect.height).extent};
}

/// From pixels of a view to pixels of attachments that begin at (x, y).
Window moved(const Window& rect, int x, int y) { return {rect.x - x, rect.y - y, rect.width, rect.height}; }

/// Copies a rectangle of an image to an offset in a buffer.
void copy(const vk::raii::CommandBuffer& commands, const vk::raii::Image& image, vk::Format format,
          const Window& from, const Buffer& to, size_t offset) {
  const vk::ImageSubresourceRange range = whole(format);
  const vk::BufferImageCopy copy{
      .bufferOffset = offset,
      .imageSubresource = {.aspectMask = range.aspectMask, .layerCount = 1},
      .imageOffset = {from.x, from.y, 0},
      .imageExtent = {static_cast<uint32_t>(from.width), static_cast<uint32_t>(from.height), 1}};
  commands.copyImageToBuffer(*image, vk::ImageLayout::eTransferSrcOptimal, *to.buffer, copy);
}

/// Changes the layout of an image that nothing else uses meanwhile.
void change_layout(const vk::raii::CommandBuffer& commands, const vk::raii::Image& image, vk::Format format,
                   vk::ImageLayout from, vk::ImageLayout to) {
  constexpr auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
  const vk::ImageMemoryBarrier barrier{.srcAccessMask = any,
                                       .dstAccessMask = any,
                                       .oldLayout = from,
                                       .newLayout = to,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = *image,
                                       .subresourceRange = whole(format)};
  constexpr auto all = vk::PipelineStageFlagBits::eAllCommands;
  commands.pipelineBarrier(all, all, {}, {}, {}, barrier);
}

/// Copies the color of a rectangle, for shaders to read.
void copy_backdrop(const vk::raii::CommandBuffer& commands, const vk::raii::Image& color, const vk::raii::Image& backdrop,
                   const vk::Rect2D& rectangle) {
  using Layout = vk::ImageLayout;
  change_layout(commands, backdrop, color_format, Layout::eUndefined, Layout::eTransferDstOptimal);
  const vk::ImageSubresourceLayers layers{.aspectMask = vk::ImageAspectFlagBits::eColor, .layerCount = 1};
  const vk::Offset3D offset{rectangle.offset.x, rectangle.offset.y, 0};
  commands.copyImage(*color, Layout::eTransferSrcOptimal, *backdrop, Layout::eTransferDstOptimal,
                     vk::ImageCopy{.srcSubresource = layers,
                                   .srcOffset = offset,
                                   .dstSubresource = layers,
                                   .dstOffset = offset,
                                   .extent = {rectangle.extent.width, rectangle.extent.height, 1}});
  change_layout(commands, backdrop, color_format, Layout::eTransferDstOptimal, Layout::eShaderReadOnlyOptimal);
}

class PassEncoder {
 public:
  PassEncoder(const vk::raii::CommandBuffer& commands, const vk::raii::RenderPass& pass,
              const vk::raii::Framebuffer& framebuffer, const vk::Rect2D& whole_area,
              std::span<const vk::ClearValue> clear)
      : commands_(commands) {
    commands.beginRenderPass({.renderPass = *pass,
                              .framebuffer = *framebuffer,
                              .renderArea = whole_area,
                              .clearValueCount = static_cast<uint32_t>(clear.size()),
                              .pClearValues = clear.data()},
                             vk::SubpassContents::eInline);
  }
  ~PassEncoder() { commands_.endRenderPass(); }
  PassEncoder(const PassEncoder&) = delete;
  PassEncoder& operator=(const PassEncoder&) = delete;

 private:
  const vk::raii::CommandBuffer& commands_;
};

}  // namespace

void Device::run_vertices(std::span<const Call> calls, std::span<int32_t> output) {
  const bool own_memory = impl_->own_memory;
  impl_->reserve(impl_->output, output.size_bytes(), own_memory ? BufferUse::device : BufferUse::shared);
  if (own_memory) impl_->reserve(impl_->readback, output.size_bytes(), BufferUse::readback);
  const vk::raii::CommandBuffer& commands = impl_->begin();
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::vertices);
    if (!calls.empty() && vulkan::computes(impl_->pipelines[calls.front().pipeline].output)) {
      for (const Call& call : calls) impl_->record(call);
      impl_->wait_for_all();
    } else {
      const PassEncoder pass(commands, impl_->render_pass(Output::buffer, 0), impl_->no_target, area(1, 1),
                             {});
      for (const Call& call : calls) impl_->record(call);
    }
  }
  if (own_memory) {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
    commands.copyBuffer(*impl_->output.buffer, *impl_->readback.buffer, vk::BufferCopy{.size = output.size_bytes()});
  }
  impl_->finish();
  std::memcpy(output.data(), own_memory ? impl_->readback.data : impl_->output.data, output.size_bytes());
}

void Device::Impl::record_at(std::span<const Call> calls, int x, int y) {
  for (Call call : calls) {
    call.push.origin_x = x;
    call.push.origin_y = y;
    record(call);
  }
}

void Device::Impl::draw_group(const LayerGroup& group, const Attachment& depth, int x, int y) {
  const LayerAttachments& made = attachments.layers;
  const vk::Rect2D group_area = area(moved(group.area, x, y));
  const Attachment* const ids[] = {&made.ids, &attachments.ids};
  const auto images = [&](size_t turn) {
    return ImagesRead{*ids[turn]->view, *ids[1 - turn]->view, *depth.view, *made.backdrop.view};
  };
  const auto draw_layer = [&](uint32_t number, uint32_t query) {
    const size_t turn = number % 2;
    read(images(turn));
    // The first layer begins with the first triangle, a later one in each pixel after that of the layer before.
    std::vector<Call> visibility = group.visibility;
    for (Call& call : visibility) call.push.first = number == 0 ? static_cast<int32_t>(group.first) : -1;
    {
      const std::array<vk::ClearValue, 2> nothing{};
      const PassEncoder pass(commands, render_pass(Output::visibility, 1), made.visibility[turn], group_area, nothing);
      commands.beginQuery(*samples_passed, query, {});
      record_at(visibility, x, y);
      commands.endQuery(*samples_passed, query);
    }
    copy_backdrop(commands, attachments.color.image, made.backdrop.image, group_area);
    const bool deep = group.writes_depth;
    const PassEncoder pass(commands, render_pass(deep ? Output::deep_layer : Output::layer, deep ? 2 : 1),
                           deep ? made.deep_blending : made.blending, group_area, {});
    record_at(group.blending, x, y);
  };
  // A device with memory of its own waits for the host longer than it takes for a layer that shows nothing.
  const uint32_t at_once = own_memory ? max_layers_at_once : 1;
  for (uint32_t number = 0; number < group.count;) {
    const uint32_t end = std::min(number + at_once, group.count);
    {
      const TimedStep step(*this, &DeviceSeconds::layers);
      commands.resetQueryPool(*samples_passed, 0, end - number);
      for (uint32_t layer = number; layer < end; ++layer) draw_layer(layer, layer - number);
    }
    finish();
    const auto [result, passed] = samples_passed.getResult<uint64_t>(
        end - number - 1, 1, sizeof(uint64_t), vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess) throw std::runtime_error("the device did not count the pixels of a layer");
    begin(images(end % 2));
    if (passed == 0) return;
    number = end;
  }
}

Device::Impl::DrawnView Device::Impl::record_view(std::span<const Call> visibility, std::span<const Call> color,
                                                  const Layers& layers, const float (&background)[4],
                                                  const Window& window, bool has_color) {
  const int margin = window.x > 0 || window.y > 0 ? margin_of_windows : 0;
  const int origin_x = window.x - margin, origin_y = window.y - margin;
  const bool has_layers = !layers.groups.empty();
  prepare_attachments(window.width + margin, window.height + margin, has_color, has_layers);
  const vk::Rect2D all = area(attachments.width, attachments.height);

  const bool deep = layers.copy_depth.has_value();
  const DrawnView drawn{deep ? &attachments.layers.depth : &attachments.depth, deep ? layer_depth_format : depth_format,
                        margin};
  const vk::ImageView ids = *attachments.ids.view;
  begin({ids, ids, has_layers ? *attachments.depth.view : ids, ids});
  {
    const TimedStep step(*this, &DeviceSeconds::visibility);
    const std::array<vk::ClearValue, 2> nothing{};
    const PassEncoder pass(commands, render_pass(Output::visibility, 1), attachments.visibility, all, nothing);
    record_at(visibility, origin_x, origin_y);
  }
  if (has_color) {
    const TimedStep step(*this, &DeviceSeconds::shading);
    const vk::ClearValue backdrop{
        vk::ClearColorValue{std::array{background[0], background[1], background[2], background[3]}}};
    const PassEncoder pass(commands, render_pass(Output::color, 1), attachments.shading, all, {&backdrop, 1});
    record_at(color, origin_x, origin_y);
  }
  if (!has_layers) return drawn;
  change_layout(commands, attachments.depth.image, depth_format, vk::ImageLayout::eTransferSrcOptimal,
                vk::ImageLayout::eShaderReadOnlyOptimal);
  if (deep) {
    const vk::ClearValue nothing{};
    const PassEncoder pass(commands, render_pass(Output::depth_copy, 1), attachments.layers.depth_copying, all,
                           {&nothing, 1});
    record_at({&*layers.copy_depth, 1}, origin_x, origin_y);
  }
  for (const LayerGroup& group : layers.groups) draw_group(group, *drawn.depth, origin_x, origin_y);
  change_layout(commands, drawn.depth->image, drawn.depth_format, vk::ImageLayout::eShaderReadOnlyOptimal,
                vk::ImageLayout::eTransferSrcOptimal);
  return drawn;
}

void Device::render(std::span<const Call> visibility, std::span<const Call> color, const Layers& layers,
                    const float (&background)[4], const Window& window, backends::Image& image) {
  const int width = window.width, height = window.height;
  const bool has_color = !image.rgba.empty();
  const size_t row_bytes = static_cast<size_t>(width) * ((has_color ? pixel_bytes : 0) + depth_bytes);
  const int band =
      static_cast<int>(std::clamp<size_t>(max_readback_bytes / row_bytes, 1, static_cast<size_t>(height)));
  const size_t depth_at =
      has_color ? static_cast<size_t>(band) * static_cast<size_t>(width) * pixel_bytes : 0;
  impl_->reserve(impl_->readback, static_cast<size_t>(band) * row_bytes, BufferUse::readback);
  const auto drawn = impl_->record_view(visibility, color, layers, background, window, has_color);
  for (int first = 0; first < height; first += band) {
    const int rows = std::min(band, height - first);
    if (first > 0) impl_->begin();
    {
      const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
      const Window lines{drawn.margin, drawn.margin + first, width, rows};
      if (has_color)
        copy(impl_->commands, impl_->attachments.color.image, color_format, lines, impl_->readback, 0);
      copy(impl_->commands, drawn.depth->image, drawn.depth_format, lines, impl_->readback, depth_at);
    }
    impl_->finish();
    const size_t pixel = static_cast<size_t>(first) * static_cast<size_t>(width);
    const size_t pixels = static_cast<size_t>(rows) * static_cast<size_t>(width);
    const char* data = static_cast<const char*>(impl_->readback.data);
    if (has_color) std::memcpy(image.rgba.data() + 4 * pixel, data, pixels * pixel_bytes);
    std::memcpy(image.depth.data() + pixel, data + depth_at, pixels * depth_bytes);
  }
}

bool Device::render(std::span<const Call> visibility, std::span<const Call> color, const Layers& layers,
                    const float (&background)[4], const Window& window, bool has_color, const Places& places) {
  impl_->reserve_check();
  const auto drawn = impl_->record_view(visibility, color, layers, background, window, has_color);
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
    const Window lines{drawn.margin, drawn.margin, window.width, window.height};
    impl_->wait_for_all();
    copy(impl_->commands, drawn.depth->image, drawn.depth_format, lines, impl_->layers().buffer, places.depth);
    if (has_color)
      copy(impl_->commands, impl_->attachments.color.image, color_format, lines, impl_->layers().buffer, places.color);
  }
  if (!has_color) {
    impl_->finish();
    return true;
  }
  const size_t floats = size_t{4} * static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
  return impl_->finish_with_check(places.color / sizeof(float), floats);
}

bool Device::run_screen(PipelineIndex pipeline, int width, int height, size_t place) {
  const bool computes = vulkan::computes(impl_->pipelines[pipeline].output);
  if (!computes) impl_->prepare_attachments(width, height, true);
  impl_->reserve_check();
  const vk::raii::CommandBuffer& commands = impl_->begin();
  if (computes) {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::screen);
    impl_->compute({.pipeline = pipeline,
                    .push = {.place = static_cast<int32_t>(place / sizeof(float)), .pitch = width},
                    .scissor = {0, 0, width, height}});
  } else {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::screen);
    const vk::ClearValue nothing{};
    const PassEncoder pass(commands, impl_->render_pass(Output::color, 1), impl_->attachments.shading,
                           area(width, height), {&nothing, 1});
    impl_->record({.pipeline = pipeline, .scissor = {0, 0, width, height}});
  }
  if (!computes) {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
    impl_->wait_for_all();
    copy(commands, impl_->attachments.color.image, color_format, {0, 0, width, height}, impl_->layers().buffer, place);
  }
  return impl_->finish_with_check(place / sizeof(float), size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height));
}

void Device::run_screen(PipelineIndex pipeline, int width, int height, int first_row, std::span<float> rgba) {
  impl_->prepare_attachments(width, height, true);
  const WindowAttachments& attachments = impl_->attachments;
  const size_t row_bytes = static_cast<size_t>(width) * pixel_bytes;
  const int band =
      static_cast<int>(std::clamp<size_t>(max_readback_bytes / row_bytes, 1, static_cast<size_t>(height)));
  impl_->reserve(impl_->readback, static_cast<size_t>(band) * row_bytes, BufferUse::readback);
  const Call call{
      .pipeline = pipeline, .push = {.origin_y = first_row}, .scissor = {0, first_row, width, height}};
  for (int first = 0; first < height; first += band) {
    const int rows = std::min(band, height - first);
    const vk::raii::CommandBuffer& commands = impl_->begin();
    if (first == 0) {
      const Impl::TimedStep step(*impl_, &DeviceSeconds::screen);
      const vk::ClearValue nothing{};
      const PassEncoder pass(commands, impl_->render_pass(Output::color, 1), attachments.shading,
                             area(width, height), {&nothing, 1});
      impl_->record(call);
    }
    {
      const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
      copy(commands, attachments.color.image, color_format, {0, first, width, rows}, impl_->readback, 0);
    }
    impl_->finish();
    std::memcpy(rgba.data() + static_cast<size_t>(first) * static_cast<size_t>(width) * 4,
                impl_->readback.data, static_cast<size_t>(rows) * row_bytes);
  }
}

void Device::run_table(PipelineIndex pipeline, uint32_t attachments, size_t rows, size_t record_words,
                       std::span<int32_t> output) {
  support::assert_that(rows > 0 && rows <= max_table_rows && output.size() == rows * record_words,
                 "a table chunk of a wrong size");
  const int height = static_cast<int>((rows + table_width - 1) / table_width);
  const TableAttachments& table = impl_->prepare_table(attachments, height);
  const size_t attachment_bytes = static_cast<size_t>(height) * table_width * pixel_bytes;
  impl_->reserve(impl_->readback, attachments * attachment_bytes, BufferUse::readback);

  Call call{.pipeline = pipeline, .scissor = {0, 0, table_width, height}};
  call.push.count = static_cast<int32_t>(rows);
  call.push.width = table_width;
  const vk::raii::CommandBuffer& commands = impl_->begin();
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::tables);
    const std::vector<vk::ClearValue> nothing(attachments, vk::ClearValue{});
    const PassEncoder pass(commands, impl_->render_pass(Output::words, attachments), table.framebuffer,
                           area(table_width, height), nothing);
    impl_->record(call);
  }
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::copies);
    for (uint32_t i = 0; i < attachments; ++i)
      copy(commands, table.attachments[i].image, words_format, {0, 0, table_width, height}, impl_->readback,
           i * attachment_bytes);
  }
  impl_->finish();

  const char* data = static_cast<const char*>(impl_->readback.data);
  for (size_t word = 0; word < record_words; word += 4) {
    const size_t words = std::min<size_t>(4, record_words - word);
    const char* from = data + word / 4 * attachment_bytes;
    for (size_t row = 0; row < rows; ++row)
      std::memcpy(output.data() + row * record_words + word, from + row * pixel_bytes,
                  words * sizeof(int32_t));
  }
}

}  // namespace isoshade::vulkan
