// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/backend.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <map>

#include "backends/shared.h"
#include "backends/vulkan/device.h"
#include "backends/vulkan/geometry.h"
#include "backends/vulkan/limits.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/target_limits.h"
#include "compiler/support/assert.h"
#include "compiler/support/visible.h"

namespace isoshade::vulkan {

namespace {

using backends::Draw;
using backends::Frame;
using backends::ViewPass;
using driver::Program;
using driver::Stage;
using lower::FrameBuffer;
using support::Diagnostics;

/// Uploads an array or reports that it is larger than the device allows. `frame`: the frame that owns it, or null.
template <class T>
bool upload_array(Device& device, FrameBuffer buffer, std::span<const T> data, const Frame* frame,
                  const backends::Known& known, Diagnostics& diagnostics) {
  if (data.size_bytes() > device.max_buffer_bytes()) {
    const backends::ArrayLimit limit{device.info().name, device.max_buffer_bytes()};
    backends::report_too_large(buffer, data.size_bytes(), limit, frame, diagnostics);
    return false;
  }
  device.upload(buffer, data.data(), data.size_bytes(), known);
  return true;
}

bool is_texture_array(FrameBuffer buffer) {
  return buffer == FrameBuffer::texels || buffer == FrameBuffer::texel_bytes || buffer == FrameBuffer::textures;
}

/// A post has a record and a view of its own; only textures are the frame's.
backends::Known known_of(const backends::ScreenPass& pass, FrameBuffer buffer) {
  return is_texture_array(buffer) && pass.textures != nullptr ? backends::known_of(*pass.textures, nullptr, buffer) : backends::Known{};
}

/// Where a texture lies may be known for the draw: then only its texels are read.
bool reads_textures(const Program& program) {
  return std::ranges::any_of(program.module.functions, [](const ir::Function& function) {
    return std::ranges::any_of(function.instructions, [](const ir::Instruction& made) {
      return made.op == ir::Opcode::load && is_texture_array(static_cast<FrameBuffer>(made.imm));
    });
  });
}

}  // namespace

bool moves_by_textures(const ViewPass& pass) {
  std::vector<bool> is_used(pass.frame.programs.size());
  for (const Draw& draw : pass.view.draws) is_used[draw.vertex_program] = true;
  for (size_t p = 0; p < is_used.size(); ++p)
    if (is_used[p] && reads_textures(*pass.frame.programs[p])) return true;
  return false;
}

namespace {

/// The vertices [first, first + count) of a draw.
struct VertexChunk {
  size_t draw;
  uint32_t first;
  uint32_t count;
  size_t output;  ///< where their positions go, in vertices
};

/// Cuts the draws into runs of at most `capacity` vertices.
std::vector<std::vector<VertexChunk>> vertex_runs(const std::vector<Draw>& draws, size_t capacity) {
  std::vector<std::vector<VertexChunk>> runs;
  size_t used = capacity;
  for (size_t d = 0; d < draws.size(); ++d) {
    uint32_t done = 0;
    while (done < draws[d].vertex_count) {
      if (used == capacity) {
        runs.emplace_back();
        used = 0;
      }
      const auto count =
          static_cast<uint32_t>(std::min<size_t>(draws[d].vertex_count - done, capacity - used));
      runs.back().push_back({d, done, count, used});
      done += count;
      used += count;
    }
  }
  return runs;
}

}  // namespace

VulkanBackend::VulkanBackend(VulkanOptions options, std::unique_ptr<Device> device)
    : options_(std::move(options)), device_(std::move(device)) {
  if (options_.glsl) return;
  options_.glsl = options_.eval_stage == EvalStage::vertex ? driver::glsl_with_vertex_eval : driver::glsl;
}

VulkanBackend::~VulkanBackend() = default;

const DeviceInfo& VulkanBackend::device() const { return device_->info(); }

std::string VulkanBackend::description() const {
  return device().name + ", " + device().driver + ", " +
         std::string(driver::name(division_)) + " division" +
         (device_->validates() ? ", validated" : "");
}

double VulkanBackend::build_seconds() const { return device_->build_seconds(); }

std::vector<backends::DeviceStep> VulkanBackend::device_steps() const {
  const std::optional<DeviceSeconds> seconds = device_seconds();
  if (!seconds) return {};
  return {{"vertices", seconds->vertices}, {"triangles", seconds->triangles}, {"visibility", seconds->visibility},
          {"shading", seconds->shading},   {"blending", seconds->layers},     {"posts", seconds->screen},
          {"copies", seconds->copies}};
}

std::optional<DeviceSeconds> VulkanBackend::device_seconds() const { return device_->seconds(); }

std::optional<std::string> VulkanBackend::text_of(const Program& program, Diagnostics& diagnostics,
                                                  bool computes) const {
  if (!driver::within_limits(program, driver::Target::vulkan, division_, diagnostics)) return std::nullopt;
  return computes ? driver::glsl_of_compute(program, division_) : options_.glsl(program, division_);
}

bool VulkanBackend::guarded(Diagnostics& diagnostics, const std::function<bool()>& work) {
  bool succeeded = false;
  try {
    succeeded = work();
  } catch (const std::exception& error) {
    diagnostics.report(support::Id::device_failed, device().name + ": " + error.what());
  }
  for (const std::string& message : device_->take_messages()) {
    diagnostics.report(support::Id::validation, support::visible(message));
    succeeded = false;
  }
  return succeeded;
}

bool VulkanBackend::upload(const ViewPass& pass, const backends::Layers& layers, std::span<const float> vertices,
                           bool knows_vertices, Diagnostics& diagnostics) {
  return backends::for_each_array(pass, layers, vertices, [&]<class T>(FrameBuffer buffer, std::span<const T> words) {
    const bool is_known = buffer != FrameBuffer::vertices || knows_vertices;
    const backends::Known known = is_known ? backends::known_of(pass.frame, &pass.view, buffer) : backends::Known{};
    return upload_array(*device_, buffer, words, &pass.frame, known, diagnostics);
  });
}

bool VulkanBackend::upload_textures(const Frame& frame, Diagnostics& diagnostics) {
  return backends::for_each_texture_array(frame, [&]<class T>(FrameBuffer buffer, std::span<const T> words) {
    return upload_array(*device_, buffer, words, &frame, backends::known_of(frame, nullptr, buffer), diagnostics);
  });
}

bool VulkanBackend::upload_triangles(const Frame& frame, std::span<const int32_t> triangles,
                                     Diagnostics& diagnostics) {
  return upload_array(*device_, FrameBuffer::triangles, triangles, &frame, {}, diagnostics);
}

bool VulkanBackend::vertex_pipelines(const ViewPass& pass,
                                     std::vector<std::optional<PipelineIndex>>& pipelines,
                                     Diagnostics& diagnostics) {
  pipelines.resize(pass.frame.programs.size());
  for (const Draw& draw : pass.view.draws) {
    std::optional<PipelineIndex>& pipeline = pipelines[draw.vertex_program];
    if (pipeline) continue;
    const Program& program = *pass.frame.programs[draw.vertex_program];
    pipeline = pipeline_of(program, Use::vertices, [&]() -> std::optional<PipelineIndex> {
      const bool computes = device_->computes();
      auto text = text_of(program, diagnostics, computes);
      if (!text) return std::nullopt;
      PipelineSource source{computes ? Output::row : Output::buffer, 0, std::move(*text), {}};
      source.what = driver::description(program);
      return device_->pipeline(source, diagnostics);
    });
    if (!pipeline) return false;
  }
  return true;
}

bool VulkanBackend::transform(const ViewPass& pass, support::Array<float>& clip, Diagnostics& diagnostics) {
  const Frame& frame = pass.frame;
  const std::vector<Draw>& draws = pass.view.draws;
  return guarded(diagnostics, [&] {
    if (!upload(pass, {}, frame.vertices, true, diagnostics)) return false;
    if (moves_by_textures(pass) && !upload_textures(frame, diagnostics)) return false;
    std::vector<std::optional<PipelineIndex>> pipelines;
    if (!vertex_pipelines(pass, pipelines, diagnostics)) return false;
    std::vector<size_t> places;  // of the first vertex of each draw
    size_t vertex_count = 0;
    for (const Draw& draw : draws) {
      places.push_back(vertex_count);
      vertex_count += draw.vertex_count;
    }
    clip.resize(4 * vertex_count);
    const size_t capacity = std::min(max_output_words, device_->max_buffer_bytes() / sizeof(int32_t)) / 4;
    std::vector<int32_t> output;
    const auto drawn = [&](const std::vector<VertexChunk>& run) {
      std::vector<Call> calls;
      for (const VertexChunk& chunk : run) {
        const Draw& draw = draws[chunk.draw];
        const uint32_t first = draw.first_vertex + chunk.first;
        calls.push_back({.pipeline = *pipelines[draw.vertex_program],
                         .push = {.object = draw.object,
                                  .light_count = frame.light_count,
                                  .first = static_cast<int32_t>(first),
                                  .count = static_cast<int32_t>(chunk.output),
                                  .projected = draw.projected},
                         .first_vertex = first,
                         .vertex_count = chunk.count,
                         .scissor = {0, 0, 1, 1}});
      }
      return calls;
    };
    const auto computed = [&](const std::vector<VertexChunk>& run) {
      std::map<size_t, Table> tables;  // by the vertex program
      for (const VertexChunk& chunk : run) {
        const Draw& draw = draws[chunk.draw];
        tables[draw.vertex_program].add(
            chunk.count, {draw.first_vertex + chunk.first, chunk.output, static_cast<size_t>(draw.object),
                          static_cast<size_t>(draw.projected)});
      }
      std::vector<int32_t> inputs;
      std::vector<Call> calls;
      for (const auto& [p, table] : tables) {
        calls.push_back(table.call(*pipelines[p], inputs.size()));
        inputs.insert(inputs.end(), table.words().begin(), table.words().end());
      }
      device_->upload(FrameBuffer::inputs, inputs.data(), inputs.size() * sizeof(int32_t));
      return calls;
    };
    for (const std::vector<VertexChunk>& run : vertex_runs(draws, capacity)) {
      const std::vector<Call> calls = device_->computes() ? computed(run) : drawn(run);
      output.resize(4 * (run.back().output + run.back().count));
      device_->run_vertices(calls, output);
      for (const VertexChunk& chunk : run)
        std::memcpy(clip.data() + 4 * (places[chunk.draw] + chunk.first), output.data() + 4 * chunk.output,
                    size_t{4} * chunk.count * sizeof(float));
    }
    return true;
  });
}

/// Reports images that are larger than the device can make.
bool VulkanBackend::check_size(int width, int height, Diagnostics& diagnostics) const {
  if (std::max(width, height) <= device_->max_frame_side()) return true;
  diagnostics
      .report(support::Id::device_limit,
              "the image has " + std::to_string(width) + "x" + std::to_string(height) + " pixels; " +
                  device().name + " makes at most " + std::to_string(device_->max_frame_side()) + " a side")
      .suggest("make a smaller image with --size; or draw it with --backend cpu");
  return false;
}

bool VulkanBackend::reserve(size_t floats, Diagnostics& diagnostics) {
  made_finite_ = true;
  if (!HostBackend::reserve(floats, diagnostics)) return false;
  on_device_ = floats * sizeof(float) <= device_->max_buffer_bytes();
  if (!on_device_) return true;
  return guarded(diagnostics, [&] {
    device_->reserve_layers(floats * sizeof(float));
    return true;
  });
}

void VulkanBackend::write(size_t first, std::span<const float> floats) {
  if (on_device_)
    device_->write_layers(first * sizeof(float), floats.data(), floats.size_bytes());
  else
    HostBackend::write(first, floats);
}

std::span<const float> VulkanBackend::read(const backends::Slot& slot) {
  if (on_device_)
    device_->read_layers(slot.first * sizeof(float), layers_.data() + slot.first, slot.size() * sizeof(float));
  return HostBackend::read(slot);
}

std::optional<PipelineIndex> VulkanBackend::pipeline_of(const Program& program, Use use,
                                                        const std::function<std::optional<PipelineIndex>()>& make) {
  const std::pair key{program.number, use};
  if (const auto found = pipeline_of_program_.find(key); found != pipeline_of_program_.end()) return found->second;
  const std::optional<PipelineIndex> made = make();
  if (made && program.number != 0) pipeline_of_program_[key] = *made;
  return made;
}

std::optional<PipelineIndex> VulkanBackend::screen_pipeline(const Program& program, bool computes,
                                                            Diagnostics& diagnostics) {
  return pipeline_of(
      program, computes ? Use::screen : Use::drawn_screen, [&]() -> std::optional<PipelineIndex> {
        auto text = text_of(program, diagnostics, computes);
        if (!text) return std::nullopt;
        PipelineSource source =
            computes ? PipelineSource{Output::pixels, 0, std::move(*text), {}}
                     : PipelineSource{Output::color, 1, full_screen_vertex(), std::move(*text)};
        source.what = driver::description(program);
        return device_->pipeline(source, diagnostics);
      });
}

bool VulkanBackend::post(std::span<const backends::ScreenPass> passes, const backends::Slot& made,
                         Diagnostics& diagnostics) {
  if (!on_device_) return HostBackend::post(passes, made, diagnostics);
  return guarded(diagnostics, [&] {
    if (!check_size(made.width, made.height, diagnostics) || !device_->prepare_own_shaders(diagnostics))
      return false;
    for (const backends::ScreenPass& pass : passes) {
      const std::vector<int32_t> records = backends::image_records(pass.width, pass.height, pass.images);
      const auto upload = [&]<class T>(FrameBuffer buffer, std::span<const T> words) {
        return upload_array(*device_, buffer, words, nullptr, known_of(pass, buffer), diagnostics);
      };
      if (!backends::for_each_array(pass, {{}, records}, upload)) return false;
      const auto pipeline = screen_pipeline(*pass.program, device_->computes(), diagnostics);
      if (!pipeline) return false;
      if (!device_->run_screen(*pipeline, made.width, made.height, made.first * sizeof(float)))
        made_finite_ = false;
    }
    return true;
  });
}

bool VulkanBackend::screen(const backends::ScreenPass& pass, const backends::Layers& layers, int first_row, int rows,
                           std::vector<float>& rgba, Diagnostics& diagnostics) {
  return guarded(diagnostics, [&] {
    const auto upload = [&]<class T>(FrameBuffer buffer, std::span<const T> words) {
      return upload_array(*device_, buffer, words, nullptr, known_of(pass, buffer), diagnostics);
    };
    if (!check_size(pass.width, first_row + rows, diagnostics) || !backends::for_each_array(pass, layers, upload))
      return false;
    const auto pipeline = screen_pipeline(*pass.program, false, diagnostics);
    if (!pipeline) return false;
    rgba.resize(size_t{4} * static_cast<size_t>(pass.width) * static_cast<size_t>(rows));
    device_->run_screen(*pipeline, pass.width, rows, first_row, rgba);
    return true;
  });
}

bool VulkanBackend::evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                             std::vector<int32_t>& outputs, Diagnostics& diagnostics) {
  const size_t input_words = backends::word_count(program.inputs);
  const size_t result_words = backends::word_count(program.results);
  support::assert_that(inputs.size() == rows * input_words, "an eval table of a wrong size");
  const bool in_vertex = options_.eval_stage == EvalStage::vertex;
  if (result_words > max_result_words && !in_vertex) {
    diagnostics
        .report(support::Id::device_limit,
                "function " + support::quote(program.name) + " gives " + std::to_string(result_words) +
                    " words; on vulkan eval takes at most " + std::to_string(max_result_words))
        .suggest("evaluate it with --backend cpu");
    return false;
  }
  outputs.resize(rows * result_words);
  if (outputs.empty()) return true;

  return guarded(diagnostics, [&] {
    const auto attachments = static_cast<uint32_t>((result_words + 3) / 4);
    auto text = text_of(program, diagnostics);
    if (!text) return false;
    PipelineSource source =
        in_vertex ? PipelineSource{Output::buffer, 0, std::move(*text), {}}
                  : PipelineSource{Output::words, attachments, full_screen_vertex(), std::move(*text)};
    source.what = driver::description(program);
    const auto pipeline = device_->pipeline(source, diagnostics);
    if (!pipeline) return false;

    const size_t largest_record = std::max({input_words, result_words, size_t{1}}) * sizeof(int32_t);
    const size_t chunk = std::min(max_table_rows, device_->max_buffer_bytes() / largest_record);
    for (size_t first = 0; first < rows; first += chunk) {
      const size_t count = std::min(chunk, rows - first);
      device_->upload(FrameBuffer::inputs, inputs.data() + first * input_words,
                      count * input_words * sizeof(int32_t));
      int32_t* results = outputs.data() + first * result_words;
      if (in_vertex)
        device_->run_vertices(std::array{Call{.pipeline = *pipeline,
                                              .push = {.count = static_cast<int32_t>(count)},
                                              .vertex_count = static_cast<uint32_t>(count),
                                              .scissor = {0, 0, 1, 1}}},
                              {results, count * result_words});
      else
        device_->run_table(*pipeline, attachments, count, result_words, {results, count * result_words});
    }
    return true;
  });
}

std::unique_ptr<VulkanBackend> create(const VulkanOptions& options, Diagnostics& diagnostics) {
  try {
    auto device = Device::open(options, diagnostics);
    if (!device) return nullptr;
    std::unique_ptr<VulkanBackend> backend(new VulkanBackend(options, std::move(device)));
    const bool ran = backend->guarded(diagnostics, [&] {
      Device& opened = *backend->device_;
      auto probe = options.probe_anew ? std::nullopt : opened.disk_cache().probe(opened.identity());
      if (!probe) {
        probe = run_probe(opened, diagnostics);
        if (!probe) return false;
        opened.disk_cache().keep(*probe, opened.identity());
      }
      backend->probe_ = std::move(*probe);
      return true;
    });
    if (!ran) return nullptr;
    backend->division_ = options.division.value_or(backend->probe_.division);
    if (backend->probe_.passed() || options.allow_unproven) return backend;
    report_unproven(backend->probe_, backend->device().name, diagnostics);
  } catch (const std::exception& error) { report_unusable(error.what(), diagnostics); }
  return nullptr;
}

}  // namespace isoshade::vulkan
