// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/backend.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "backends/host_backend.h"
#include "backends/interpreter/buffers.h"
#include "backends/interpreter/stages.h"
#include "compiler/driver/target_limits.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/triangle.h"

namespace isoshade::interpreter {
namespace {

using backends::Draw;
using backends::Frame;
using backends::Image;
using backends::Layers;
using backends::ScreenPass;
using backends::ViewPass;
using driver::Program;
using lower::FrameBuffer;
using support::Diagnostics;

constexpr std::string_view taker = "the interpreter";
constexpr size_t chunk = 1024;  ///< calls of a task

class BatchedMachine final : public Machine {
 public:
  BatchedMachine(const Program& program, int lanes) : stages_(program, lanes) {}
  void run(const BufferView* buffers, std::span<const Argument> arguments, int count, void* results) override {
    const lanes::FpGuard guard_floats;
    stages_.code().run(buffers, arguments, count, results);
  }

 private:
  Stages stages_;
};

/// What makes machines, and how work is spread.
struct Means {
  MakeMachine make;
  threads::Workers* workers;  ///< null: one task after the other

  /// Null if the program is too large, which is reported.
  std::unique_ptr<Machine> machine(const Program& program, Diagnostics& diagnostics) const {
    if (!driver::within_limits(program, driver::Target::interpreter, driver::Division::native, diagnostics))
      return nullptr;
    return make(program);
  }
  template <class Body>
  void for_each(size_t count, const Body& body) const {
    if (workers != nullptr) return workers->for_each(count, body);
    for (size_t i = 0; i < count; ++i) body(i);
  }
  /// Calls body(first, count) for parts of [0, count).
  template <class Body>
  void for_each_chunk(size_t count, const Body& body) const {
    for_each((count + chunk - 1) / chunk, [&](size_t i) { body(i * chunk, std::min(chunk, count - i * chunk)); });
  }
};

/// Pixels that show one object.
struct Pixels {
  std::vector<int32_t> x, y, triangle;
  std::vector<size_t> place;  ///< in the image
};

class InterpreterViewRenderer final : public backends::ViewRenderer {
 public:
  InterpreterViewRenderer(const Means& means, const ViewPass& pass)
      : means_(means), pass_(pass), buffers_(taker, &pass.frame) {}
  bool bind(const Layers& layers, std::span<const float> vertices, Diagnostics& diagnostics) {
    return buffers_.bind(pass_, layers, vertices, diagnostics);
  }

  bool draw(const backends::Window& window, std::span<const int32_t> triangles, Image& image,
            Diagnostics& diagnostics) override {
    if (!buffers_.bind(FrameBuffer::triangles, triangles, diagnostics)) return false;
    machines_.clear();
    image.resize(window.width, window.height, pass_.view.target.has_color);
    const Frame& frame = pass_.frame;
    const auto count = static_cast<int>(triangles.size()) / lower::triangle_word::stride;
    for (int i = 0; i < count; ++i) {
      const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
      if (triangle.cutout() && !need(backends::cutout_program_of(frame, triangle.object()), diagnostics)) return false;
    }
    const auto is_drawn = [&](int triangle, int x, int y) {
      const int object = raster::triangle_at(triangles.data(), triangle).object();
      int32_t drawn = 0;
      const std::array arguments{Argument::uniform(x), Argument::uniform(y), Argument::uniform(triangle),
                                 Argument::uniform(object)};
      machines_.at(backends::cutout_program_of(frame, object))->run(buffers_.views(), arguments, 1, &drawn);
      return drawn != 0;
    };
    const int opaque = raster::opaque_count(triangles.data(), count);
    std::vector<int32_t> visible(image.depth.size());
    raster::rasterize_reference(triangles.first(static_cast<size_t>(opaque) * lower::triangle_word::stride),
                                raster::box_at(window.x, window.y, window.width, window.height),
                                visible, image.depth, is_drawn);
    if (!pass_.view.target.has_color) return true;

    std::map<int, Pixels> objects;
    for (size_t i = 0; i < visible.size(); ++i) {
      std::ranges::copy(pass_.view.background, image.rgba.begin() + static_cast<ptrdiff_t>(4 * i));
      if (visible[i] < 0) continue;
      Pixels& pixels = objects[raster::triangle_at(triangles.data(), visible[i]).object()];
      pixels.x.push_back(window.x + static_cast<int>(i) % window.width);
      pixels.y.push_back(window.y + static_cast<int>(i) / window.width);
      pixels.triangle.push_back(visible[i]);
      pixels.place.push_back(i);
    }
    for (const auto& [object, pixels] : objects)
      if (!run(object, pixels, {}, image, diagnostics)) return false;
    for (int i = opaque; i < count; ++i)
      if (!blend(window, raster::triangle_at(triangles.data(), i), i, is_drawn, image, diagnostics)) return false;
    return true;
  }

 private:
  /// Makes the machine of a program if it is missing. False after an error, which is reported.
  bool need(size_t program, Diagnostics& diagnostics) {
    std::unique_ptr<Machine>& machine = machines_[program];
    if (machine == nullptr) machine = means_.machine(*pass_.frame.programs[program], diagnostics);
    return machine != nullptr;
  }

  /// Draws a triangle that is blended.
  bool blend(const backends::Window& window, raster::Triangle triangle, int number, const raster::IsDrawn& is_drawn,
             Image& image, Diagnostics& diagnostics) {
    const raster::Box area = raster::box_at(window.x, window.y, window.width, window.height);
    Pixels pixels;
    std::vector<float> backdrop;
    raster::for_each_covered(triangle.words, area, [&](int x, int y, float nearness) {
      const size_t place = static_cast<size_t>(y - window.y) * static_cast<size_t>(window.width) +
                           static_cast<size_t>(x - window.x);
      if (!triangle.over() && !(nearness > image.depth[place])) return;
      if (triangle.cutout() && !is_drawn(number, x, y)) return;
      pixels.x.push_back(x);
      pixels.y.push_back(y);
      pixels.triangle.push_back(number);
      pixels.place.push_back(place);
      const auto color = image.rgba.begin() + static_cast<ptrdiff_t>(4 * place);
      backdrop.insert(backdrop.end(), color, color + 4);
      if (!triangle.keeps_depth()) image.depth[place] = nearness;
    });
    return run(triangle.object(), pixels, backdrop, image, diagnostics);
  }

  /// Runs the object's pixel program. `backdrop`: what is behind each pixel, if the program blends.
  bool run(int object, const Pixels& pixels, std::span<const float> backdrop, Image& image, Diagnostics& diagnostics) {
    if (pixels.place.empty()) return true;
    const size_t program = backends::pixel_program_of(pass_.frame, object);
    if (!need(program, diagnostics)) return false;
    Machine& machine = *machines_.at(program);
    means_.for_each_chunk(pixels.place.size(), [&](size_t first, size_t count) {
      std::vector<Argument> arguments{Argument::listed(pixels.x.data() + first), Argument::listed(pixels.y.data() + first),
                                      Argument::listed(pixels.triangle.data() + first), Argument::uniform(object),
                                      Argument::uniform(pass_.frame.light_count)};
      if (!backdrop.empty())
        for (size_t c = 0; c < 4; ++c) arguments.push_back(Argument::listed(backdrop.data() + 4 * first + c, 4));
      std::vector<float> colors(4 * count);
      machine.run(buffers_.views(), arguments, static_cast<int>(count), colors.data());
      for (size_t i = 0; i < count; ++i) std::copy_n(colors.data() + 4 * i, 4, image.rgba.data() + 4 * pixels.place[first + i]);
    });
    return true;
  }

  const Means& means_;
  const ViewPass pass_;
  Buffers buffers_;
  std::map<size_t, std::unique_ptr<Machine>> machines_;  ///< by program
};

class InterpreterBackend final : public backends::HostBackend {
 public:
  InterpreterBackend(int threads, int lanes)
      : HostBackend(threads),
        name_("interpreter"),
        description_("interpreter, lanes " + std::to_string(lanes) + ", " + std::to_string(workers().count()) +
                     (workers().count() == 1 ? " thread" : " threads") + ", native division"),
        means_{[lanes](const Program& program) { return make_machine(program, lanes); }, &workers()} {}
  InterpreterBackend(std::string name, std::string description, MakeMachine make)
      : HostBackend(1), name_(std::move(name)), description_(std::move(description)), means_{std::move(make), nullptr} {}

  std::string_view name() const override { return name_; }
  std::string description() const override { return description_; }

  bool transform(const ViewPass& pass, support::Array<float>& clip, Diagnostics& diagnostics) override {
    const Frame& frame = pass.frame;
    Buffers buffers(taker, &frame);
    if (!buffers.bind(pass, {}, frame.vertices, diagnostics)) return false;
    std::map<size_t, std::unique_ptr<Machine>> machines;
    size_t vertices = 0;
    for (const Draw& draw : pass.view.draws) vertices += draw.vertex_count;
    clip.resize(4 * vertices);
    float* next = clip.data();
    for (const Draw& draw : pass.view.draws) {
      std::unique_ptr<Machine>& machine = machines[draw.vertex_program];
      if (machine == nullptr) machine = means_.machine(*frame.programs[draw.vertex_program], diagnostics);
      if (machine == nullptr) return false;
      means_.for_each_chunk(draw.vertex_count, [&](size_t first, size_t count) {
        const std::array arguments{Argument::from(static_cast<int32_t>(draw.first_vertex + first)),
                                   Argument::uniform(draw.object), Argument::uniform(draw.projected)};
        machine->run(buffers.views(), arguments, static_cast<int>(count), next + 4 * first);
      });
      next += 4 * static_cast<size_t>(draw.vertex_count);
    }
    return true;
  }

  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override {
    const std::unique_ptr<Machine> machine = means_.machine(program, diagnostics);
    Buffers buffers(taker, nullptr);
    if (machine == nullptr || !buffers.bind(FrameBuffer::inputs, inputs, diagnostics)) return false;
    const size_t width = backends::word_count(program.results);
    outputs.resize(rows * width);
    means_.for_each_chunk(rows, [&](size_t first, size_t count) {
      const std::array arguments{Argument::from(static_cast<int32_t>(first))};
      machine->run(buffers.views(), arguments, static_cast<int>(count), outputs.data() + first * width);
    });
    return true;
  }

 protected:
  std::unique_ptr<backends::ViewRenderer> begin(const ViewPass& pass, const Layers& layers,
                                                std::span<const float> vertices, Diagnostics& diagnostics) override {
    auto renderer = std::make_unique<InterpreterViewRenderer>(means_, pass);
    if (!renderer->bind(layers, vertices, diagnostics)) return nullptr;
    return renderer;
  }

  bool screen(const ScreenPass& pass, const Layers& layers, int first_row, int rows, std::vector<float>& rgba,
              Diagnostics& diagnostics) override {
    const std::unique_ptr<Machine> machine = means_.machine(*pass.program, diagnostics);
    Buffers buffers(taker, nullptr);
    if (machine == nullptr || !buffers.bind(pass, layers, diagnostics)) return false;
    const auto width = static_cast<size_t>(pass.width);
    rgba.resize(4 * width * static_cast<size_t>(rows));
    means_.for_each(static_cast<size_t>(rows), [&](size_t y) {
      const std::array arguments{Argument::from(0), Argument::uniform(first_row + static_cast<int>(y))};
      machine->run(buffers.views(), arguments, pass.width, rgba.data() + 4 * width * y);
    });
    return true;
  }

 private:
  std::string name_, description_;
  Means means_;
};

}  // namespace

std::unique_ptr<Machine> make_machine(const driver::Program& program, int lanes) {
  return std::make_unique<BatchedMachine>(program, lanes);
}

std::unique_ptr<backends::Backend> create(std::string name, std::string description, MakeMachine make) {
  return std::make_unique<InterpreterBackend>(std::move(name), std::move(description), std::move(make));
}

std::unique_ptr<backends::Backend> create(int threads, int lanes) {
  return std::make_unique<InterpreterBackend>(threads, lanes);
}

}  // namespace isoshade::interpreter
