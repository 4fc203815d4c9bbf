// SPDX-License-Identifier: Apache-2.0
// What every backend does: run the vertex stage, draw triangles, evaluate a function over a table. The scene
// steps around it (render/) are the same for all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/driver/program.h"
#include "compiler/interface/pass_state.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::backends {

/// Linear, scene-referred; rows top down. Depth is reversed: 1 at the near plane, 0 where nothing was drawn.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;   ///< 4 * width * height
  std::vector<float> depth;  ///< width * height

  void resize(int w, int h);
};

/// One part of an object under one pass.
struct Draw {
  uint32_t vertex_program = 0;  ///< indices into Frame::programs
  uint32_t pixel_program = 0;
  int object = 0;             ///< the first word of its record in Frame::objects
  int projected = 0;          ///< the first word of its matrix in Frame::view
  uint32_t first_vertex = 0;  ///< its vertices in Frame::vertices
  uint32_t vertex_count = 0;
  std::span<const uint32_t> indices;  ///< triples, relative to first_vertex
  interface::PassState state;         ///< as its vertices are wound, whatever the transform does
};

/// What takes the most room in an array of a frame, for messages; empty if there is nothing.
struct Largest {
  std::string what;     ///< "the image \"a.png\", 2048 x 2048 with mip levels"
  support::Span where;  ///< what names it
};

/// A part of a frame, in its pixels.
struct Window {
  int x = 0, y = 0;
  int width = 0, height = 0;
};

/// A frame ready to be drawn: programs and the arrays of lower/frame_layout.h.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<const driver::Program*> programs;
  std::vector<float> vertices;
  std::vector<float> objects;
  std::vector<float> lights;
  std::vector<float> frame;
  std::vector<float> view;
  std::vector<float> texels;
  std::vector<uint32_t> texel_bytes;
  std::vector<int32_t> textures;
  int light_count = 0;
  std::vector<Draw> draws;
  float background[4] = {0, 0, 0, 0};
  Largest largest_in_texels, largest_in_texel_bytes, largest_mesh;
};

/// A full-screen pass ready to be run: a program of Stage::post and its arrays of lower/frame_layout.h.
struct ScreenPass {
  const driver::Program* program = nullptr;
  int width = 0;  ///< of the image that is made
  int height = 0;
  std::span<const float> frame;
  std::span<const float> view;
  std::span<const float> record;  ///< parameters and numbers of taps, as `objects`
  std::span<const float> images;
  std::span<const int32_t> image_records;
};

/// A frame that is drawn part by part. What the parts share is made ready once.
class Drawing {
 public:
  virtual ~Drawing() = default;
  /// Rasterises `triangles` (records of lower/frame_layout.h, in draw order, positions in the frame) over the
  /// background and shades each pixel of the window that they cover once. `image` is of the window's size, and has the
  /// bits that the same triangles give there in any other window.
  virtual bool draw(const Window& window, std::span<const int32_t> triangles, Image& image,
                    support::Diagnostics& diagnostics) = 0;
};

class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string_view name() const = 0;
  /// Device or compiler, lanes, division: one line for reports.
  virtual std::string description() const = 0;
  /// The seconds that went so far into code for the machine: compiled, or found and loaded, where programs are first run.
  virtual double build_seconds() const { return 0; }

  /// Runs the vertex programs: clip[d] receives 4 floats for each vertex of draws[d], NaN canonical.
  virtual bool transform(const Frame& frame, std::vector<std::vector<float>>& clip,
                         support::Diagnostics& diagnostics) = 0;
  /// `vertices` are frame.vertices with those that clipping made appended. As long as the drawing lives, frame and
  /// vertices must, and nothing else may be asked of the backend. Null where that is reported.
  virtual std::unique_ptr<Drawing> begin(const Frame& frame, std::span<const float> vertices,
                                         support::Diagnostics& diagnostics) = 0;
  /// All of a frame at once.
  bool draw(const Frame& frame, std::span<const float> vertices, std::span<const int32_t> triangles,
            Image& image, support::Diagnostics& diagnostics);
  /// Runs a full-screen pass: `rgba` receives 4 floats a pixel, rows top down, NaN canonical.
  virtual bool post(const ScreenPass& pass, std::vector<float>& rgba, support::Diagnostics& diagnostics) = 0;
  /// Runs an eval program over `rows` records of inputs; outputs are records of the program's result words.
  virtual bool evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows,
                        std::vector<int32_t>& outputs, support::Diagnostics& diagnostics) = 0;
};

}  // namespace isoshade::backends
