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
  // As long as the array, or growing later would lose what waits to be copied.
  if (array.staging.bytes < array.buffer.bytes) {
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
  constexpr size_t position_bytes = 4 * sizeof(float),
                   record_bytes = lower::triangle_word::stride * sizeof(int32_t);
  constexpr size_t head_bytes = glsl::cut_head_words * sizeof(int32_t),
                   cut_bytes = glsl::cut_words * sizeof(int32_t);
  constexpr size_t listed_bytes = head_bytes + size_t{glsl::cut_room} * cut_bytes;
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
  if (counts[1] > glsl::cut_room) return false;
  made.kept = counts[0];
  made.cuts.resize(static_cast<size_t>(counts[1]));
  for (size_t i = 0; i < made.cuts.size(); ++i) {
    const char* record = listed + head_bytes + i * cut_bytes;
    std::memcpy(&made.cuts[i].triangle, record, sizeof(int32_t));
    std::memcpy(made.cuts[i].points, record + position_bytes, 3 * position_bytes);
  }
  return true;
}

namespace {

using glsl::Turn;

constexpr size_t head_bytes = glsl::tile_head_words * sizeof(int32_t);

}  // namespace

void Device::Impl::find_seen(std::span<const Call> calls, Turn turn, const Window& window, const Places& places,
                             size_t first_cut) {
  const bool by_tiles = turn == Turn::depth_of_tiles || turn == Turn::seen_of_tiles || turn == Turn::layer_of_tiles;
  for (Call call : calls) {
    call.push.first = static_cast<int32_t>(turn);
    call.push.origin_x = window.x;
    call.push.origin_y = window.y;
    call.push.width = window.width;
    call.push.count = window.height;
    call.push.place = static_cast<int32_t>(places.depth / sizeof(float));
    call.push.projected = static_cast<int32_t>(first_cut);
    if (by_tiles)
      compute_groups(call, glsl::tile_groups);
    else
      compute(call);
  }
  wait_for_all();
}

void Device::Impl::compute_pixels(Call call, const Window& window, const Places& places) {
  call.push.origin_x = window.x;
  call.push.origin_y = window.y;
  call.push.pitch = window.width;
  call.push.place = static_cast<int32_t>(places.color / sizeof(float));
  compute(call);
}

bool Device::Impl::compute_layers(const Computed& calls, const Window& window, const Places& places) {
  const auto pixels = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
  constexpr size_t read_at = 2 * sizeof(int32_t);
  commands.fillBuffer(*orders.buffer, 0, pixels * sizeof(int32_t), static_cast<uint32_t>(-1));
  commands.fillBuffer(*orders.buffer, pixels * sizeof(int32_t), pixels * sizeof(int32_t), glsl::nothing_seen);
  commands.fillBuffer(*tiles.buffer, 0, head_bytes, 0);
  wait_for_all();
  for (size_t layer = 0; layer < calls.blended;) {
    const size_t end = std::min(calls.blended, layer + max_layers_at_once);
    {
      const TimedStep step(*this, &DeviceSeconds::layers);
      for (; layer < end; ++layer) {
        find_seen(calls.layers, layer == 0 ? Turn::first_layer_of_triangles : Turn::layer_of_triangles, window, places,
                  calls.first_cut);
        find_seen(calls.layers, Turn::layer_of_tiles, window, places, calls.first_cut);
        compute_pixels({.pipeline = *next_layer,
                        .push = {.first = static_cast<int32_t>(layer + 1), .count = static_cast<int32_t>(pixels)},
                        .scissor = window},
                       window, places);
        wait_for_all();
        for (Call call : calls.blending) {
          call.push.first = static_cast<int32_t>(places.depth / sizeof(float));
          compute_pixels(call, window, places);
        }
        wait_for_all();
      }
      commands.copyBuffer(*tiles.buffer, *readback.buffer, vk::BufferCopy{.dstOffset = read_at, .size = head_bytes});
    }
    finish();
    int32_t head[2];  // tiles, the last layer that shows anything
    std::memcpy(head, static_cast<const char*>(readback.data) + read_at, sizeof head);
    begin();
    if (head[0] < 0 || head[0] > glsl::tile_room) return false;
    if (static_cast<size_t>(head[1]) < layer) break;
  }
  return true;
}

std::optional<bool> Device::compute(const Computed& calls, const float (&background)[4], const Window& window,
                                    bool has_color, const Places& places) {
  const size_t pixels = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
  constexpr size_t tile_bytes = head_bytes + size_t{glsl::tile_room} * glsl::tile_words * sizeof(int32_t);
  const BufferUse use = impl_->own_memory ? BufferUse::device : BufferUse::shared;
  impl_->reserve(impl_->seen, pixels * sizeof(int32_t), use);
  impl_->reserve(impl_->tiles, tile_bytes, use);
  if (calls.blended > 0) impl_->reserve(impl_->orders, 2 * pixels * sizeof(int32_t), use);
  impl_->reserve_check();
  constexpr size_t check_bytes = sizeof(int32_t), read_bytes = check_bytes + sizeof(int32_t) + head_bytes;
  impl_->reserve(impl_->readback, read_bytes, BufferUse::readback);

  const vk::raii::CommandBuffer& commands = impl_->begin();
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::visibility);
    commands.fillBuffer(*impl_->layers().buffer.buffer, places.depth, pixels * sizeof(float), 0);
    commands.fillBuffer(*impl_->seen.buffer, 0, pixels * sizeof(int32_t), glsl::nothing_seen);
    commands.fillBuffer(*impl_->tiles.buffer, 0, head_bytes, 0);
    impl_->wait_for_all();
    for (const Turn turn : {Turn::depth_of_triangles, Turn::depth_of_tiles, Turn::seen_of_triangles, Turn::seen_of_tiles})
      if (has_color || turn < Turn::seen_of_triangles)
        impl_->find_seen(calls.visibility, turn, window, places, calls.first_cut);
    commands.copyBuffer(*impl_->tiles.buffer, *impl_->readback.buffer,
                        vk::BufferCopy{.dstOffset = check_bytes, .size = sizeof(int32_t)});
  }
  if (has_color) {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::shading);
    Call behind{.pipeline = *impl_->backdrop, .scissor = window};
    int32_t* const words[] = {&behind.push.object, &behind.push.light_count, &behind.push.program, &behind.push.first};
    for (size_t i = 0; i < 4; ++i) std::memcpy(words[i], &background[i], sizeof(float));
    impl_->compute_pixels(behind, window, places);
    impl_->wait_for_all();
    for (const Call& call : calls.color) impl_->compute_pixels(call, window, places);  // each pixel is one call's
    impl_->wait_for_all();
  }
  const bool has_room = calls.blended == 0 || impl_->compute_layers(calls, window, places);
  if (has_color) impl_->record_check(places.color / sizeof(float), 4 * pixels);
  impl_->finish();
  int32_t tiles = 0;
  std::memcpy(&tiles, static_cast<const char*>(impl_->readback.data) + check_bytes, sizeof tiles);
  if (!has_room || tiles < 0 || tiles > glsl::tile_room) return std::nullopt;
  return !has_color || impl_->is_checked_finite();
}

}  // namespace isoshade::vulkan
