// SPDX-License-Identifier: Apache-2.0
// The implementation of Device. Internal: includes Vulkan-Hpp.
#pragma once

#include <array>
#include <list>
#include <map>
#include <unordered_map>

#include "backends/vulkan/device.h"
#include "backends/vulkan/instance.h"
#include "backends/vulkan/limits.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::vulkan {

inline constexpr vk::Format ids_format = vk::Format::eR32Sint;
inline constexpr vk::Format depth_format = vk::Format::eD32Sfloat;
inline constexpr vk::Format color_format = vk::Format::eR32G32B32A32Sfloat;
inline constexpr vk::Format layer_depth_format = vk::Format::eR32Sfloat;
inline constexpr vk::Format words_format = vk::Format::eR32G32B32A32Sint;

/// All of an image that has one level and one layer.
inline vk::ImageSubresourceRange whole(vk::Format format) {
  return {.aspectMask =
              format == depth_format ? vk::ImageAspectFlagBits::eDepth : vk::ImageAspectFlagBits::eColor,
          .levelCount = 1,
          .layerCount = 1};
}

// Members that own memory stand before the objects in it, because members are destroyed in reverse order.

struct Buffer {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  void* data = nullptr;      ///< mapped as long as the buffer exists; null if it is of BufferUse::device
  bool host_cached = false;  ///< the host reads it fast
  size_t bytes = 0;
};

/// Decides the memory of a buffer.
enum class BufferUse : uint8_t {
  shared,   ///< shaders use it, the host reads and writes it: where both have the same memory
  device,   ///< shaders use it, and copies move its contents from and to the host
  staging,  ///< the host writes it, the device copies it
  readback  ///< the device copies to it, the host reads it
};

/// An array that shaders read. It only grows.
struct Array {
  Buffer buffer;
  Buffer staging;  ///< with the same contents, if the device has memory of its own
  size_t held = 0;  ///< bytes that are known: of the longest upload
  backends::Known known;  ///< of the last upload
  std::vector<vk::BufferCopy> pending;  ///< from `staging`, before the next work
};

struct Attachment {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Image image{nullptr};
  vk::raii::ImageView view{nullptr};
};

/// What layers of triangles that are blended need beside ids, depth and color of the window.
struct LayerAttachments {
  Attachment ids;       ///< layers write these and those of the window in turn
  Attachment order;     ///< the depth by which each pixel keeps the first triangle of a layer
  Attachment backdrop;  ///< the color before the layer, where it is drawn
  Attachment depth;     ///< if layers write depth
  std::array<vk::raii::Framebuffer, 2> visibility{nullptr, nullptr};  ///< of these ids, of those of the window
  vk::raii::Framebuffer blending{nullptr}, deep_blending{nullptr}, depth_copying{nullptr};
};

/// The attachments of a window; made again when its size changes.
struct WindowAttachments {
  int width = 0;
  int height = 0;
  bool has_color = false;   ///< otherwise `color` and `shading` are empty
  bool has_layers = false;  ///< otherwise `layers` is empty
  Attachment ids, depth, color;
  vk::raii::Framebuffer visibility{nullptr};
  vk::raii::Framebuffer shading{nullptr};
  LayerAttachments layers;
};

/// The images that shaders read. Those that a call does not read may be any.
struct ImagesRead {
  vk::ImageView ids, former_ids, former_depth, former_color;
  bool operator==(const ImagesRead&) const = default;
};

/// A descriptor set, and what it was written for.
struct DescriptorSet {
  vk::raii::DescriptorSet set{nullptr};
  ImagesRead images{};
  uint64_t generation = 0;  ///< Device::Impl::generation when it was written; 0: it was not
  uint64_t recording = 0;   ///< the last one that uses it
};
/// One for the opaque triangles, two for layers in turn.
inline constexpr uint32_t max_sets = 3;

/// Attachments of so many other sizes are kept: the views and posts of a frame take turns.
inline constexpr size_t max_other_attachments = 7;

/// Layers that are drawn before the host looks whether the last one shows anything.
inline constexpr uint32_t max_layers_at_once = 8;

/// Steps of a recording whose time is taken.
inline constexpr uint32_t max_timed_steps = 32;

inline constexpr vk::ShaderStageFlags shader_stages =
    vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment | vk::ShaderStageFlagBits::eCompute;

struct Pipeline {
  Output output;
  vk::raii::Pipeline pipeline;
};

/// What a recording has bound and set.
struct State {
  std::optional<uint32_t> pipeline, computing_pipeline;
  vk::DescriptorSet set, computing_set;
  std::optional<std::pair<int, int>> viewport;  ///< the pixel of the view at the attachments' first
  std::optional<vk::Rect2D> scissor;
};

/// The attachments of tables of one record size; grows with the rows.
struct TableAttachments {
  int height = 0;
  std::vector<Attachment> attachments;
  vk::raii::Framebuffer framebuffer{nullptr};
};

struct Device::Impl {
  /// Opens the device of this index, which must have no shortcomings().
  Impl(std::unique_ptr<Instance> instance, int index, const VulkanOptions& options);

  struct Allocation {
    vk::raii::DeviceMemory memory{nullptr};
    vk::MemoryPropertyFlags properties{};
  };
  Allocation allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags required,
                      vk::MemoryPropertyFlags preferred);
  Buffer make_buffer(size_t bytes, BufferUse use);
  Attachment make_attachment(vk::Format format, int width, int height, vk::ImageUsageFlags usage);
  /// Makes it at least `bytes` long. Its contents are lost if it grows.
  void reserve(Buffer& buffer, size_t bytes, BufferUse use);
  void upload(Array& array, const void* data, size_t bytes, const backends::Known& known);

  /// The render pass of an output; it clears every attachment and stores it. Made once.
  const vk::raii::RenderPass& render_pass(Output output, uint32_t attachments);
  vk::raii::Pipeline make_pipeline(const PipelineSource& source, std::span<const uint32_t> vertex,
                                   std::span<const uint32_t> fragment);
  vk::raii::Pipeline make_pipeline(std::span<const uint32_t> compute);

  void prepare_attachments(int width, int height, bool has_color, bool has_layers = false);
  void make_attachments(int width, int height, bool has_color, bool has_layers);
  void prepare_layers();
  vk::raii::Framebuffer make_framebuffer(Output output, std::span<const vk::ImageView> views, int width, int height);
  /// Draws a group over what is there. `depth`: what its triangles are tested against; (x, y): the pixel of the view at the
  /// attachments' first.
  void draw_group(const LayerGroup& group, const Attachment& depth, int x, int y);
  TableAttachments& prepare_table(uint32_t attachments, int height);

  /// It always writes every descriptor: lavapipe crashes on one that is not written, even if no shader uses it.
  void write_descriptors(vk::DescriptorSet set, const ImagesRead& images);
  /// What is recorded from here on reads the current buffers and these images.
  void read(const ImagesRead& images);

  /// Begins a recording with copies of what was uploaded, and drops one that was not finished. No buffer or image may be
  /// made until finish().
  const vk::raii::CommandBuffer& begin(const ImagesRead& images);
  /// Shaders read the ids of the window.
  const vk::raii::CommandBuffer& begin();
  /// Submits the recording and waits. Afterwards the host sees what the device wrote.
  void finish();

  class TimedStep;
  void copy_pending();
  void add_times();

  /// The driver's own cache of what it compiled, kept on disk if the driver puts anything in it.
  void open_pipeline_cache();
  void keep_pipelines() noexcept;

  Array& layers();
  /// What is recorded from here on waits for all that was recorded before.
  void wait_for_all() const;
  void reserve_check();
  bool finish_with_check(size_t first, size_t floats);
  /// Records the check; finish_with_check() is this, finish() and is_checked_finite().
  void record_check(size_t first, size_t floats);
  bool is_checked_finite() const;
  /// Begins a recording that draws a view; its images are then to be copied.
  struct DrawnView {
    const Attachment* depth = nullptr;
    vk::Format depth_format{};
    int margin = 0;  ///< of the attachments before the window
  };
  DrawnView record_view(std::span<const Call> visibility, std::span<const Call> color, const Layers& layers,
                        const float (&background)[4], const Window& window, bool has_color);

  /// A turn of finding what is seen, see glsl::Turn.
  void find_seen(std::span<const Call> calls, glsl::Turn turn, const Window& window, const Places& places,
                 size_t first_cut);
  /// Runs a compute shader of pixels of a window in `layers`.
  void compute_pixels(Call call, const Window& window, const Places& places);
  /// Draws layer after layer. False if they take more tiles than the device lists.
  bool compute_layers(const Computed& calls, const Window& window, const Places& places);

  /// Records what differs from the state that the recording has, and a draw. Drivers look at state that is set again.
  void record(const Call& call);
  void bind_computing(const Call& call);
  void compute(const Call& call);
  /// Of Output::row: so many groups, which divide the triangles of the call as they like.
  void compute_groups(const Call& call, uint32_t groups);
  /// With the attachments' first pixel at (x, y) of the view.
  void record_at(std::span<const Call> calls, int x, int y);

  std::unique_ptr<Instance> instance;
  vk::raii::PhysicalDevice physical;
  DeviceInfo info;
  std::string identity;
  DiskCache disk_cache;
  vk::PhysicalDeviceLimits limits;
  vk::PhysicalDeviceMemoryProperties memory;
  bool own_memory = false;  ///< the host fills arrays by copies; otherwise host and device share their memory
  bool computes = false;

  vk::raii::Device device{nullptr};
  vk::raii::Queue queue{nullptr};
  vk::raii::CommandPool pool{nullptr};
  vk::raii::CommandBuffer commands{nullptr};
  vk::raii::Fence fence{nullptr};

  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::DescriptorPool descriptor_pool{nullptr};
  std::array<DescriptorSet, max_sets> sets;
  vk::DescriptorSet current_set;
  State state;  ///< of the recording
  uint64_t generation = 1;  ///< a new number whenever a buffer or an image is made
  uint64_t recording = 0;
  vk::raii::Sampler sampler{nullptr};
  vk::raii::QueryPool samples_passed{nullptr};  ///< occlusion, one for each of max_layers_at_once

  vk::raii::QueryPool timestamps{nullptr};  ///< null without a clock
  uint64_t timestamp_mask = 0;              ///< of valid bits
  DeviceSeconds seconds;
  std::vector<double DeviceSeconds::*> timed;  ///< of this recording

  std::array<Array, frame_bindings> arrays;
  Buffer output;  ///< words that vertex kernels write
  Buffer positions, cuts;  ///< of the setup stage
  Buffer seen, tiles, orders;  ///< of compute shaders that find what is seen
  Array indices;
  Array zero;     ///< always 0
  Buffer readback;
  WindowAttachments attachments;
  std::list<WindowAttachments> other_attachments;  ///< of other sizes, those used last in front
  vk::raii::Framebuffer no_target{nullptr};
  std::map<uint32_t, TableAttachments> tables;  ///< by the number of attachments

  vk::raii::PipelineCache pipeline_cache{nullptr};
  std::string kept_pipelines;  ///< what the cache on disk had
  std::map<std::pair<Output, uint32_t>, vk::raii::RenderPass> render_passes;
  std::vector<Pipeline> pipelines;
  std::unordered_map<std::string, PipelineIndex> pipeline_of;  ///< by source, see key()
  std::optional<PipelineIndex> finite_check, backdrop, next_layer, halving;
  double build_seconds = 0;
};

/// Adds the time of what is recorded in its lifetime to a sum. Not inside of a render pass.
class Device::Impl::TimedStep {
 public:
  TimedStep(Impl& device, double DeviceSeconds::*sum);
  ~TimedStep();
  TimedStep(const TimedStep&) = delete;
  TimedStep& operator=(const TimedStep&) = delete;

 private:
  Impl& device_;
  uint32_t index_ = max_timed_steps;  ///< of its timestamps; this is none
};

}  // namespace isoshade::vulkan
