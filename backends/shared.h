// SPDX-License-Identifier: Apache-2.0
// What the backends share with each other and with nobody else.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "backends/backend.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"

namespace isoshade::backends {

/// What is known of the contents of an array: where two revisions are equal and not 0, the first bytes are too.
struct Known {
  uint64_t revision = 0;
  size_t bytes = 0;
};
/// Of an array of a frame; of the vertices those of the meshes. `view`: the one whose matrices and words are meant.
inline Known known_of(const Frame& frame, const View* view, lower::FrameBuffer buffer) {
  using lower::FrameBuffer;
  const auto all = [](uint64_t revision, const auto& array) {
    return Known{revision, array.size() * sizeof(array[0])};
  };
  switch (buffer) {
    case FrameBuffer::vertices: return all(frame.revisions.vertices, frame.vertices);
    case FrameBuffer::objects:
    case FrameBuffer::object_integers: return all(frame.revisions.objects, frame.objects);
    case FrameBuffer::lights: return all(frame.revisions.lights, frame.lights);
    case FrameBuffer::texels: return all(frame.revisions.texels, frame.texels);
    case FrameBuffer::texel_bytes: return all(frame.revisions.texel_bytes, frame.texel_bytes);
    case FrameBuffer::textures: return all(frame.revisions.textures, frame.textures);
    case FrameBuffer::view: return view == nullptr ? Known{} : all(view->revision, view->words);
    case FrameBuffer::frame:
    case FrameBuffer::triangles:
    case FrameBuffer::inputs:
    case FrameBuffer::layers:
    case FrameBuffer::layer_records: break;
  }
  return {};
}

/// The arrays `layers` and `layer_records`, as programs are given them.
struct Layers {
  std::span<const float> floats;
  std::span<const int32_t> records;
};

/// The same memory.
inline std::span<const int32_t> integers_of(std::span<const float> words) {
  return {reinterpret_cast<const int32_t*>(words.data()), words.size()};
}

/// Calls use(buffer, words) for each array that programs of a view read, except textures and triangles, until a call
/// returns false. `vertices`: see Drawing.
template <class Use>
bool for_each_array(const ViewPass& pass, const Layers& layers, std::span<const float> vertices, const Use& use) {
  using lower::FrameBuffer;
  const Frame& frame = pass.frame;
  return use(FrameBuffer::vertices, vertices) && use(FrameBuffer::objects, std::span(frame.objects)) &&
         use(FrameBuffer::object_integers, integers_of(frame.objects)) &&
         use(FrameBuffer::lights, std::span(frame.lights)) &&
         use(FrameBuffer::frame, std::span(pass.view.frame.empty() ? frame.frame : pass.view.frame)) &&
         use(FrameBuffer::view, std::span(pass.view.words)) && use(FrameBuffer::layers, layers.floats) &&
         use(FrameBuffer::layer_records, layers.records);
}

template <class Use>
bool for_each_texture_array(const Frame& frame, const Use& use) {
  using lower::FrameBuffer;
  return use(FrameBuffer::texels, std::span(frame.texels)) &&
         use(FrameBuffer::texel_bytes, std::span(frame.texel_bytes)) &&
         use(FrameBuffer::textures, std::span(frame.textures));
}

template <class Use>
bool for_each_array(const ScreenPass& pass, const Layers& layers, const Use& use) {
  using lower::FrameBuffer;
  return use(FrameBuffer::frame, pass.frame) && use(FrameBuffer::view, pass.view) &&
         use(FrameBuffer::objects, pass.record) &&
         use(FrameBuffer::object_integers, integers_of(pass.record)) && use(FrameBuffer::layers, layers.floats) &&
         use(FrameBuffer::layer_records, layers.records) &&
         (pass.textures == nullptr || for_each_texture_array(*pass.textures, use));
}

/// What becomes triangles of a draw; nothing where the target has no color and the draw writes no depth. `clip`: the
/// positions of its vertices.
inline std::optional<raster::Surface> surface_of(const View& view, const Draw& draw,
                                                 std::span<const float> clip) {
  // Where only depth counts, a blended draw is one that writes it or nothing.
  const bool writes_depth = !draw.blended || draw.state.depth_write == interface::DepthWrite::on;
  if (!view.target.has_color && !writes_depth) return std::nullopt;
  return raster::Surface{
      clip,           draw.indices,  draw.first_vertex, draw.state,
      draw.object,    draw.mirrored, draw.cutout,       draw.blended && view.target.has_color,
      view.depth_bias};
}

/// The pixel program of the object whose record begins at this word: an index into frame.programs.
inline size_t pixel_program_of(const Frame& frame, int object) {
  const auto program =
      static_cast<size_t>(frame.objects[static_cast<size_t>(object) + lower::object_word::program]);
  support::assert_that(program < frame.programs.size(), "an object has a program that the frame lacks");
  return program;
}

/// The program that cuts out the triangles of the object whose record begins at this word.
inline size_t cutout_program_of(const Frame& frame, int object) {
  const size_t pixel = pixel_program_of(frame, object);
  support::assert_that(pixel < frame.cutouts.size() && frame.cutouts[pixel] < frame.programs.size(),
                       "a triangle has a cut-out that the frame lacks");
  return frame.cutouts[pixel];
}

/// The words of a record of these fields.
size_t word_count(std::span<const driver::Field> fields);

/// The largest array that a backend accepts.
struct ArrayLimit {
  std::string_view taker;  ///< the name of the device, or "the cpu backend"
  size_t bytes = 0;
  bool is_cpu = false;  ///< no other backend accepts more
};

/// Reports that the array has `bytes`: what is too large, which item takes most of it if `frame` tells (it may be
/// null), and what the user can do.
void report_too_large(lower::FrameBuffer array, size_t bytes, const ArrayLimit& limit, const Frame* frame,
                      support::Diagnostics& diagnostics);

/// What the user can do where shadow maps take most of the room.
inline constexpr std::string_view smaller_shadow = "make the \"size\" of its shadow smaller";

/// Whether no number is infinite or NaN.
bool is_finite(std::span<const float> numbers);

/// Adds its lifetime in seconds to a sum.
class Timed {
 public:
  explicit Timed(double& sum) : sum_(sum) {}
  ~Timed() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace isoshade::backends
