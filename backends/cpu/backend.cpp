// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/backend.h"

#include <algorithm>
#include <atomic>
#include <climits>
#include <cstring>
#include <optional>
#include <tbb/enumerable_thread_specific.h>
#include <utility>

#include "backends/cpu/shade.h"
#include "backends/interpreter/buffers.h"
#include "backends/resolve.h"
#include "backends/shared.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "compiler/support/visible.h"
#include "runtime/raster/triangle.h"

namespace isoshade::cpu {
namespace {

using backends::Cache;
using backends::Draw;
using backends::Frame;
using backends::Drawing;
using backends::ImageRead;
using backends::Layers;
using backends::ScreenPass;
using backends::Slot;
using backends::ViewPass;
using driver::Program;
using interpreter::Buffers;
using lower::FrameBuffer;
using support::Diagnostics;
using support::Id;

constexpr size_t vertex_chunk = 2048;
constexpr size_t row_chunk = 2048;
constexpr size_t triangle_chunk = 8192;

constexpr std::string_view taker = "the cpu backend";

class CpuBackend final : public backends::Backend {
 public:
  CpuBackend(KernelStore kernels, int threads) : Backend(threads), kernels_(std::move(kernels)) {}

  std::string_view name() const override { return "cpu"; }
  std::string description() const override {
    const int count = workers().count();
    return kernels_.description() + ", " + std::to_string(count) + (count == 1 ? " thread" : " threads") +
           ", native division";
  }
  double build_seconds() const override { return kernels_.seconds(); }

  bool reserve(size_t floats, Diagnostics& diagnostics) override;
  void write(size_t first, std::span<const float> floats) override {
    forget_empty(first, floats.size());
    std::ranges::copy(floats, layers_.begin() + static_cast<ptrdiff_t>(first));
  }
  std::span<const float> read(const Slot& slot) override { return std::span(layers_).subspan(slot.first, slot.size()); }
  bool is_finite() override { return is_finite_; }
  backends::TileCounts tile_counts() const override {
    backends::TileCounts counts;
    for (const std::unique_ptr<TilePainter>& painter : painters_)
      if (painter) counts += painter->counts();
    return counts;
  }
  bool transform(const ViewPass& pass, support::Array<float>& clip, Diagnostics& diagnostics) override;
  bool draw(const Drawing& drawing, Diagnostics& diagnostics) override;
  bool post(std::span<const ScreenPass> passes, const Slot& made, Diagnostics& diagnostics) override;
  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override;

 private:
  using FrameKernels =
      std::vector<const Kernel*>;  ///< one for each program of a frame; null until it is needed

  /// Adds the kernels that are asked for and still missing.
  bool find_kernels(const Frame& frame, const std::vector<bool>& asked, FrameKernels& kernels,
                    Diagnostics& diagnostics);
  /// Full-screen passes with their kernels and arrays.
  struct Screens {
    std::vector<std::vector<int32_t>> records;
    std::vector<Buffers> buffers;
    std::vector<const Kernel*> kernels;
  };
  bool bind(std::span<const ScreenPass> passes, Screens& screens, Diagnostics& diagnostics);

  /// The tiles of an image that were empty when it was drawn. Where the next frame draws nothing either, as around what a
  /// shadow map shows, they are not written again: 64 MiB for a map of 4096 x 4096.
  struct EmptyTiles {
    Slot depth, color;
    int side;  ///< DrawJob::side
    float pixel[4];
    std::vector<uint8_t> tiles;
  };
  /// What is known of the image that is about to be drawn, whose pixels of empty tiles are these.
  uint8_t* find_empty(const Drawing& drawing, const EmptyPixel& pixel, const raster::TileGrid& grid);
  /// Something else is about to be written there.
  void forget_empty(size_t first, size_t floats) {
    const auto overlaps = [&](const Slot& slot) {
      return slot.exists() && slot.first < first + floats && first < slot.first + slot.size();
    };
    std::erase_if(empty_, [&](const EmptyTiles& known) { return overlaps(known.depth) || overlaps(known.color); });
  }

  void forget_images(const Drawing& drawing) {
    forget_empty(drawing.depth.first, drawing.depth.size());
    if (drawing.color.exists()) forget_empty(drawing.color.first, drawing.color.size());
  }

  KernelStore kernels_;
  raster::Bins bins_;  ///< of the window that is drawn
  std::vector<EmptyTiles> empty_;
  tbb::enumerable_thread_specific<std::unique_ptr<TilePainter>> painters_;
  support::Array<float> layers_;
  std::atomic<bool> is_finite_ = true;  ///< what has been made since reserve()
};

bool CpuBackend::reserve(size_t floats, Diagnostics& diagnostics) {
  is_finite_ = true;
  if (floats > INT_MAX) {
    const backends::ArrayLimit limit{"the cpu backend", size_t{4} * INT_MAX, true};
    backends::report_too_large(FrameBuffer::layers, floats * sizeof(float), limit, nullptr, diagnostics);
    return false;
  }
  if (floats != layers_.size()) empty_.clear();
  if (floats > layers_.capacity()) {
    support::release(layers_);  // or growing would copy what is lost
    layers_.resize(floats);
    support::use_huge_pages(layers_.data(), floats * sizeof(float));
  }
  layers_.resize(floats);
  return true;
}

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

bool CpuBackend::transform(const ViewPass& pass, support::Array<float>& clip, Diagnostics& diagnostics) {
  const Frame& frame = pass.frame;
  const std::vector<Draw>& draws = pass.view.draws;
  std::vector<bool> asked(frame.programs.size());
  for (const Draw& draw : draws) asked[draw.vertex_program] = true;
  FrameKernels kernels(frame.programs.size());
  if (!find_kernels(frame, asked, kernels, diagnostics)) return false;
  Buffers buffers(taker, &frame);
  if (!buffers.bind(pass, {}, frame.vertices, diagnostics)) return false;

  struct Task {
    size_t draw;
    size_t first;
    size_t place;  ///< of its positions
  };
  std::vector<Task> tasks;
  size_t vertices = 0;
  for (size_t d = 0; d < draws.size(); ++d) {
    const size_t count = draws[d].vertex_count;
    for (size_t first = 0; first < count; first += vertex_chunk) tasks.push_back({d, first, vertices + first});
    vertices += count;
  }
  clip.resize(4 * vertices);
  workers().for_each(tasks.size(), [&](size_t i) {
    const auto [d, first, place] = tasks[i];
    const Draw& draw = draws[d];
    const size_t count = std::min(vertex_chunk, draw.vertex_count - first);
    kernels[draw.vertex_program]->vertex(buffers.views(), draw.object, draw.projected,
                                         static_cast<int>(draw.first_vertex + first), static_cast<int>(count),
                                         clip.data() + 4 * place);
  });
  return true;
}

/// Which programs the triangles [first, end) of a view need.
std::vector<bool> programs_of(const ViewPass& pass, std::span<const int32_t> triangles, size_t first, size_t end) {
  std::vector<bool> seen(pass.frame.programs.size());
  const bool has_color = pass.view.target.has_color;
  if (!has_color && pass.frame.cutouts.empty()) return seen;
  int last_object = -1;
  for (size_t i = first; i < end; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), static_cast<int>(i));
    const int object = triangle.object();
    if (object == last_object) continue;
    last_object = object;
    if (has_color) seen[backends::pixel_program_of(pass.frame, object)] = true;
    if (triangle.cutout()) seen[backends::cutout_program_of(pass.frame, object)] = true;
  }
  return seen;
}

bool CpuBackend::bind(std::span<const ScreenPass> passes, Screens& screens, Diagnostics& diagnostics) {
  std::vector<const Program*> programs;
  for (const ScreenPass& pass : passes) {
    programs.push_back(pass.program);
    screens.records.push_back(backends::image_records(pass.width, pass.height, pass.images));
  }
  for (size_t i = 0; i < passes.size(); ++i)
    if (!screens.buffers.emplace_back(taker, nullptr).bind(passes[i], {layers_, screens.records[i]}, diagnostics)) return false;
  auto kernels = kernels_.kernels(programs, diagnostics);
  if (kernels) screens.kernels = *std::move(kernels);
  return kernels.has_value();
}

uint8_t* CpuBackend::find_empty(const Drawing& drawing, const EmptyPixel& pixel, const raster::TileGrid& grid) {
  const auto known = std::ranges::find_if(empty_, [&](const EmptyTiles& last) {
    return last.depth == drawing.depth && last.color == drawing.color && last.side == drawing.side &&
           std::memcmp(last.pixel, pixel.color, sizeof pixel.color) == 0;
  });
  if (known != empty_.end()) return known->tiles.data();
  forget_images(drawing);
  EmptyTiles& made = empty_.emplace_back(EmptyTiles{drawing.depth, drawing.color, drawing.side, {}, {}});
  std::ranges::copy(pixel.color, made.pixel);
  made.tiles.resize(static_cast<size_t>(grid.count()));
  return made.tiles.data();
}

bool CpuBackend::draw(const Drawing& drawing, Diagnostics& diagnostics) {
  const auto& [frame, view, images] = drawing.pass;
  const std::span<const int32_t> triangles = drawing.triangles;
  const backends::Window& window = drawing.window;
  const std::vector<int32_t> records = backends::image_records(view.target.width, view.target.height, images);
  Buffers buffers(taker, &frame);
  FrameKernels kernels(frame.programs.size());
  Screens posts;
  if (!buffers.bind(drawing.pass, {layers_, records}, drawing.vertices, diagnostics) ||
      !buffers.bind(FrameBuffer::triangles, triangles, diagnostics) || !bind(drawing.posts, posts, diagnostics))
    return false;
  const size_t count = triangles.size() / lower::triangle_word::stride;
  const raster::TileGrid grid(raster::box_at(window.x, window.y, window.width, window.height));

  std::vector<TilePost> tile_posts;
  for (size_t i = 0; i < drawing.posts.size(); ++i)
    tile_posts.push_back({*posts.kernels[i], posts.buffers[i].views(), posts.records[i], drawing.posts[i].keeps_background_plain});
  std::optional<EmptyPixel> empty;
  if (drawing.skips_tiles) {
    const lanes::FpGuard guard;
    empty = empty_pixel(view, tile_posts, drawing.side);
  }
  if (!empty) forget_images(drawing);
  const DrawJob job{.frame = frame,
                    .view = view,
                    .grid = grid,
                    .triangles = triangles,
                    .opaque = raster::opaque_count(triangles.data(), static_cast<int>(count)),
                    .buffers = buffers.views(),
                    .kernels = kernels,
                    .side = drawing.side,
                    .posts = tile_posts,
                    .skips_tiles = drawing.skips_tiles,
                    .empty = empty ? &*empty : nullptr,
                    .filled = empty ? find_empty(drawing, *empty, grid) : nullptr,
                    .color = drawing.color.exists() ? layers_.data() + drawing.color.first : nullptr,
                    .depth = layers_.data() + drawing.depth.first,
                    .width = drawing.depth.width,
                    .bins = bins_};
  bins_.sort(triangles, grid, workers());
  const size_t parts = (count + triangle_chunk - 1) / triangle_chunk;
  std::vector<std::vector<bool>> programs(parts);
  workers().for_each(parts, [&](size_t part) {
    const size_t first = part * triangle_chunk;
    programs[part] = programs_of(drawing.pass, triangles, first, std::min(first + triangle_chunk, count));
  });
  std::vector<bool> asked(frame.programs.size());
  for (const std::vector<bool>& seen : programs)
    for (size_t p = 0; p < asked.size(); ++p) asked[p] = asked[p] || seen[p];
  if (!find_kernels(frame, asked, kernels, diagnostics)) return false;

  workers().for_each(static_cast<size_t>(grid.count()), [&](size_t tile) {
    std::unique_ptr<TilePainter>& painter = painters_.local();
    if (!painter) painter = std::make_unique<TilePainter>();
    if (!painter->paint(job, static_cast<int>(tile))) is_finite_ = false;
  });
  return true;
}

bool CpuBackend::post(std::span<const ScreenPass> passes, const Slot& made, Diagnostics& diagnostics) {
  Screens screens;
  if (!bind(passes, screens, diagnostics)) return false;
  forget_empty(made.first, made.size());
  const auto width = static_cast<size_t>(made.width), height = static_cast<size_t>(made.height);
  // A task takes consecutive rows, because these read almost the same pixels.
  const size_t rows = std::max<size_t>(1, row_chunk / width);
  workers().for_each((height + rows - 1) / rows, [&](size_t chunk) {
    for (size_t y = chunk * rows; y < std::min(height, (chunk + 1) * rows); ++y) {
      float* const row = layers_.data() + made.first + 4 * width * y;
      for (size_t i = 0; i < passes.size(); ++i) {
        screens.kernels[i]->post(screens.buffers[i].views(), 0, static_cast<int>(y), made.width, row);
        if (!backends::is_finite({row, 4 * width})) is_finite_ = false;
      }
    }
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
  Buffers buffers(taker, nullptr);
  if (!buffers.bind(FrameBuffer::inputs, inputs, diagnostics)) return false;
  const size_t width = backends::word_count(program.results);
  outputs.resize(rows * width);
  const size_t chunks = (rows + row_chunk - 1) / row_chunk;
  workers().for_each(chunks, [&](size_t chunk) {
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
  std::optional<Toolchain> toolchain;
  if (options.execution != Execution::interpreted) {
    std::optional<Compiler> compiler = Compiler::find(options.compiler, diagnostics, options.build_timeout);
    if (!compiler) return nullptr;
    std::optional<Cache> cache = Cache::open(options.cache, diagnostics);
    if (!cache) return nullptr;
    toolchain.emplace(Toolchain{std::move(*compiler), std::move(*cache), *lanes});
  }
  return std::make_unique<CpuBackend>(
      KernelStore(std::move(toolchain), options.execution, options.cpp, options.keep), options.threads);
}

}  // namespace isoshade::cpu
