// SPDX-License-Identifier: Apache-2.0
// What every backend does: run vertex programs, draw the triangles of a view, run full-screen passes, evaluate a
// function over a table. The steps around these (runtime/render) are the same for all backends.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/slots.h"
#include "compiler/driver/program.h"
#include "compiler/interface/pass_state.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/memory.h"
#include "runtime/raster/clip.h"
#include "runtime/threads/workers.h"

namespace isoshade::backends {

/// Linear, scene-referred; rows top down. Depth is reversed: 1 at the near plane, 0 where nothing was drawn.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;   ///< 4 * width * height; empty where the target has no color
  std::vector<float> depth;  ///< width * height

  void resize(int w, int h, bool has_color = true);
};

/// One part of an object under one pass, in one view.
struct Draw {
  uint32_t vertex_program = 0;  ///< indices into Frame::programs
  uint32_t pixel_program = 0;
  int object = 0;             ///< the first word of its record in Frame::objects
  int projected = 0;          ///< the first word of its matrix in View::words
  uint32_t first_vertex = 0;  ///< its vertices in Frame::vertices
  uint32_t vertex_count = 0;
  std::span<const uint32_t> indices;  ///< triples, relative to first_vertex
  interface::PassState state;
  bool mirrored = false;  ///< by its transform: its front faces are those whose vertices turn clockwise
  bool cutout = false;    ///< drawn only where the cut-out of its pixel program holds
  /// Blended by its state: its pixel program is of Stage::blend. In a view all such draws come last.
  bool blended = false;
};

/// What a view is drawn into.
struct Target {
  std::string name;  ///< for messages: "the picture"
  int width = 0;
  int height = 0;
  bool has_color = true;  ///< false: it holds depth alone, and no pixel program is run
  bool operator==(const Target&) const = default;
};

/// A camera, the draws that it sees and the target that receives them. Its programs may read the targets of earlier
/// views; posts read the target of the last one.
struct View {
  Target target;
  std::vector<float> words;   ///< lower::view_word: the camera, then the matrices of the draws
  std::vector<float> frame = {};  ///< lower::frame_word, in place of Frame::frame; empty: that
  std::vector<Draw> draws;    ///< in the order in which they are drawn
  /// Earlier views (indices into Frame::views) whose targets its programs read; `nothing` leaves the place of one free.
  std::vector<size_t> reads;
  static constexpr size_t nothing = ~size_t{0};
  float background[4] = {0, 0, 0, 0};
  raster::DepthBias depth_bias = {};
  uint64_t revision = 0;  ///< of all of the above, as those of Revisions
};

/// The item that takes the most room in an array of a frame, for messages; empty if there is none.
struct Largest {
  std::string what;     ///< "the image \"a.png\", 2048 x 2048 with mip levels"
  support::Span where;  ///< where the scene names it
};

/// A rectangle of pixels.
struct Window {
  int x = 0, y = 0;
  int width = 0, height = 0;
};

/// Numbers of the contents of a frame's arrays. Where a number is equal in two frames of this process and not 0, the two
/// arrays have the same bits, so that what a backend has made of one serves for the other. 0 tells nothing. Code that
/// changes an array of a planned frame sets its number to 0.
struct Revisions {
  uint64_t programs = 0;  ///< Frame::programs and Frame::cutouts: also the programs are the same objects
  uint64_t vertices = 0, objects = 0, lights = 0, frame = 0;
  uint64_t texels = 0, texel_bytes = 0, textures = 0;
  bool operator==(const Revisions&) const = default;
};

/// All that is drawn for one picture: programs, the arrays of lower/frame_layout.h, and the views.
struct Frame {
  std::vector<const driver::Program*> programs;
  static constexpr uint32_t no_program = ~0u;
  /// For each program, if it is a pixel program or one of Stage::blend: the one of Stage::cutout that belongs to it, or no_program. Empty if no
  /// pixel program has any.
  std::vector<uint32_t> cutouts;
  std::vector<float> vertices;
  std::vector<float> objects;
  std::vector<float> lights;
  std::vector<float> frame;
  std::vector<float> texels;
  std::vector<uint32_t> texel_bytes;
  std::vector<int32_t> textures;
  int light_count = 0;
  std::vector<View> views;  ///< in the order in which they are drawn; the last one draws the picture
  Revisions revisions;
  Largest largest_in_texels, largest_in_texel_bytes, largest_mesh;
  Largest largest_shadow;  ///< empty if shadow maps take less room than what else a view reads

  const View& picture() const { return views.back(); }
};

/// A view ready to be drawn, with the images that its programs read.
struct ViewPass {
  const Frame& frame;
  const View& view;
  std::span<const ImageRead> images = {};
};

/// A full-screen pass ready to be run: a program of Stage::post and its arrays of lower/frame_layout.h.
struct ScreenPass {
  const driver::Program* program = nullptr;
  int width = 0;  ///< of the image that it makes
  int height = 0;
  std::span<const float> frame;
  std::span<const float> view;    ///< the camera alone
  std::span<const float> record;  ///< parameters and numbers of taps, as `objects`
  /// The depth, the image that it processes, and those that its document lists.
  std::span<const ImageRead> images;
  const Frame* textures = nullptr;  ///< whose textures it reads; null if it reads none
  bool keeps_background_plain = false;       ///< pixels without a surface that have one color keep one
};

/// Triangles to draw into a window of a view's target, and where the result goes.
struct Drawing {
  ViewPass pass;
  std::span<const float> vertices;     ///< Frame::vertices, followed by those that clipping made
  bool has_other_vertices = false;     ///< `vertices` do not begin with those of the frame
  std::span<const int32_t> triangles;  ///< records of lower/frame_layout.h, in draw order, in pixels of the target
  Window window;                       ///< in pixels of the target
  /// The samples along each axis in each pixel of the images: 1, 2 or 4. A target without color has 1.
  int side = 1;
  /// Run over each sample, one after the other, before samples become pixels. They read the depth and the color of their
  /// own sample alone, as their first two images; nothing else reads what they make.
  std::span<const ScreenPass> posts = {};
  Slot depth, color;  ///< of the window in pixels; no color where the target has none
  bool skips_tiles = true;  ///< Skip::tiles
};

/// What tiles showed that were drawn (Skip::tiles), of all views. Backends that draw no tiles have none.
struct TileCounts {
  int64_t tiles = 0;
  int64_t empty = 0;    ///< no triangle reaches them
  int64_t kept = 0;     ///< of these, those that held the same already
  int64_t blocks = 0;   ///< of 8x8 pixels, that show anything
  int64_t blocks_of_one_object = 0;

  TileCounts& operator+=(const TileCounts& other);
  TileCounts& operator-=(const TileCounts& other);
};

/// A step on a device.
struct DeviceStep {
  std::string_view name;
  double seconds = 0;  ///< that it took so far, by the device's clock
};

/// What came of the triangles of a view.
struct Made {
  int64_t triangles = 0;  ///< left by clipping and culling
  int64_t vertices = 0;   ///< made by clipping
};

class Backend {
 public:
  /// `threads`: of the host; 0: as many as there are cores.
  explicit Backend(int threads = 0) : workers_(threads) {}
  virtual ~Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  /// The threads of the host that may work for this backend.
  threads::Workers& workers() { return workers_; }
  const threads::Workers& workers() const { return workers_; }

  virtual std::string_view name() const = 0;
  /// Device or compiler, lanes, division: one line for reports.
  virtual std::string description() const = 0;
  /// The seconds spent so far on machine code: compiling it, or finding and loading it, when a program first runs.
  virtual double build_seconds() const { return 0; }

  /// What ran on a device with a clock of its own; empty without one.
  virtual std::vector<DeviceStep> device_steps() const { return {}; }

  /// Who has drawn what is in `layers`; null if nobody says so.
  const void* drawer() const { return drawer_; }
  void set_drawer(const void* drawer) { drawer_ = drawer; }

  /// Of all draws so far.
  virtual TileCounts tile_counts() const { return {}; }

  // The images of a frame lie in one array, `layers`, where programs read them. It lives on from frame to frame.

  /// Makes the array this long before a frame is drawn; what was in it is lost. Reports arrays beyond the backend's limit.
  virtual bool reserve(size_t floats, support::Diagnostics& diagnostics) = 0;
  virtual void write(size_t first, std::span<const float> floats) = 0;
  /// Valid until the next call of a method that is not const.
  virtual std::span<const float> read(const Slot& slot) = 0;
  /// Whether every color that has been drawn or that a post has made since reserve() is finite.
  virtual bool is_finite() = 0;

  /// Runs the vertex programs: `clip` receives 4 floats for each vertex of each draw of the view, NaN canonical.
  virtual bool transform(const ViewPass& pass, support::Array<float>& clip, support::Diagnostics& diagnostics) = 0;
  /// Rasterises the triangles over the background, those with triangle_flag::cutout where their cut-out holds, and runs the
  /// pixel program once for each sample of the window that they cover, if the target has color. Then it draws those with
  /// triangle_flag::blended, which come last and only if the target has color, one after the other: where one covers a
  /// sample and passes the depth test, its program of Stage::blend makes the new color of the old one, and without
  /// triangle_flag::keeps_depth the sample gets its depth. Then it runs the posts, and each pixel becomes the mean of its
  /// samples, see resolve(). The bits do not depend on how a view is divided into windows.
  virtual bool draw(const Drawing& drawing, support::Diagnostics& diagnostics) = 0;
  /// Does all of transform(), raster::Clipper and draw(), if the backend can do that on its device: the images have the same
  /// bits. `drawing` has no vertices and no triangles. Nothing is returned where the steps have to be taken one by one.
  virtual std::optional<bool> draw_view(const Drawing&, Made&, support::Diagnostics&) { return std::nullopt; }
  /// Runs full-screen passes of one size, NaN canonical. Each pass after the first reads, of what the passes before it
  /// made, its own pixel alone, as its image 1, and nothing else reads that: all of them write to `made`.
  virtual bool post(std::span<const ScreenPass> passes, const Slot& made, support::Diagnostics& diagnostics) = 0;
  /// Runs an eval program over `rows` records of inputs; outputs are records of the program's result words.
  virtual bool evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows,
                        std::vector<int32_t>& outputs, support::Diagnostics& diagnostics) = 0;

 private:
  threads::Workers workers_;
  const void* drawer_ = nullptr;
};

}  // namespace isoshade::backends
