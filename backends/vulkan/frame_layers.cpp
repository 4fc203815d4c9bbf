// SPDX-License-Identifier: Apache-2.0
// The images of a frame on the device, in the array `layers`.
#include <array>
#include <cstring>

#include "backends/vulkan/device_impl.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::vulkan {

namespace {

/// Floats that one call of the check looks at.
constexpr int checked_at_once = 256;
/// What one invocation of the check in a compute shader looks at.
constexpr int checked_by_one = 32;

/// As below, as a compute shader.
const std::string& finite_check_compute() {
  static const std::string text =
      glsl::head() + glsl::compute_interface(false) +
      "layout(std430, set = 0, binding = " + std::to_string(static_cast<int>(lower::FrameBuffer::layers)) +
      ") readonly buffer layers_block { uint layers[]; };\nlayout(std430, set = 0, binding = " +
      std::to_string(output_binding) + ") writeonly buffer found_block { int found[]; };" + R"(

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= push.columns) return;
  bool finite = true;
  for (int i = index; i < push.count; i += push.columns)
    finite = finite && (layers[push.first + i] & 0x7f800000u) != 0x7f800000u;
  if (!finite) found[0] = 1;
}
)";
  return text;
}

/// A vertex kernel that sets the first word of the output to 1 if a float in [push.first, push.first + push.count) of
/// `layers` is infinite or NaN.
const std::string& finite_check_vertex() {
  static const std::string text =
      glsl::head() +
      "layout(push_constant) uniform Push { int object, light_count, program, first, count; } push;\n"
      "layout(std430, set = 0, binding = " +
      std::to_string(static_cast<int>(lower::FrameBuffer::layers)) +
      ") readonly buffer layers_block { uint layers[]; };\n"
      "layout(std430, set = 0, binding = " +
      std::to_string(output_binding) + ") writeonly buffer found_block { int found[]; };" + R"(

void main() {
  int begin = push.first + )" + std::to_string(checked_at_once) + R"( * gl_VertexIndex;
  int end = min(begin + )" + std::to_string(checked_at_once) + R"(, push.first + push.count);
  bool finite = true;
  for (int i = begin; i < end; ++i) finite = finite && (layers[i] & 0x7f800000u) != 0x7f800000u;
  if (!finite) found[0] = 1;
  gl_PointSize = 1.0;
}
)";
  return text;
}

}  // namespace

Array& Device::Impl::layers() { return arrays[static_cast<size_t>(lower::FrameBuffer::layers)]; }

void Device::Impl::wait_for_all() const {
  constexpr auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
  constexpr auto all = vk::PipelineStageFlagBits::eAllCommands;
  commands.pipelineBarrier(all, all, {}, vk::MemoryBarrier{.srcAccessMask = any, .dstAccessMask = any}, {}, {});
}

void Device::reserve_layers(size_t bytes) {
  Array& layers = impl_->layers();
  layers.pending.clear();
  layers.held = 0;  // what is uploaded later finds other contents
  layers.known = {};
  impl_->reserve(layers.buffer, std::max<size_t>(bytes, sizeof(float)),
                 impl_->own_memory ? BufferUse::device : BufferUse::shared);
}

void Device::extend_layers(size_t bytes) {
  Array& layers = impl_->layers();
  if (layers.buffer.bytes >= bytes) return;
  Buffer longer = impl_->make_buffer(bytes, impl_->own_memory ? BufferUse::device : BufferUse::shared);
  const vk::raii::CommandBuffer& commands = impl_->begin();
  commands.copyBuffer(*layers.buffer.buffer, *longer.buffer, vk::BufferCopy{.size = layers.buffer.bytes});
  impl_->finish();
  layers.buffer = std::move(longer);
  ++impl_->generation;  // the recording had the shorter one
}

void Device::reduce(const Places& from, const Places& between, const Places& to, int width, int height,
                    int halvings) {
  impl_->begin();
  {
    const Impl::TimedStep step(*impl_, &DeviceSeconds::screen);
    const auto word = [](size_t place) { return static_cast<int32_t>(place / sizeof(float)); };
    Places source = from;
    for (int i = 1; i <= halvings; ++i) {
      const Places& made = i == halvings ? to : between;
      impl_->compute({.pipeline = *impl_->halving,
                      .push = {.object = word(source.color),
                               .first = word(made.depth),
                               .count = word(source.depth),
                               .width = width,
                               .place = word(made.color),
                               .pitch = width / 2},
                      .scissor = {0, 0, width / 2, height / 2}});
      impl_->wait_for_all();
      source = made;
      width /= 2;
      height /= 2;
    }
  }
  impl_->finish();
}

void Device::write_layers(size_t first, const void* data, size_t bytes) {
  Array& layers = impl_->layers();
  if (!impl_->own_memory) {
    std::memcpy(static_cast<char*>(layers.buffer.data) + first, data, bytes);
    return;
  }
  impl_->reserve(layers.staging, bytes, BufferUse::staging);
  std::memcpy(layers.staging.data, data, bytes);
  const vk::raii::CommandBuffer& commands = impl_->begin();
  commands.copyBuffer(*layers.staging.buffer, *layers.buffer.buffer, vk::BufferCopy{.dstOffset = first, .size = bytes});
  impl_->finish();
}

void Device::read_layers(size_t first, void* data, size_t bytes) {
  const Array& layers = impl_->layers();
  if (!impl_->own_memory) {
    std::memcpy(data, static_cast<const char*>(layers.buffer.data) + first, bytes);
    return;
  }
  impl_->reserve(impl_->readback, std::min(bytes, max_readback_bytes), BufferUse::readback);
  for (size_t done = 0; done < bytes; done += max_readback_bytes) {
    const size_t size = std::min(bytes - done, max_readback_bytes);
    const vk::raii::CommandBuffer& commands = impl_->begin();
    commands.copyBuffer(*layers.buffer.buffer, *impl_->readback.buffer,
                        vk::BufferCopy{.srcOffset = first + done, .size = size});
    impl_->finish();
    std::memcpy(static_cast<char*>(data) + done, impl_->readback.data, size);
  }
}

bool Device::prepare_own_shaders(support::Diagnostics& diagnostics) {
  if (impl_->finite_check) return true;
  if (impl_->computes) {
    impl_->backdrop = pipeline({Output::pixels, 0, glsl::backdrop_compute(), {}}, diagnostics);
    if (!impl_->backdrop) return false;
    impl_->next_layer = pipeline({Output::pixels, 0, glsl::layer_compute(), {}}, diagnostics);
    if (!impl_->next_layer) return false;
    impl_->halving = pipeline({Output::pixels, 0, glsl::halving_compute(), {}}, diagnostics);
    if (!impl_->halving) return false;
    impl_->finite_check = pipeline({Output::row, 0, finite_check_compute(), {}}, diagnostics);
  } else {
    impl_->finite_check = pipeline({Output::buffer, 0, finite_check_vertex(), {}}, diagnostics);
  }
  return impl_->finite_check.has_value();
}

/// Before a recording: makes the buffers of the check.
void Device::Impl::reserve_check() {
  support::assert_that(finite_check.has_value(), "a check that is not prepared");
  reserve(output, sizeof(int32_t), own_memory ? BufferUse::device : BufferUse::shared);
  if (own_memory) reserve(readback, sizeof(int32_t), BufferUse::readback);
}

/// Finishes the recording with a look at floats that it has copied to `layers`. Returns whether all are finite.
bool Device::Impl::finish_with_check(size_t first, size_t floats) {
  record_check(first, floats);
  finish();
  return is_checked_finite();
}

void Device::Impl::record_check(size_t first, size_t floats) {
  {
    const TimedStep step(*this, &DeviceSeconds::copies);
    commands.fillBuffer(*output.buffer, 0, sizeof(int32_t), 0);
    wait_for_all();
    const size_t by_one = computes ? checked_by_one : checked_at_once;
    const Call check{.pipeline = *finite_check,
                     .push = {.first = static_cast<int32_t>(first), .count = static_cast<int32_t>(floats)},
                     .vertex_count = static_cast<uint32_t>((floats + by_one - 1) / by_one),
                     .scissor = {0, 0, 1, 1}};
    if (computes) {
      compute(check);
    } else {
      const vk::Rect2D pixel{.extent = {1, 1}};
      commands.beginRenderPass(
          {.renderPass = *render_pass(Output::buffer, 0), .framebuffer = *no_target, .renderArea = pixel},
          vk::SubpassContents::eInline);
      record(check);
      commands.endRenderPass();
    }
    wait_for_all();
    if (own_memory) commands.copyBuffer(*output.buffer, *readback.buffer, vk::BufferCopy{.size = sizeof(int32_t)});
  }
}

bool Device::Impl::is_checked_finite() const {
  int32_t found = 0;
  std::memcpy(&found, own_memory ? readback.data : output.data, sizeof found);
  return found == 0;
}

}  // namespace isoshade::vulkan
