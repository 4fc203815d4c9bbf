// SPDX-License-Identifier: Apache-2.0
// One Vulkan device, reduced to what the backend does with it: fill arrays, run vertex kernels, render a window of a
// view, run a table. No Vulkan type is visible outside. Functions throw std::exception if Vulkan fails; the backend
// turns that into diagnostics. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/vulkan/backend.h"
#include "backends/vulkan/disk_cache.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

using backends::Window;

/// The push constants of every shader; targets/glsl/stages.h says how each stage uses them.
struct Push {
  int32_t object = 0;
  int32_t light_count = 0;
  int32_t program = 0;
  int32_t first = 0;
  int32_t count = 0;
  int32_t width = 0;
  /// The pixel of the view at the first pixel of the attachments; Device::render() sets it.
  int32_t origin_x = 0;
  int32_t origin_y = 0;
  int32_t projected = 0;
  // Of compute shaders. The call decides the first four.
  int32_t left = 0;
  int32_t top = 0;
  int32_t columns = 0;
  int32_t rows = 0;
  int32_t place = 0;
  int32_t pitch = 0;
};

/// What a pipeline writes. It decides all fixed state.
enum class Output : uint8_t {
  buffer,      ///< words at the output binding, by a vertex shader; nothing is rasterised
  visibility,  ///< R32_SINT ids, and D32_SFLOAT depth under the test `>`
  color,       ///< R32G32B32A32_SFLOAT
  layer,       ///< the same, over what is there
  deep_layer,  ///< the same, and R32_SFLOAT for the depth, both over what is there
  depth_copy,  ///< R32_SFLOAT
  words,       ///< up to 8 of R32G32B32A32_SINT
  row,         ///< words of a buffer, by a compute shader for each vertex of a call
  pixels,      ///< words of a buffer, by a compute shader for each pixel of a call's scissor
};
constexpr bool computes(Output output) { return output == Output::row || output == Output::pixels; }

/// What a pipeline is made from. Output::buffer has no fragment shader and no attachment; Output::words has several
/// attachments, the others one. Compute shaders have neither.
struct PipelineSource {
  Output output = Output::color;
  uint32_t attachments = 1;
  std::string vertex_glsl;  ///< or of the compute shader
  std::string fragment_glsl;
  bool over = false;                          ///< of Output::visibility: the depth test always passes
  std::string what = "a shader of isoshade";  ///< for messages: the program that it comes from
};

/// A vertex shader that covers every pixel with one triangle.
const std::string& full_screen_vertex();

/// A fragment shader of Output::depth_copy that copies the depth of what is opaque.
const std::string& depth_copy_fragment();

/// A vertex shader that draws the triangles of the buffer at their snapped positions; `flat out int triangle` at
/// location 0. The map from 1/256 pixel to clip space is an exact power of two.
const std::string& triangle_vertex();

using PipelineIndex = uint32_t;

/// One draw call of triangles (of points for Output::buffer) inside a rectangle of the view, or what a compute shader runs on.
struct Call {
  PipelineIndex pipeline = 0;
  Push push{};
  uint32_t first_vertex = 0;
  uint32_t vertex_count = 3;
  Window scissor{};
};

/// Consecutive triangles that are blended, which are drawn a layer at a time: each pixel's next triangle, by number, that
/// is not behind what is there. All of them write depth, or none does.
struct LayerGroup {
  uint32_t first = 0;            ///< the number of the first triangle
  uint32_t count = 0;            ///< of triangles; at most so many layers are drawn
  Window area{};                 ///< where they lie in the view
  std::vector<Call> visibility;  ///< of Output::visibility, glsl::Variant::layer
  std::vector<Call> blending;    ///< of Output::layer, or deep_layer if they write depth: one for each program
  bool writes_depth = false;
};
struct Layers {
  std::vector<LayerGroup> groups;  ///< in the order in which they are drawn
  std::optional<Call> copy_depth;  ///< of depth_copy_fragment(), if a group writes depth
};

class Device {
 public:
  /// Null, with a diagnostic, if there is no such device or it lacks features that the shaders need.
  static std::unique_ptr<Device> open(const VulkanOptions& options, support::Diagnostics& diagnostics);
  ~Device();

  const DeviceInfo& info() const;
  /// For keys of the cache: device, driver, processor and whatever else decides the results.
  const std::string& identity() const;
  const DiskCache& disk_cache() const;
  bool validates() const;
  /// Whether vertices and pixels are computed by compute shaders: some devices draw
  /// with a few of their processors only (an H100 with 2 of 66 TPCs: NVIDIA H100 Tensor Core GPU Architecture, 2022).
  bool computes() const;
  /// Messages of the validation layers since the last call; empty without them.
  std::vector<std::string> take_messages();

  /// The largest array, in bytes.
  size_t max_buffer_bytes() const;
  /// The largest side of a target, in pixels.
  int max_frame_side() const;

  /// Compiled at the first use of a source, then kept. Nothing if a text does not compile.
  std::optional<PipelineIndex> pipeline(const PipelineSource& source, support::Diagnostics& diagnostics);
  /// The total duration of all calls of pipeline().
  double build_seconds() const;

  /// How long the device took so far; nothing if it has no clock.
  std::optional<DeviceSeconds> seconds() const;

  /// Replaces the contents of a buffer that shaders read; at most max_buffer_bytes(). Writes only what differs from the
  /// last upload to this buffer, and does not even look at what is known to be the same.
  void upload(lower::FrameBuffer buffer, const void* data, size_t bytes, const backends::Known& known = {});

  /// Makes the array at least this long; what was in it may be lost.
  void reserve(lower::FrameBuffer buffer, size_t bytes);
  /// Writes behind what was uploaded, or made on the device; the array must be long enough.
  void append(lower::FrameBuffer buffer, size_t first, const void* data, size_t bytes);

  // Triangles that are made on the device.

  /// Whether the device has memory of its own and compute shaders.
  bool makes_triangles() const;
  void upload_indices(std::span<const uint32_t> indices);
  struct Geometry {
    std::span<const Call> vertices;  ///< of Output::row: they write positions
    size_t vertex_count = 0;
    std::span<const Call> setup;  ///< of the setup stage
    size_t triangle_count = 0;
    size_t room = 0;  ///< for further records behind
  };
  struct Cut {
    int32_t triangle = 0;
    float points[3][4] = {};  ///< in clip space
  };
  struct Triangles {
    int64_t kept = 0;
    std::vector<Cut> cuts;  ///< in any order
  };
  /// Leaves the records in the array of triangles. False if more than glsl::cut_room triangles are cut.
  bool make_triangles(const Geometry& geometry, Triangles& made);

  /// Runs vertex kernels, then copies the first words of the output buffer; at most max_buffer_bytes().
  void run_vertices(std::span<const Call> calls, std::span<int32_t> output);

  /// Runs `visibility` on ids and depth cleared to 0, then `color` over the background with the ids bound. Fills the
  /// image, which has the size of the window; scissors lie inside the window. An image without color gets depth alone:
  /// `color` is not run, and no memory is taken for it. Then draws `layers`, if there are any: needs color.
  void render(std::span<const Call> visibility, std::span<const Call> color, const Layers& layers,
              const float (&background)[4], const Window& window, backends::Image& image);

  // The images of a frame lie in the array `layers` and stay on the device.

  /// Makes the array this long, at most max_buffer_bytes(); what was in it is lost.
  void reserve_layers(size_t bytes);
  void write_layers(size_t first, const void* data, size_t bytes);
  void read_layers(size_t first, void* data, size_t bytes);
  /// Before the first of the following calls. False if a shader of the device's own does not compile.
  bool prepare_own_shaders(support::Diagnostics& diagnostics);
  /// Where images go: their first bytes in `layers`.
  struct Places {
    size_t depth = 0, color = 0;
  };
  /// As render(), but the images go to `layers`. Returns whether the color is finite.
  bool render(std::span<const Call> visibility, std::span<const Call> color, const Layers& layers,
              const float (&background)[4], const Window& window, bool has_color, const Places& places);
  /// What compute shaders draw of a view.
  struct Computed {
    std::vector<Call> visibility;  ///< of Stage::depth or cutout, for each run of opaque triangles
    std::vector<Call> color;       ///< of Stage::pixel, for each program
    std::vector<Call> layers;      ///< as `visibility`, of triangles that are blended
    std::vector<Call> blending;    ///< of Stage::blend
    size_t blended = 0;            ///< how many triangles are blended: at most so many layers are drawn
    size_t first_cut = 0;  ///< from this triangle on they are what cutting left; their order stands in `inputs`
  };
  /// As render(), by compute shaders. Nothing, if these triangles take more tiles than the device lists.
  std::optional<bool> compute(const Computed& calls, const float (&background)[4], const Window& window,
                              bool has_color, const Places& places);
  /// Makes the array at least this long and keeps what is in it.
  void extend_layers(size_t bytes);
  /// Reduces an image in `layers`, `halvings` times, see backends::halve(). `between`: room for what the first of two makes.
  void reduce(const Places& from, const Places& between, const Places& to, int width, int height,
              int halvings);
  /// As below over a whole image, which goes to `layers`; may be a compute shader. Returns whether it is finite.
  bool run_screen(PipelineIndex pipeline, int width, int height, size_t place);

  /// Runs a full-screen pipeline of Output::color over rows of an image: `rgba` has 4 floats a pixel, rows top down. The
  /// last row is below max_frame_side().
  void run_screen(PipelineIndex pipeline, int width, int height, int first_row, std::span<float> rgba);

  /// Runs a full-screen pipeline of Output::words over `rows` <= max_table_rows rows: sets push.count and
  /// push.width. Record r of `output` receives the first `record_words` <= 4 * attachments words of row r.
  void run_table(PipelineIndex pipeline, uint32_t attachments, size_t rows, size_t record_words,
                 std::span<int32_t> output);

 private:
  struct Impl;
  explicit Device(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isoshade::vulkan
