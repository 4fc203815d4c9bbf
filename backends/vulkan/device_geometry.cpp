// SPDX-License-Identifier: Apache-2.0
// Triangles that are made on the device.
#include <algorithm>
#include <cstring>

#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::vulkan {

bool Device::makes_triangles() const { return impl_->own_memory && impl_->computes; }

void Device::reserve(lower::FrameBuffer buffer, size_t bytes) {
  Array& array = impl_->arrays[static_cast<size_t>(buffer)];
  if (array.buffer.bytes >= bytes) return;
  array.held = 0;
  array.pending.clear();
  impl_->reserve(array.buffer, bytes, impl_->own_memory ? BufferUse::device : BufferUse::shared);
}

void Device::append(lower::FrameBuffer buffer, size_t first, const void* data, size_t bytes) {
  if (bytes == 0) return;
  Array& array = impl_->arrays[static_cast<size_t>(buffer)];
  support::assert_that(impl_->own_memory && first + bytes <= array.buffer.bytes, "no room behind an array");
  array.held = std::min(array.held, first);
  if (array.staging.bytes <
      array.buffer.bytes) {  // all of it, or growing later would lose what waits to be copied
    support::assert_that(array.pending.empty(), "an array was uploaded without staging memory");
    array.held = 0;
    impl_->reserve(array.staging, array.buffer.bytes, BufferUse::staging);
  }
  std::memcpy(static_cast<char*>(array.staging.data) + first, data, bytes);
  array.pending.push_back({.srcOffset = first, .dstOffset = first, .size = bytes});
}

void Device::upload_indices(std::span<const uint32_t> indices) {
  impl_->upload(impl_->indices, indices.data(), indices.size_bytes(), {});
}

bool Device::make_triangles(const Geometry& geometry, Triangles& made) {
  static_assert(cut_room == glsl::cut_room);
  constexpr size_t position_bytes = 4 * sizeof(float),
                   record_bytes = lower::triangle_word::stride * sizeof(int32_t);
  constexpr size_t head_bytes = glsl::cut_head_words * sizeof(int32_t),
                   cut_bytes = glsl::cut_words * sizeof(int32_t);
  constexpr size_t listed_bytes = head_bytes + cut_room * cut_bytes;
  Array& triangles = impl_->arrays[static_cast<size_t>(lower::FrameBuffer::triangles)];
  const size_t positions = geometry.vertex_count * position_bytes,
               records = geometry.triangle_count * record_bytes;
  reserve(lower::FrameBuffer::triangles, records + geometry.room * record_bytes);
  triangles.held = 0;  // what is uploaded later finds other contents
  triangles.known = {};
  triangles.pending.clear();
  impl_->reserve(impl_->output, std::max(positions, records), BufferUse::device);
  impl_->reserve(impl_->positions, positions, BufferUse::device);
  impl_->reserve(impl_->cuts, listed_bytes, BufferUse::device);
  impl_->reserve(impl_->readback, listed_bytes, BufferUse::readback);

  const vk::raii::CommandBuffer& commands = impl_->begin();
  const vk::Buffer output = *impl_->output.buffer;
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::vertices);
    for (const Call& call : geometry.vertices) impl_->record(call);
  }
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::triangles);
    impl_->wait_for_all();
    if (positions > 0)
      commands.copyBuffer(output, *impl_->positions.buffer, vk::BufferCopy{.size = positions});
    commands.fillBuffer(*impl_->cuts.buffer, 0, head_bytes, 0);
    impl_->wait_for_all();
    for (const Call& call : geometry.setup) impl_->record(call);
    impl_->wait_for_all();
    if (records > 0) commands.copyBuffer(output, *triangles.buffer.buffer, vk::BufferCopy{.size = records});
    commands.copyBuffer(*impl_->cuts.buffer, *impl_->readback.buffer, vk::BufferCopy{.size = listed_bytes});
  }
  impl_->finish();

  const auto* listed = static_cast<const char*>(impl_->readback.data);
  int32_t counts[2];  // kept, cut
  std::memcpy(counts, listed, sizeof counts);
  if (counts[1] > static_cast<int32_t>(cut_room)) return false;
  made.kept = counts[0];
  made.cuts.resize(static_cast<size_t>(counts[1]));
  for (size_t i = 0; i < made.cuts.size(); ++i) {
    const char* record = listed + head_bytes + i * cut_bytes;
    std::memcpy(&made.cuts[i].triangle, record, sizeof(int32_t));
    std::memcpy(made.cuts[i].points, record + position_bytes, 3 * position_bytes);
  }
  return true;
}

std::optional<bool> Device::compute(std::span<const Call> visibility, std::span<const Call> color,
                                    const float (&background)[4], const Window& window, bool has_color,
                                    const Places& places, size_t first_cut) {
  using glsl::Turn;
  const size_t pixels = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
  constexpr size_t tile_bytes =
      (glsl::tile_head_words + size_t{glsl::tile_room} * glsl::tile_words) * sizeof(int32_t);
  const BufferUse use = impl_->own_memory ? BufferUse::device : BufferUse::shared;
  impl_->reserve(impl_->seen, pixels * sizeof(int32_t), use);
  impl_->reserve(impl_->tiles, tile_bytes, use);
  impl_->reserve_check();
  constexpr size_t read_bytes = 2 * sizeof(int32_t);  // the check, and how many tiles there are
  impl_->reserve(impl_->readback, read_bytes, BufferUse::readback);

  const vk::raii::CommandBuffer& commands = impl_->begin();
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::visibility);
    commands.fillBuffer(*impl_->layers().buffer.buffer, places.depth, pixels * sizeof(float), 0);
    commands.fillBuffer(*impl_->seen.buffer, 0, pixels * sizeof(int32_t), glsl::nothing_seen);
    commands.fillBuffer(*impl_->tiles.buffer, 0, glsl::tile_head_words * sizeof(int32_t), 0);
    impl_->wait_for_all();
    for (int turn = 0; turn < (has_color ? 4 : 2); ++turn) {
      const bool by_tiles = turn % 2 != 0;
      for (Call call : visibility) {
        call.push.first = turn;
        call.push.origin_x = window.x;
        call.push.origin_y = window.y;
        call.push.width = window.width;
        call.push.count = window.height;
        call.push.place = static_cast<int32_t>(places.depth / sizeof(float));
        call.push.projected = static_cast<int32_t>(first_cut);
        if (by_tiles)
          impl_->compute_groups(call, glsl::tile_groups);
        else
          impl_->compute(call);
      }
      impl_->wait_for_all();
    }
  }
  if (has_color) {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::shading);
    const auto to_layers = [&](Call call) {
      call.push.origin_x = window.x;
      call.push.origin_y = window.y;
      call.push.pitch = window.width;
      call.push.place = static_cast<int32_t>(places.color / sizeof(float));
      impl_->compute(call);
    };
    Call behind{.pipeline = *impl_->backdrop, .scissor = window};
    int32_t* const words[] = {&behind.push.object, &behind.push.light_count, &behind.push.program,
                              &behind.push.first};
    for (size_t i = 0; i < 4; ++i) std::memcpy(words[i], &background[i], sizeof(float));
    to_layers(behind);
    impl_->wait_for_all();
    for (const Call& call : color) to_layers(call);  // each pixel is written by one of these
    impl_->wait_for_all();
  }
  if (has_color) impl_->record_check(places.color / sizeof(float), 4 * pixels);
  commands.copyBuffer(*impl_->tiles.buffer, *impl_->readback.buffer,
                      vk::BufferCopy{.dstOffset = sizeof(int32_t), .size = sizeof(int32_t)});
  impl_->finish();
  int32_t tiles = 0;
  std::memcpy(&tiles, static_cast<const char*>(impl_->readback.data) + sizeof(int32_t), sizeof tiles);
  if (tiles < 0 || tiles > glsl::tile_room) return std::nullopt;
  return !has_color || impl_->is_checked_finite();
}

}  // namespace isoshade::vulkan
