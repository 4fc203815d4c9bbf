// SPDX-License-Identifier: Apache-2.0
// The Vulkan backend: any device with Vulkan 1.1 and VK_KHR_shader_float_controls that passes the probe.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/host_backend.h"
#include "backends/vulkan/probe.h"
#include "compiler/driver/program.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

class Device;
struct DeviceTriangles;

/// A Vulkan device, as the `devices` command lists it.
struct DeviceInfo {
  int index = 0;       ///< `--device` takes it, or a part of the name
  std::string name;    ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string driver;  ///< "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
  std::string api;     ///< "1.3.230"
  bool cpu = false;    ///< a software device
};

/// The devices of this machine in the order of their index; empty, with a diagnostic, if there is no Vulkan.
std::vector<DeviceInfo> list_devices(support::Diagnostics& diagnostics);

/// Whether `--device` names this device: by its number, or by a part of its name in any case.
bool matches(const DeviceInfo& info, std::string_view selector);

/// Reports no-device, with what to install.
support::Diagnostic& report_unusable(std::string_view why, support::Diagnostics& diagnostics);

/// How long the device took for what it ran, by its own clock.
struct DeviceSeconds {
  double vertices = 0;
  double triangles = 0;  ///< making their records
  double visibility = 0;
  double shading = 0;
  double layers = 0;  ///< of what is blended
  double screen = 0;  ///< full-screen passes
  double tables = 0;  ///< rows of eval programs, and the probe
  double copies = 0;  ///< to and from the host
};

/// Where eval programs run. Pixels are computed in fragment shaders, positions in vertex shaders.
enum class EvalStage : uint8_t { fragment, vertex };

struct VulkanOptions {
  /// A device's index or a part of its name, case ignored. Empty: the first software device (lavapipe), else
  /// the first device.
  std::string device;
  /// Accept a device that fails the probe; its images may differ.
  bool allow_unproven = false;
  /// Run the probe even where the cache has its result.
  bool probe_anew = false;
  /// The folder of the cache; empty: the user's.
  std::string cache;
  /// For tests: treat the device as one with memory of its own, which the host fills by copies.
  bool own_memory = false;
  /// Compute vertices and pixels in compute shaders; without a value devices do that which are not software. Not with
  /// `glsl`.
  std::optional<bool> compute;
  /// Overrides the probe's choice.
  std::optional<driver::Division> division;
  /// With EvalStage::vertex, `glsl` must give a vertex shader that stores the words of row gl_VertexIndex,
  /// one record after another, to `layout(std430, set = 0, binding = N) writeonly buffer { int words[]; }` with
  /// N = output_binding of limits.h.
  EvalStage eval_stage = EvalStage::fragment;
  /// The text of a program's stage; see targets/glsl/stages.h for the interface it must have. Empty: the driver's.
  std::function<std::string(const driver::Program&, driver::Division)> glsl;
};

class VulkanBackend : public backends::HostBackend {
 public:
  ~VulkanBackend() override;

  std::string_view name() const override { return "vulkan"; }
  std::string description() const override;
  double build_seconds() const override;
  std::vector<backends::DeviceStep> device_steps() const override;

  // The images stay on the device, unless they take more than shaders can read.
  bool reserve(size_t floats, support::Diagnostics& diagnostics) override;
  void write(size_t first, std::span<const float> floats) override;
  std::span<const float> read(const backends::Slot& slot) override;
  bool is_finite() override { return made_finite_ && HostBackend::is_finite(); }
  bool draw(const backends::Drawing& drawing, support::Diagnostics& diagnostics) override;
  bool post(std::span<const backends::ScreenPass> passes, const backends::Slot& made,
            support::Diagnostics& diagnostics) override;
  std::optional<bool> draw_view(const backends::Drawing& drawing, backends::Made& made,
                                support::Diagnostics& diagnostics) override;
  bool transform(const backends::ViewPass& pass, support::Array<float>& clip,
                 support::Diagnostics& diagnostics) override;
  bool evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, support::Diagnostics& diagnostics) override;

  const DeviceInfo& device() const;
  const Probe& probe() const { return probe_; }
  driver::Division division() const { return division_; }
  /// The sums since the backend was created; nothing if the device has no clock.
  std::optional<DeviceSeconds> device_seconds() const;

 protected:
  std::unique_ptr<backends::ViewRenderer> begin(const backends::ViewPass& pass, const backends::Layers& layers,
                                                std::span<const float> vertices,
                                                support::Diagnostics& diagnostics) override;
  bool screen(const backends::ScreenPass& pass, const backends::Layers& layers, int first_row, int rows,
              std::vector<float>& rgba, support::Diagnostics& diagnostics) override;

 private:
  friend std::unique_ptr<VulkanBackend> create(const VulkanOptions& options, support::Diagnostics& diagnostics);
  VulkanBackend(VulkanOptions options, std::unique_ptr<Device> device);

  friend class VulkanViewRenderer;

  /// Runs `work`; reports what Vulkan throws and what the validation layers say.
  bool guarded(support::Diagnostics& diagnostics, const std::function<bool()>& work);
  /// The text of a program; nothing if it is too large for drivers, which is reported.
  std::optional<std::string> text_of(const driver::Program& program, support::Diagnostics& diagnostics,
                                     bool computes = false) const;
  bool check_size(int width, int height, support::Diagnostics& diagnostics) const;
  /// Uploads what the programs of a view read, except textures and triangles. `knows_vertices`: they begin with those of
  /// the frame.
  bool upload(const backends::ViewPass& pass, const backends::Layers& layers, std::span<const float> vertices,
              bool knows_vertices, support::Diagnostics& diagnostics);
  bool upload_textures(const backends::Frame& frame, support::Diagnostics& diagnostics);
  bool upload_triangles(const backends::Frame& frame, std::span<const int32_t> triangles,
                        support::Diagnostics& diagnostics);

  /// The pipelines of the vertex programs of a view, by the index of the program.
  bool vertex_pipelines(const backends::ViewPass& pass, std::vector<std::optional<uint32_t>>& pipelines,
                        support::Diagnostics& diagnostics);
  /// Makes the triangles of a view on the device, see geometry.h; nothing where the host has to.
  std::optional<DeviceTriangles> make_triangles(const backends::ViewPass& pass,
                                                const backends::Layers& layers,
                                                support::Diagnostics& diagnostics);
  /// Uploads the indices of the view's draws, unless the device has them. False if they are too many.
  bool upload_indices(const backends::ViewPass& pass);

  /// How a pipeline uses a program.
  enum class Use : uint8_t {
    vertices,
    setup,
    computed,
    screen,
    drawn_screen,
    blending,
    deep_blending,
    visibility,
    visibility_over,
    visibility_in_layers
  };
  /// The pipeline of a program, from `make` where it is not known yet.
  std::optional<uint32_t> pipeline_of(const driver::Program& program, Use use,
                                      const std::function<std::optional<uint32_t>()>& make);
  /// Of a post or a pixel program. `computes`: as a compute shader.
  std::optional<uint32_t> screen_pipeline(const driver::Program& program, bool computes,
                                          support::Diagnostics& diagnostics);

  VulkanOptions options_;
  std::unique_ptr<Device> device_;
  std::map<std::pair<uint64_t, Use>, uint32_t> pipeline_of_program_;  ///< by Program::number
  bool on_device_ = false;  ///< where the images of this frame are
  bool made_finite_ = true;
  /// The indices on the device: where the host has them, how many, and the revision of the vertices that they belong to.
  std::vector<std::pair<const uint32_t*, size_t>> indices_;
  uint64_t indices_revision_ = 0;
  Probe probe_;
  driver::Division division_ = driver::Division::exact;
};

/// Opens a device and probes it, unless the cache tells that it passed this probe before. Null, with a diagnostic, if there is no such device, or if it fails a check and the
/// options do not allow that. Not thread-safe.
std::unique_ptr<VulkanBackend> create(const VulkanOptions& options, support::Diagnostics& diagnostics);

}  // namespace isoshade::vulkan
