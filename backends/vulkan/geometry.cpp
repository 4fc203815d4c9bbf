// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/geometry.h"

#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include "backends/shared.h"
#include "backends/vulkan/backend.h"
#include "backends/vulkan/device.h"
#include "compiler/driver/driver.h"
#include "compiler/lower/setup.h"
#include "compiler/support/assert.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::vulkan {

namespace {

using backends::Draw;
using backends::Frame;
using backends::ViewPass;
using lower::FrameBuffer;
using support::Diagnostics;

/// What is left of a triangle that is cut: of six planes each adds at most one corner, and makes at most two.
constexpr size_t most_left = 7, most_made = 12;
static_assert(most_left < 1 << glsl::order_bits);

/// A draw, and where its positions, indices and triangles begin on the device.
struct Part {
  const Draw* draw;
  raster::Surface surface;
  uint32_t first_position, first_index, first_triangle;
  size_t surface_words = 0;  ///< where its record begins in `inputs`
  uint32_t triangles() const { return static_cast<uint32_t>(surface.indices.size() / 3); }
};

/// Positions are kept for draws that make no triangles, too.
std::vector<Part> parts_of(const ViewPass& pass,
                           const std::vector<std::pair<const uint32_t*, size_t>>& indices) {
  std::map<std::pair<const uint32_t*, size_t>, uint32_t> places;
  uint32_t index = 0;
  for (const auto& span : indices) {
    places.emplace(span, index);
    index += static_cast<uint32_t>(span.second);
  }
  std::vector<Part> parts;
  uint32_t position = 0, triangle = 0;
  for (const Draw& draw : pass.view.draws) {
    if (const auto surface = backends::surface_of(pass.view, draw, {})) {
      const uint32_t first_index = places.at({draw.indices.data(), draw.indices.size()});
      parts.push_back({&draw, *surface, position, first_index, triangle});
      triangle += parts.back().triangles();
    }
    position += draw.vertex_count;
  }
  return parts;
}

}  // namespace

void Table::add(uint32_t count, std::initializer_list<size_t> words) {
  if (count == 0) return;  // the search would find another row that begins there
  words_.push_back(static_cast<int32_t>(count_));
  for (const size_t word : words) words_.push_back(static_cast<int32_t>(word));
  count_ += count;
  support::assert_that(words_.size() % glsl::table_row::stride == 0, "a row of another length");
}

Call Table::call(PipelineIndex pipeline, size_t first) const {
  return {.pipeline = pipeline,
          .push = {.first = static_cast<int32_t>(first),
                   .count = static_cast<int32_t>(words_.size() / glsl::table_row::stride)},
          .vertex_count = count_};
}

void append_surface(const raster::Surface& surface, const raster::Viewport& viewport,
                    std::vector<int32_t>& words) {
  namespace word = lower::surface_word;
  const raster::Culling culling = raster::culling_of(surface, viewport.pixels());
  const int32_t turned = raster::record_word(surface, true), straight = raster::record_word(surface, false);
  const size_t begin = words.size();
  words.resize(begin + word::stride);
  const auto set = [&](int at, int32_t value) { words[begin + static_cast<size_t>(at)] = value; };
  const auto set_float = [&](int at, float value) { set(at, std::bit_cast<int32_t>(value)); };
  set(word::object, turned & straight);
  set(word::if_turned, turned & ~straight);
  set(word::if_straight, straight & ~turned);
  set(word::culls_turned, culling.turned);
  set(word::culls_straight, culling.straight);
  set(word::width, viewport.pixels().x1 + 1);
  set(word::height, viewport.pixels().y1 + 1);
  const auto set_planes = [&](int at, const functions::GuardPlanes<float>& planes) {
    set_float(at, planes.right), set_float(at + 1, planes.left);
    set_float(at + 2, planes.bottom), set_float(at + 3, planes.top);
  };
  set_planes(word::near_planes, viewport.near_planes());
  set_planes(word::far_planes, viewport.far_planes());
  set(word::is_biased, surface.bias.is_set());
  set_float(word::bias, surface.bias.slope);
  set_float(word::bias + 1, surface.bias.relative);
  set_float(word::bias + 2, surface.bias.constant);
}

void append(std::vector<Run>& runs, const Run& run) {
  if (run.count == 0) return;
  if (!runs.empty()) {
    Run& last = runs.back();
    if (last.over == run.over && last.cutout == run.cutout && last.first + last.count == run.first) {
      last.count += run.count;
      return;
    }
  }
  runs.push_back(run);
}

bool VulkanBackend::upload_indices(const ViewPass& pass) {
  // The memory of meshes stays theirs as long as the vertices are the same.
  const uint64_t revision = pass.frame.revisions.vertices;
  if (revision == 0 || revision != indices_revision_) indices_.clear();
  std::set<std::pair<const uint32_t*, size_t>> known(indices_.begin(), indices_.end());
  const size_t former = indices_.size();
  for (const Draw& draw : pass.view.draws)
    if (const std::pair indices{draw.indices.data(), draw.indices.size()}; known.insert(indices).second)
      indices_.push_back(indices);
  indices_revision_ = revision;
  if (indices_.size() == former) return true;
  std::vector<uint32_t> all;
  for (const auto& [data, count] : indices_) all.insert(all.end(), data, data + count);
  indices_revision_ = 0;  // in case of an exception
  if (all.size() * sizeof(uint32_t) > device_->max_buffer_bytes()) return false;
  device_->upload_indices(all);
  indices_revision_ = revision;
  return true;
}

std::optional<DeviceTriangles> VulkanBackend::make_triangles(const ViewPass& pass,
                                                             const backends::Layers& layers,
                                                             Diagnostics& diagnostics) {
  const Frame& frame = pass.frame;
  const backends::Target& target = pass.view.target;
  if (!upload_indices(pass)) return std::nullopt;
  std::vector<Part> parts = parts_of(pass, indices_);
  size_t positions = 0, triangles = 0;
  for (const Draw& draw : pass.view.draws) positions += draw.vertex_count;
  for (const Part& part : parts) triangles += part.triangles();
  if (triangles >= size_t{1} << (31 - glsl::order_bits)) return std::nullopt;  // too many to be ordered
  const size_t room = size_t{glsl::cut_room} * most_left,
               made_bytes = size_t{glsl::cut_room} * most_made * lower::vertex_word::stride * sizeof(float);
  const size_t vertex_bytes = frame.vertices.size() * sizeof(float);
  const size_t record_bytes = sizeof(int32_t) * lower::triangle_word::stride;
  if (std::max({positions * 4 * sizeof(float), (triangles + room) * record_bytes,
                vertex_bytes + made_bytes}) > device_->max_buffer_bytes())
    return std::nullopt;

  device_->reserve(FrameBuffer::vertices, vertex_bytes + made_bytes);
  if (!upload(pass, layers, frame.vertices, true, diagnostics)) return std::nullopt;
  if (moves_by_textures(pass) && !upload_textures(frame, diagnostics)) return std::nullopt;
  std::vector<std::optional<PipelineIndex>> pipelines;
  if (!vertex_pipelines(pass, pipelines, diagnostics)) return std::nullopt;
  const driver::Program& program = driver::setup_program();
  const auto setup = pipeline_of(program, Use::setup, [&] {
    return device_->pipeline({Output::row, 0, driver::glsl_of_compute(program, division_), {}}, diagnostics);
  });
  if (!setup) return std::nullopt;

  std::map<size_t, Table> vertex_tables;  // by the vertex program
  size_t position = 0;
  for (const Draw& draw : pass.view.draws) {
    vertex_tables[draw.vertex_program].add(
        draw.vertex_count,
        {draw.first_vertex, position, static_cast<size_t>(draw.object), static_cast<size_t>(draw.projected)});
    position += draw.vertex_count;
  }
  std::vector<int32_t> inputs;
  std::vector<Call> vertex_calls;
  const auto add = [&](const Table& table, PipelineIndex pipeline) {
    const Call call = table.call(pipeline, inputs.size());
    inputs.insert(inputs.end(), table.words().begin(), table.words().end());
    return call;
  };
  for (const auto& [p, table] : vertex_tables)
    if (!table.empty()) vertex_calls.push_back(add(table, *pipelines[p]));
  const raster::Viewport viewport(target.width, target.height);
  for (Part& part : parts) {
    part.surface_words = inputs.size();
    append_surface(part.surface, viewport, inputs);
  }
  Table setup_table;
  for (const Part& part : parts)
    setup_table.add(part.triangles(),
                    {part.first_index, part.first_position, part.surface.first_vertex, part.surface_words});
  std::vector<Call> setup_calls;
  if (!setup_table.empty()) setup_calls.push_back(add(setup_table, *setup));
  const size_t input_bytes = inputs.size() * sizeof(int32_t);
  device_->reserve(FrameBuffer::inputs, input_bytes + room * sizeof(int32_t));
  device_->upload(FrameBuffer::inputs, inputs.data(), input_bytes);
  Device::Triangles made;
  if (!device_->make_triangles({vertex_calls, positions, setup_calls, triangles, room}, made))
    return std::nullopt;

  DeviceTriangles result;
  result.made.triangles = made.kept;
  const lanes::FpGuard guard;
  std::ranges::sort(made.cuts, {}, &Device::Cut::triangle);
  std::vector<float> made_vertices;
  std::vector<int32_t> made_triangles;
  std::set<size_t> programs, blending;
  std::vector<int32_t> orders;  // of what cutting left
  std::vector<std::pair<bool, Run>> left;
  auto cut = made.cuts.begin();
  for (const Part& part : parts) {
    const int object = part.draw->object;
    const bool is_blended = part.surface.blended;
    (is_blended ? blending : programs).insert(backends::pixel_program_of(frame, object));
    const auto run = [&](size_t first, size_t count) {
      return Run{static_cast<uint32_t>(first), static_cast<uint32_t>(count), false,
                 part.surface.cutout ? frame.programs[backends::cutout_program_of(frame, object)] : nullptr};
    };
    append(is_blended ? result.blended : result.opaque, run(part.first_triangle, part.triangles()));
    const size_t end = size_t{part.first_triangle} + part.triangles();
    for (; cut != made.cuts.end() && static_cast<size_t>(cut->triangle) < end; ++cut) {
      const auto number = static_cast<size_t>(cut->triangle);
      const size_t former = made_triangles.size();
      raster::CutTriangle triangle{part.surface.indices.subspan(3 * (number - part.first_triangle), 3), {}};
      for (size_t i = 0; i < 3; ++i) {
        const float* p = cut->points[i];
        triangle.points[i] = {p[0], p[1], p[2], p[3]};
      }
      raster::cut_triangle(viewport, part.surface, triangle, frame.vertices,
                           static_cast<int32_t>(frame.vertices.size() / lower::vertex_word::stride),
                           made_vertices, made_triangles);
      const size_t count = (made_triangles.size() - former) / lower::triangle_word::stride;
      if (count == 0) continue;
      const size_t first = triangles + former / lower::triangle_word::stride;
      left.emplace_back(is_blended, run(first, count));
      for (size_t i = 1; i <= count; ++i)
        orders.push_back(static_cast<int32_t>((number << glsl::order_bits) + i));
      const auto named = static_cast<int32_t>(first);
      device_->append(FrameBuffer::triangles, number * record_bytes, &named, sizeof named);
    }
  }
  for (const auto& [is_blended, run] : left) append(is_blended ? result.blended : result.opaque, run);
  for (const Run& run : result.blended) result.blended_count += run.count;
  support::assert_that(cut == made.cuts.end(), "a triangle is cut that no draw has");
  result.first_cut = triangles;
  result.made.triangles += static_cast<int64_t>(made_triangles.size()) / lower::triangle_word::stride;
  result.made.vertices = static_cast<int64_t>(made_vertices.size()) / lower::vertex_word::stride;
  device_->append(FrameBuffer::vertices, vertex_bytes, made_vertices.data(),
                  made_vertices.size() * sizeof(float));
  device_->append(FrameBuffer::triangles, triangles * record_bytes, made_triangles.data(),
                  made_triangles.size() * sizeof(int32_t));
  device_->append(FrameBuffer::inputs, input_bytes, orders.data(), orders.size() * sizeof(int32_t));
  result.first_order = inputs.size();
  result.programs.assign(programs.begin(), programs.end());
  result.blending.assign(blending.begin(), blending.end());
  return result;
}

}  // namespace isoshade::vulkan
