// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/backend.h"

#include <algorithm>
#include <climits>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>
#include <utility>

#include "backends/array_limit.h"
#include "backends/cpu/shade.h"
#include "backends/cpu/workers.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/check.h"
#include "compiler/support/visible.h"
#include "runtime/raster/triangle.h"

namespace isoshade::cpu {
namespace {

using backends::Draw;
using backends::Frame;
using backends::Image;
using driver::Program;
using lower::FrameBuffer;
using support::Diagnostics;
using support::Id;

constexpr size_t vertex_chunk = 2048;
constexpr size_t row_chunk = 2048;
constexpr size_t triangle_chunk = 8192;

/// The arrays of a call, of which generated code reads none beyond its end.
class Buffers {
 public:
  /// `frame`: that of the arrays, if they are of one.
  Buffers(const Frame* frame, Diagnostics& diagnostics) : frame_(frame), diagnostics_(diagnostics) {
    std::fill(std::begin(views_), std::end(views_), BufferView{&nothing, 1});
  }

  /// Reports an array that is too long to be indexed.
  template <class T>
  bool bind(FrameBuffer buffer, std::span<const T> words) {
    if (words.size() > INT_MAX) {
      const backends::ArrayLimit limit{"the cpu backend", size_t{4} * INT_MAX, true};
      backends::report_too_large(buffer, words.size_bytes(), limit, frame_, diagnostics_);
      return false;
    }
    if (!words.empty()) views_[static_cast<size_t>(buffer)] = {words.data(), static_cast<int>(words.size())};
    return true;
  }
  bool bind_frame(std::span<const float> vertices) {
    return bind(FrameBuffer::vertices, vertices) && bind<float>(FrameBuffer::objects, frame_->objects) &&
           bind<float>(FrameBuffer::lights, frame_->lights) &&
           bind<float>(FrameBuffer::frame, frame_->frame) &&
           bind<float>(FrameBuffer::texels, frame_->texels) &&
           bind<uint32_t>(FrameBuffer::texel_bytes, frame_->texel_bytes) &&
           bind<int32_t>(FrameBuffer::textures, frame_->textures);
  }
  const BufferView* views() const { return views_; }

 private:
  static constexpr int32_t nothing = 0;
  BufferView views_[std::size(lower::frame_buffers)];
  const Frame* frame_;
  Diagnostics& diagnostics_;
};

size_t words(const std::vector<driver::Field>& fields) {
  return std::accumulate(fields.begin(), fields.end(), size_t{0}, [](size_t sum, const driver::Field& field) {
    return sum + static_cast<size_t>(field.words);
  });
}

class CpuBackend final : public backends::Backend {
 public:
  CpuBackend(KernelStore kernels, int threads) : kernels_(std::move(kernels)), workers_(threads) {}

  std::string_view name() const override { return "cpu"; }
  std::string description() const override {
    return kernels_.compiler().version() + ", lanes " + std::string(kernels_.lanes().name) + ", " +
           std::to_string(workers_.count()) + (workers_.count() == 1 ? " thread" : " threads") +
           ", native division";
  }
  double build_seconds() const override { return kernels_.seconds(); }

  bool transform(const Frame& frame, std::vector<std::vector<float>>& clip,
                 Diagnostics& diagnostics) override;
  bool draw(const Frame& frame, std::span<const float> vertices, std::span<const int32_t> triangles,
            Image& image, Diagnostics& diagnostics) override;
  bool post(const backends::ScreenPass& pass, std::vector<float>& rgba, Diagnostics& diagnostics) override;
  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override;

 private:
  /// The kernels of those programs of the frame that are asked for, at their places; null elsewhere.
  std::optional<std::vector<const Kernel*>> kernels_of(const Frame& frame, const std::vector<bool>& asked,
                                                       Diagnostics& diagnostics);

  KernelStore kernels_;
  Workers workers_;
  tbb::enumerable_thread_specific<std::unique_ptr<TilePainter>> painters_;
};

std::optional<std::vector<const Kernel*>> CpuBackend::kernels_of(const Frame& frame,
                                                                 const std::vector<bool>& asked,
                                                                 Diagnostics& diagnostics) {
  std::vector<const Program*> programs;
  for (size_t i = 0; i < asked.size(); ++i)
    if (asked[i]) programs.push_back(frame.programs[i]);
  const auto found = kernels_.kernels(programs, diagnostics);
  if (!found) return std::nullopt;
  std::vector<const Kernel*> result(asked.size());
  auto next = found->begin();
  for (size_t i = 0; i < asked.size(); ++i)
    if (asked[i]) result[i] = *next++;
  return result;
}

bool CpuBackend::transform(const Frame& frame, std::vector<std::vector<float>>& clip,
                           Diagnostics& diagnostics) {
  std::vector<bool> asked(frame.programs.size());
  for (const Draw& draw : frame.draws) asked[draw.vertex_program] = true;
  const auto kernels = kernels_of(frame, asked, diagnostics);
  if (!kernels) return false;
  Buffers buffers(&frame, diagnostics);
  if (!buffers.bind_frame(frame.vertices)) return false;

  struct Task {
    size_t draw;
    size_t first;
  };
  std::vector<Task> tasks;
  clip.resize(frame.draws.size());
  for (size_t d = 0; d < frame.draws.size(); ++d) {
    const size_t count = frame.draws[d].vertex_count;
    clip[d].resize(4 * count);
    for (size_t first = 0; first < count; first += vertex_chunk) tasks.push_back({d, first});
  }
  workers_.for_each(tasks.size(), [&](size_t i) {
    const auto [d, first] = tasks[i];
    const Draw& draw = frame.draws[d];
    const size_t count = std::min(vertex_chunk, draw.vertex_count - first);
    (*kernels)[draw.vertex_program]->vertex(buffers.views(), draw.object,
                                            static_cast<int>(draw.first_vertex + first),
                                            static_cast<int>(count), clip[d].data() + 4 * first);
  });
  return true;
}

bool CpuBackend::draw(const Frame& frame, std::span<const float> vertices, std::span<const int32_t> triangles,
                      Image& image, Diagnostics& diagnostics) {
  Buffers buffers(&frame, diagnostics);
  if (!buffers.bind_frame(vertices) || !buffers.bind(FrameBuffer::triangles, triangles)) return false;
  const size_t count = triangles.size() / lower::triangle_word::stride;

  DrawJob job{frame, triangles, buffers.views(), {}, {}, image};
  const size_t parts = (count + triangle_chunk - 1) / triangle_chunk;
  job.bins.resize(parts);
  workers_.for_each(parts, [&](size_t part) {
    const size_t first = part * triangle_chunk;
    job.bins[part] =
        raster::Bins(triangles, static_cast<int>(first),
                     static_cast<int>(std::min(triangle_chunk, count - first)), frame.width, frame.height);
  });

  std::vector<bool> asked(frame.programs.size());
  int last_object = -1;
  for (size_t i = 0; i < count; ++i) {
    const int object = raster::triangle_at(triangles.data(), static_cast<int>(i)).object();
    if (object == last_object) continue;
    last_object = object;
    const auto program =
        static_cast<size_t>(frame.objects[static_cast<size_t>(object) + lower::object_word::program]);
    support::check(program < asked.size(), "an object has a program that the frame lacks");
    asked[program] = true;
  }
  auto kernels = kernels_of(frame, asked, diagnostics);
  if (!kernels) return false;
  job.kernels = std::move(*kernels);

  image.resize(frame.width, frame.height);
  const raster::TileGrid grid(frame.width, frame.height);
  workers_.for_each(static_cast<size_t>(grid.count()), [&](size_t i) {
    std::unique_ptr<TilePainter>& painter = painters_.local();
    if (!painter) painter = std::make_unique<TilePainter>();
    const int tile = static_cast<int>(i);
    painter->paint(job, tile, tile % grid.columns * raster::tile_size,
                   tile / grid.columns * raster::tile_size);
  });
  return true;
}

bool CpuBackend::post(const backends::ScreenPass& pass, std::vector<float>& rgba, Diagnostics& diagnostics) {
  const Program* const programs[] = {pass.program};
  const auto kernels = kernels_.kernels(programs, diagnostics);
  if (!kernels) return false;
  Buffers buffers(nullptr, diagnostics);
  const bool fits = buffers.bind(FrameBuffer::frame, pass.frame) &&
                    buffers.bind(FrameBuffer::objects, pass.record) &&
                    buffers.bind(FrameBuffer::layers, pass.images) &&
                    buffers.bind(FrameBuffer::layer_records, pass.image_records);
  if (!fits) return false;
  const auto width = static_cast<size_t>(pass.width), height = static_cast<size_t>(pass.height);
  rgba.resize(4 * width * height);
  // Rows that follow each other read almost the same pixels.
  const size_t rows = std::max<size_t>(1, row_chunk / width);
  workers_.for_each((height + rows - 1) / rows, [&](size_t chunk) {
    for (size_t y = chunk * rows; y < std::min(height, (chunk + 1) * rows); ++y)
      kernels->front()->post(buffers.views(), 0, static_cast<int>(y), pass.width,
                             rgba.data() + 4 * width * y);
  });
  return true;
}

bool CpuBackend::evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                          std::vector<int32_t>& outputs, Diagnostics& diagnostics) {
  const Program* const programs[] = {&program};
  const auto kernels = kernels_.kernels(programs, diagnostics);
  if (!kernels) return false;
  if (rows > INT_MAX) {
    diagnostics
        .report(Id::device_limit, "the table has " + std::to_string(rows) +
                                      " rows; the cpu backend takes at most " + std::to_string(INT_MAX))
        .suggest("evaluate fewer rows at a time");
    return false;
  }
  Buffers buffers(nullptr, diagnostics);
  if (!buffers.bind(FrameBuffer::inputs, inputs)) return false;
  const size_t width = words(program.results);
  outputs.resize(rows * width);
  const size_t chunks = (rows + row_chunk - 1) / row_chunk;
  workers_.for_each(chunks, [&](size_t chunk) {
    const size_t first = chunk * row_chunk;
    kernels->front()->eval(buffers.views(), static_cast<int>(first),
                           static_cast<int>(std::min(row_chunk, rows - first)),
                           outputs.data() + first * width);
  });
  return true;
}

}  // namespace

std::unique_ptr<backends::Backend> create(const Options& options, Diagnostics& diagnostics) {
  const std::optional<LaneCount> lanes =
      options.lanes.empty() ? widest_lane_count() : lane_count(options.lanes);
  if (!lanes || !lanes->available()) {
    support::Diagnostic& report = diagnostics.report(
        Id::bad_lanes, lanes ? "this machine has no registers of " + std::to_string(lanes->lanes) + " lanes"
                             : "there is no lane count " + support::quote(options.lanes));
    std::string choices;
    for (const LaneCount& choice : lane_counts())
      if (choice.available()) choices += (choices.empty() ? "" : ", ") + std::string(choice.name);
    report.suggest("choose one of " + choices);
    return nullptr;
  }
  std::optional<Compiler> compiler = Compiler::find(options.compiler, diagnostics);
  if (!compiler) return nullptr;
  std::optional<Cache> cache = Cache::open(options.cache, diagnostics);
  if (!cache) return nullptr;
  return std::make_unique<CpuBackend>(
      KernelStore(std::move(*compiler), std::move(*cache), *lanes, options.cpp, options.keep),
      options.threads);
}

}  // namespace isoshade::cpu
