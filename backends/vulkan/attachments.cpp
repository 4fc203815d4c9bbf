// SPDX-License-Identifier: Apache-2.0
// The images that passes draw into, with their framebuffers; they are kept for the next frame of the same size.
#include <algorithm>
#include <array>
#include <utility>

#include "backends/vulkan/device_impl.h"

namespace isoshade::vulkan {

vk::raii::Framebuffer Device::Impl::make_framebuffer(Output output, std::span<const vk::ImageView> views, int width,
                                                     int height) {
  const uint32_t colors = output == Output::deep_layer ? 2 : 1;
  return {device, vk::FramebufferCreateInfo{.renderPass = *render_pass(output, colors),
                                            .attachmentCount = static_cast<uint32_t>(views.size()),
                                            .pAttachments = views.data(),
                                            .width = static_cast<uint32_t>(width),
                                            .height = static_cast<uint32_t>(height),
                                            .layers = 1}};
}

void Device::Impl::prepare_attachments(int width, int height, bool has_color, bool has_layers) {
  const auto fits = [&](const WindowAttachments& made) {
    return made.width == width && made.height == height && (made.has_color || !has_color) &&
           (made.has_layers || !has_layers);
  };
  if (fits(attachments)) return;
  const auto is_of_size = [&](const WindowAttachments& made) { return made.width == width && made.height == height; };
  if (attachments.width > 0 && !is_of_size(attachments)) other_attachments.push_front(std::exchange(attachments, {}));
  const auto found = std::ranges::find_if(other_attachments, is_of_size);
  if (found != other_attachments.end()) {
    attachments = std::move(*found);
    other_attachments.erase(found);
    if (fits(attachments)) return;
  }
  if (other_attachments.size() > max_other_attachments) other_attachments.pop_back();
  const bool had_color = attachments.has_color, had_layers = attachments.has_layers;
  try {
    make_attachments(width, height, has_color || had_color, has_layers || had_layers);
  } catch (const vk::OutOfDeviceMemoryError&) {
    if (other_attachments.empty()) throw;
    other_attachments.clear();
    make_attachments(width, height, has_color, has_layers);
  }
}

void Device::Impl::make_attachments(int width, int height, bool has_color, bool has_layers) {
  using Usage = vk::ImageUsageFlagBits;
  WindowAttachments& made = attachments;
  made = {};  // first, because both might not fit
  made.ids = make_attachment(ids_format, width, height, Usage::eSampled);
  made.depth = make_attachment(depth_format, width, height,
                               has_layers ? Usage::eTransferSrc | Usage::eSampled : Usage::eTransferSrc);
  made.visibility =
      make_framebuffer(Output::visibility, std::array{*made.ids.view, *made.depth.view}, width, height);
  if (has_color) {
    made.color = make_attachment(color_format, width, height, Usage::eTransferSrc);
    made.shading = make_framebuffer(Output::color, std::array{*made.color.view}, width, height);
  }
  made.has_color = has_color;
  made.has_layers = has_layers;
  made.width = width;
  made.height = height;
  if (has_layers) prepare_layers();
}

void Device::Impl::prepare_layers() {
  using Usage = vk::ImageUsageFlagBits;
  const int width = attachments.width, height = attachments.height;
  LayerAttachments& made = attachments.layers;
  made.ids = make_attachment(ids_format, width, height, Usage::eSampled);
  made.order = make_attachment(depth_format, width, height, Usage::eTransferSrc);  // as its render pass leaves it
  made.backdrop = make_attachment(color_format, width, height, Usage::eSampled | Usage::eTransferDst);
  made.depth = make_attachment(layer_depth_format, width, height, Usage::eSampled | Usage::eTransferSrc);
  const Attachment* const ids[] = {&made.ids, &attachments.ids};
  for (size_t i = 0; i < 2; ++i)
    made.visibility[i] =
        make_framebuffer(Output::visibility, std::array{*ids[i]->view, *made.order.view}, width, height);
  const vk::ImageView color = *attachments.color.view, depth = *made.depth.view;
  made.blending = make_framebuffer(Output::layer, std::array{color}, width, height);
  made.deep_blending = make_framebuffer(Output::deep_layer, std::array{color, depth}, width, height);
  made.depth_copying = make_framebuffer(Output::depth_copy, std::array{depth}, width, height);
}

TableAttachments& Device::Impl::prepare_table(uint32_t attachments, int height) {
  TableAttachments& table = tables[attachments];
  if (table.height >= height) return table;
  table = {};
  std::vector<vk::ImageView> views;
  for (uint32_t i = 0; i < attachments; ++i) {
    table.attachments.push_back(
        make_attachment(words_format, table_width, height, vk::ImageUsageFlagBits::eTransferSrc));
    views.push_back(*table.attachments.back().view);
  }
  table.framebuffer = vk::raii::Framebuffer(device, {.renderPass = *render_pass(Output::words, attachments),
                                                     .attachmentCount = attachments,
                                                     .pAttachments = views.data(),
                                                     .width = table_width,
                                                     .height = static_cast<uint32_t>(height),
                                                     .layers = 1});
  table.height = height;
  return table;
}

}  // namespace isoshade::vulkan
