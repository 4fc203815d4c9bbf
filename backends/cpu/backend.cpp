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
#include "compiler/support/assert.h"
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
  explicit Buffers(const Frame* frame) : frame_(frame) {
    std::fill(std::begin(views_), std::end(views_), BufferView{&nothing, 1});
  }

  /// Reports an array that is too long to be indexed.
  template <class T>
  bool bind(FrameBuffer buffer, std::span<const T> words, Diagnostics& diagnostics) {
    if (words.size() > INT_MAX) {
      const backends::ArrayLimit limit{"the cpu backend", size_t{4} * INT_MAX, true};
      backends::report_too_large(buffer, words.size_bytes(), limit, frame_, diagnostics);
      return false;
    }
    BufferView& view = views_[static_cast<size_t>(buffer)];
    view = words.empty() ? BufferView{&nothing, 1} : BufferView{words.data(), static_cast<int>(words.size())};
    return true;
  }
  bool bind_frame(std::span<const float> vertices, Diagnostics& diagnostics) {
    return bind(FrameBuffer::vertices, vertices, diagnostics) &&
           bind<float>(FrameBuffer::objects, frame_->objects, diagnostics) &&
           bind<float>(FrameBuffer::lights, frame_->lights, diagnostics) &&
           bind<float>(FrameBuffer::frame, frame_->frame, diagnostics) &&
           bind<float>(FrameBuffer::view, frame_->view, diagnostics) &&
           bind<float>(FrameBuffer::texels, frame_->texels, diagnostics) &&
           bind<uint32_t>(FrameBuffer::texel_bytes, frame_->texel_bytes, diagnostics) &&
           bind<int32_t>(FrameBuffer::textures, frame_->textures, diagnostics);
  }
  const BufferView* views() const { return views_; }

 private:
  static constexpr int32_t nothing = 0;
  BufferView views_[std::size(lower::frame_buffers)];
  const Frame* frame_;
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
  std::unique_ptr<backends::Drawing> begin(const Frame& frame, std::span<const float> vertices,
                                           Diagnostics& diagnostics) override;
  bool post(const backends::ScreenPass& pass, std::vector<float>& rgba, Diagnostics& diagnostics) override;
  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override;

 private:
  friend class CpuDrawing;
  using FrameKernels = std::vector<const Kernel*>;  ///< of each program of a frame; null where not asked for

  /// Adds those kernels that are asked for and not there yet.
  bool find_kernels(const Frame& frame, const std::vector<bool>& asked, FrameKernels& kernels,
                    Diagnostics& diagnostics);

  KernelStore kernels_;
  Workers workers_;
  tbb::enumerable_thread_specific<std::unique_ptr<TilePainter>> painters_;
};

class CpuDrawing final : public backends::Drawing {
 public:
  CpuDrawing(CpuBackend& backend, const Frame& frame) : backend_(backend), frame_(frame), buffers_(&frame) {
    kernels_.resize(frame.programs.size());
  }
  bool bind(std::span<const float> vertices, Diagnostics& diagnostics) {
    return buffers_.bind_frame(vertices, diagnostics);
  }

  bool draw(const backends::Window& window, std::span<const int32_t> triangles, Image& image,
            Diagnostics& diagnostics) override;

 private:
  std::vector<bool> programs_of(std::span<const int32_t> triangles) const;

  CpuBackend& backend_;
  const Frame& frame_;
  Buffers buffers_;
  CpuBackend::FrameKernels kernels_;
};

bool CpuBackend::find_kernels(const Frame& frame, const std::vector<bool>& asked, FrameKernels& kernels,
                              Diagnostics& diagnostics) {
  std::vector<size_t> missing;
  std::vector<const Program*> programs;
  for (size_t i = 0; i < asked.size(); ++i) {
    if (!asked[i] || kernels[i] != nullptr) continue;
    missing.push_back(i);
    programs.push_back(frame.programs[i]);
  }
  if (missing.empty()) return true;
  const auto found = kernels_.kernels(programs, diagnostics);
  if (!found) return false;
  for (size_t i = 0; i < missing.size(); ++i) kernels[missing[i]] = (*found)[i];
  return true;
}

bool CpuBackend::transform(const Frame& frame, std::vector<std::vector<float>>& clip,
                           Diagnostics& diagnostics) {
  std::vector<bool> asked(frame.programs.size());
  for (const Draw& draw : frame.draws) asked[draw.vertex_program] = true;
  FrameKernels kernels(frame.programs.size());
  if (!find_kernels(frame, asked, kernels, diagnostics)) return false;
  Buffers buffers(&frame);
  if (!buffers.bind_frame(frame.vertices, diagnostics)) return false;

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
    kernels[draw.vertex_program]->vertex(buffers.views(), draw.object, draw.projected,
                                         static_cast<int>(draw.first_vertex + first), static_cast<int>(count),
                                         clip[d].data() + 4 * first);
  });
  return true;
}

std::unique_ptr<backends::Drawing> CpuBackend::begin(const Frame& frame, std::span<const float> vertices,
                                                     Diagnostics& diagnostics) {
  auto drawing = std::make_unique<CpuDrawing>(*this, frame);
  if (!drawing->bind(vertices, diagnostics)) return nullptr;
  return drawing;
}

std::vector<bool> CpuDrawing::programs_of(std::span<const int32_t> triangles) const {
  std::vector<bool> seen(frame_.programs.size());
  const size_t count = triangles.size() / lower::triangle_word::stride;
  int last_object = -1;
  for (size_t i = 0; i < count; ++i) {
    const int object = raster::triangle_at(triangles.data(), static_cast<int>(i)).object();
    if (object == last_object) continue;
    last_object = object;
    const auto program =
        static_cast<size_t>(frame_.objects[static_cast<size_t>(object) + lower::object_word::program]);
    support::assert_that(program < seen.size(), "an object has a program that the frame lacks");
    seen[program] = true;
  }
  return seen;
}

bool CpuDrawing::draw(const backends::Window& window, std::span<const int32_t> triangles, Image& image,
                      Diagnostics& diagnostics) {
  if (!buffers_.bind(FrameBuffer::triangles, triangles, diagnostics)) return false;
  if (!backend_.find_kernels(frame_, programs_of(triangles), kernels_, diagnostics)) return false;
  const size_t count = triangles.size() / lower::triangle_word::stride;
  const raster::TileGrid grid(raster::box_at(window.x, window.y, window.width, window.height));

  DrawJob job{frame_, grid, triangles, buffers_.views(), kernels_, {}, image};
  const size_t parts = (count + triangle_chunk - 1) / triangle_chunk;
  job.bins.resize(parts);
  backend_.workers_.for_each(parts, [&](size_t part) {
    const size_t first = part * triangle_chunk;
    job.bins[part] = raster::Bins(triangles, static_cast<int>(first),
                                  static_cast<int>(std::min(triangle_chunk, count - first)), grid);
  });

  image.resize(window.width, window.height);
  backend_.workers_.for_each(static_cast<size_t>(grid.count()), [&](size_t tile) {
    std::unique_ptr<TilePainter>& painter = backend_.painters_.local();
    if (!painter) painter = std::make_unique<TilePainter>();
    painter->paint(job, static_cast<int>(tile));
  });
  return true;
}

bool CpuBackend::post(const backends::ScreenPass& pass, std::vector<float>& rgba, Diagnostics& diagnostics) {
  const Program* const programs[] = {pass.program};
  const auto kernels = kernels_.kernels(programs, diagnostics);
  if (!kernels) return false;
  Buffers buffers(nullptr);
  const bool fits = buffers.bind(FrameBuffer::frame, pass.frame, diagnostics) &&
                    buffers.bind(FrameBuffer::view, pass.view, diagnostics) &&
                    buffers.bind(FrameBuffer::objects, pass.record, diagnostics) &&
                    buffers.bind(FrameBuffer::layers, pass.images, diagnostics) &&
                    buffers.bind(FrameBuffer::layer_records, pass.image_records, diagnostics);
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
  Buffers buffers(nullptr);
  if (!buffers.bind(FrameBuffer::inputs, inputs, diagnostics)) return false;
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

std::unique_ptr<backends::Backend> create(const CpuOptions& options, Diagnostics& diagnostics) {
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
  std::optional<Compiler> compiler = Compiler::find(options.compiler, diagnostics, options.build_timeout);
  if (!compiler) return nullptr;
  std::optional<Cache> cache = Cache::open(options.cache, diagnostics);
  if (!cache) return nullptr;
  return std::make_unique<CpuBackend>(
      KernelStore(std::move(*compiler), std::move(*cache), *lanes, options.cpp, options.keep),
      options.threads);
}

}  // namespace isoshade::cpu
