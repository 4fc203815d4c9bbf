// SPDX-License-Identifier: Apache-2.0
// One Vulkan device, reduced to what the backend does with it: fill arrays, run vertex kernels, render a frame,
// run a table. No Vulkan type is seen outside. Functions throw std::exception where Vulkan fails; the backend
// turns that into diagnostics. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/backend.h"
#include "backends/vulkan/device_info.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// The push constants of every shader; emit/stages.h says what each stage makes of them.
struct Push {
  int32_t object = 0;
  int32_t light_count = 0;
  int32_t program = 0;
  int32_t first = 0;
  int32_t count = 0;
  int32_t width = 0;
  /// The pixel of the frame at the first one of the target; set by what renders.
  int32_t origin_x = 0;
  int32_t origin_y = 0;
  int32_t projected = 0;
};

/// What a pipeline writes; all its fixed state follows from this.
enum class Target : uint8_t {
  buffer,      ///< words at the output binding, by a vertex shader; nothing is rasterised
  visibility,  ///< R32_SINT ids, and D32_SFLOAT depth under the test `>`
  color,       ///< R32G32B32A32_SFLOAT
  words,       ///< up to 8 of R32G32B32A32_SINT
};

/// What a pipeline is made from. Target::buffer has no fragment shader; others than Target::words write one
/// attachment, Target::buffer none.
struct PipelineSource {
  Target target = Target::color;
  uint32_t attachments = 1;
  std::string vertex_glsl;
  std::string fragment_glsl;
  bool over = false;                          ///< of Target::visibility: without the depth test
  std::string what = "a shader of isoshade";  ///< for messages, of the text that is not the same for all
};

using PipelineIndex = uint32_t;

/// One draw call of triangles (points where the target is a buffer) inside a rectangle of the frame.
struct Call {
  PipelineIndex pipeline = 0;
  Push push{};
  uint32_t first_vertex = 0;
  uint32_t vertex_count = 3;
  Rect scissor{};
};

class Device {
 public:
  /// Null, with a diagnostic, where there is no such device or it lacks what the shaders need.
  static std::unique_ptr<Device> open(std::string_view selector, support::Diagnostics& diagnostics);
  ~Device();

  const DeviceInfo& info() const;
  bool validates() const;
  /// What the validation layers said since the last call; always empty without them.
  std::vector<std::string> take_messages();

  /// The bytes that one array may have.
  size_t max_buffer_bytes() const;
  /// The pixels that one side of a frame may have.
  int max_frame_side() const;

  /// Compiled at the first use of a source, then kept. Nothing where a text does not compile.
  std::optional<PipelineIndex> pipeline(const PipelineSource& source, support::Diagnostics& diagnostics);
  /// What all calls of pipeline() took.
  double build_seconds() const;

  /// Replaces the contents of a buffer that shaders read; at most max_buffer_bytes().
  void upload(lower::FrameBuffer buffer, const void* data, size_t bytes);

  /// Runs vertex kernels, then copies the first words of the output buffer; at most max_buffer_bytes().
  void run_vertices(std::span<const Call> calls, std::span<int32_t> output);

  /// Runs `visibility` on ids and depth cleared to 0, then `color` over the background with the ids bound.
  /// Fills the image with a part of the frame, which is of its size; scissors lie inside.
  void render(std::span<const Call> visibility, std::span<const Call> color, const float (&background)[4],
              const Rect& part, backends::Image& image);

  /// Runs a full-screen pipeline of Target::color over an image: `rgba` has 4 floats a pixel, rows top down.
  void run_screen(PipelineIndex pipeline, int width, int height, std::span<float> rgba);

  /// Runs a full-screen pipeline of Target::words over `rows` <= max_table_rows rows: sets push.count and
  /// push.width. Record r of `output` receives the first `record_words` <= 4 * attachments words of row r.
  void run_table(PipelineIndex pipeline, uint32_t attachments, size_t rows, size_t record_words,
                 std::span<int32_t> output);

 private:
  struct Impl;
  explicit Device(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isoshade::vulkan
