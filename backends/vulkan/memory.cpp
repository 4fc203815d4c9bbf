// SPDX-License-Identifier: Apache-2.0
// The memory of arrays and attachments, and how arrays reach the device.
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "backends/vulkan/device_impl.h"

namespace isoshade::vulkan {

namespace {

using Memory = vk::MemoryPropertyFlagBits;

constexpr vk::MemoryPropertyFlags mapped = Memory::eHostVisible | Memory::eHostCoherent;

/// Uploads are compared with what the device has in blocks of this size.
constexpr size_t block_bytes = size_t{64} << 10;

struct Kind {
  vk::BufferUsageFlags usage;
  vk::MemoryPropertyFlags required, preferred;
};

Kind kind_of(BufferUse use) {
  using Usage = vk::BufferUsageFlagBits;
  switch (use) {
    case BufferUse::shared:
      return {Usage::eStorageBuffer | Usage::eTransferDst | Usage::eTransferSrc, mapped, Memory::eDeviceLocal | Memory::eHostCached};
    case BufferUse::device:
      return {Usage::eStorageBuffer | Usage::eTransferDst | Usage::eTransferSrc, {}, Memory::eDeviceLocal};
    case BufferUse::staging: return {Usage::eTransferSrc, mapped, Memory::eHostCached};
    case BufferUse::readback: return {Usage::eTransferDst, mapped, Memory::eHostCached};
  }
  throw std::logic_error("no such use of a buffer");
}

}  // namespace

Buffer Device::Impl::make_buffer(size_t bytes, BufferUse use) {
  const Kind kind = kind_of(use);
  Buffer made;
  ++generation;
  made.buffer = vk::raii::Buffer(device, {.size = bytes, .usage = kind.usage});
  Allocation allocation = allocate(made.buffer.getMemoryRequirements(), kind.required, kind.preferred);
  made.memory = std::move(allocation.memory);
  made.buffer.bindMemory(*made.memory, 0);
  if (kind.required & Memory::eHostVisible) made.data = made.memory.mapMemory(0, VK_WHOLE_SIZE);
  made.host_cached = !!(allocation.properties & Memory::eHostCached);
  made.bytes = bytes;
  return made;
}

Attachment Device::Impl::make_attachment(vk::Format format, int width, int height,
                                         vk::ImageUsageFlags usage) {
  const vk::Extent3D extent{static_cast<uint32_t>(width), static_cast<uint32_t>(height), 1};
  const bool is_depth = format == depth_format;
  Attachment made;
  ++generation;
  made.image =
      vk::raii::Image(device, {.imageType = vk::ImageType::e2D,
                               .format = format,
                               .extent = extent,
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .usage = usage | (is_depth ? vk::ImageUsageFlagBits::eDepthStencilAttachment
                                                          : vk::ImageUsageFlagBits::eColorAttachment)});
  made.memory = allocate(made.image.getMemoryRequirements(), {}, Memory::eDeviceLocal).memory;
  made.image.bindMemory(*made.memory, 0);
  made.view = vk::raii::ImageView(device, {.image = *made.image,
                                           .viewType = vk::ImageViewType::e2D,
                                           .format = format,
                                           .subresourceRange = whole(format)});
  return made;
}

Device::Impl::Allocation Device::Impl::allocate(const vk::MemoryRequirements& needs,
                                                vk::MemoryPropertyFlags required,
                                                vk::MemoryPropertyFlags preferred) {
  const auto allocate_from = [&](vk::MemoryPropertyFlags wanted) -> Allocation {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((needs.memoryTypeBits >> i & 1) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted)
        return {{device, {.allocationSize = needs.size, .memoryTypeIndex = i}}, memory.memoryTypes[i].propertyFlags};
    return {};
  };
  // The preferred memory may be scarce, and so full.
  try {
    Allocation made = allocate_from(required | preferred);
    if (*made.memory) return made;
  } catch (const vk::OutOfDeviceMemoryError&) {
    if (!preferred) throw;
  }
  Allocation made = allocate_from(required);
  if (!*made.memory) throw std::runtime_error("no memory type fits");
  return made;
}

void Device::Impl::reserve(Buffer& buffer, size_t bytes, BufferUse use) {
  if (buffer.bytes >= bytes) return;
  // With room to grow, because an array that grew once often grows with every frame; no longer than shaders can read.
  const size_t longest = std::max<size_t>(bytes, limits.maxStorageBufferRange);
  const size_t wanted = std::min(std::max(bytes, buffer.bytes + buffer.bytes / 2), longest);
  buffer = {};  // first, because both might not fit
  buffer = make_buffer(wanted, use);
}

void Device::Impl::upload(Array& array, const void* data, size_t bytes, const backends::Known& known_now) {
  if (array.buffer.bytes < bytes) {
    array.held = 0;
    array.pending.clear();
    reserve(array.buffer, bytes, own_memory ? BufferUse::device : BufferUse::shared);
  }
  const bool same = known_now.revision != 0 && array.known.revision == known_now.revision;
  const size_t skipped = same ? std::min({known_now.bytes, array.known.bytes, array.held}) : 0;
  if (bytes <= skipped) return;
  if (own_memory) reserve(array.staging, array.buffer.bytes, BufferUse::staging);
  const Buffer& written = own_memory ? array.staging : array.buffer;
  const auto* from = static_cast<const char*>(data);
  auto* to = static_cast<char*>(written.data);
  const size_t known = written.host_cached ? std::min(array.held, bytes) : 0;
  const size_t held = std::exchange(array.held, 0);  // in case of an exception
  for (size_t at = skipped / block_bytes * block_bytes; at < bytes; at += block_bytes) {
    const size_t size = std::min(block_bytes, bytes - at);
    if (at + size <= known && std::memcmp(to + at, from + at, size) == 0) continue;
    std::memcpy(to + at, from + at, size);
    if (!own_memory) continue;
    std::vector<vk::BufferCopy>& pending = array.pending;
    if (!pending.empty() && pending.back().srcOffset + pending.back().size == at)
      pending.back().size += size;
    else
      pending.push_back({.srcOffset = at, .dstOffset = at, .size = size});
  }
  array.held = std::max(held, bytes);
  array.known = known_now;
}

void Device::upload(lower::FrameBuffer buffer, const void* data, size_t bytes, const backends::Known& known) {
  impl_->upload(impl_->arrays[static_cast<size_t>(buffer)], data, bytes, known);
}

}  // namespace isoshade::vulkan
