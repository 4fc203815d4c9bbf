// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/backend.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

#include "backends/host_backend.h"
#include "compiler/driver/target_limits.h"
#include "compiler/ir/interpreter.h"
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

/// The arrays of a call, as bits.
class Buffers {
 public:
  template <class T>
  void bind(FrameBuffer buffer, std::span<const T> values) {
    std::vector<uint32_t>& words = words_[static_cast<size_t>(buffer)];
    words.resize(values.size());
    std::ranges::transform(values, words.begin(), [](T value) { return std::bit_cast<uint32_t>(value); });
  }
  void bind(const ViewPass& pass, const Layers& layers, std::span<const float> vertices) {
    const auto use = [&]<class T>(FrameBuffer buffer, std::span<const T> values) {
      bind(buffer, values);
      return true;
    };
    backends::for_each_array(pass, layers, vertices, use);
    backends::for_each_texture_array(pass.frame, use);
  }
  void bind(const ScreenPass& pass, const Layers& layers) {
    backends::for_each_array(pass, layers, [&]<class T>(FrameBuffer buffer, std::span<const T> values) {
      bind(buffer, values);
      return true;
    });
  }
  const std::vector<uint32_t>& operator[](size_t buffer) const { return words_[buffer]; }

 private:
  std::array<std::vector<uint32_t>, std::size(lower::frame_buffers)> words_;
};

class InterpretingMachine final : public Machine {
 public:
  explicit InterpretingMachine(const ir::Module& module) : interpreter_(module) {}
  void bind(uint32_t buffer, std::span<const uint32_t> words) override { interpreter_.bind(buffer, words); }
  void run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results) override {
    const bool finished = interpreter_.run(function, arguments, results);
    support::assert_that(finished, "an interpreter without a limit stopped early");
  }

 private:
  ir::Interpreter interpreter_;
};

/// Reports a program that is too large.
bool is_within_limits(const Program& program, Diagnostics& diagnostics) {
  return driver::within_limits(program, driver::Target::interpreter, driver::Division::native, diagnostics);
}

/// A program that is ready to run.
class StageRunner {
 public:
  StageRunner(const MakeMachine& make, const Program& program, const Buffers& buffers)
      : machine_(make(program)), entry_(program.entry) {
    for (uint32_t i = 0; i < program.module.buffers.size(); ++i) machine_->bind(i, buffers[i]);
  }
  /// `color`: the words of a further argument.
  void run(std::initializer_list<int> arguments, std::span<uint32_t> results, std::span<const uint32_t> color = {}) {
    std::array<uint32_t, 9> words;
    const auto end = std::ranges::transform(arguments, words.begin(), [](int a) { return static_cast<uint32_t>(a); });
    std::ranges::copy(color, end.out);
    machine_->run(entry_, std::span(words).first(arguments.size() + color.size()), results);
  }

 private:
  std::unique_ptr<Machine> machine_;
  uint32_t entry_;
};

class InterpreterViewRenderer final : public backends::ViewRenderer {
 public:
  InterpreterViewRenderer(const MakeMachine& make, const ViewPass& pass, const Layers& layers,
                          std::span<const float> vertices)
      : make_(make), pass_(pass) {
    buffers_.bind(pass, layers, vertices);
  }

  bool draw(const backends::Window& window, std::span<const int32_t> triangles, Image& image,
            Diagnostics& diagnostics) override {
    buffers_.bind(FrameBuffer::triangles, triangles);
    image.resize(window.width, window.height, pass_.view.target.has_color);
    const Frame& frame = pass_.frame;
    std::map<size_t, StageRunner> pixels, cutouts;
    for (int i = 0; i < static_cast<int>(triangles.size()) / lower::triangle_word::stride; ++i) {
      const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
      if (!triangle.cutout()) continue;
      const size_t program = backends::cutout_program_of(frame, triangle.object());
      if (cutouts.contains(program)) continue;
      if (!is_within_limits(*frame.programs[program], diagnostics)) return false;
      cutouts.try_emplace(program, make_, *frame.programs[program], buffers_);
    }
    const auto is_drawn = [&](int triangle, int x, int y) {
      const int object = raster::triangle_at(triangles.data(), triangle).object();
      std::array<uint32_t, 2> result;  // drawn, depth
      cutouts.at(backends::cutout_program_of(frame, object)).run({x, y, triangle, object}, result);
      return result[0] != 0;
    };
    const auto count = static_cast<int>(triangles.size()) / lower::triangle_word::stride;
    const int opaque = raster::opaque_count(triangles.data(), count);
    std::vector<int32_t> visible(image.depth.size());
    raster::rasterize_reference(triangles.first(static_cast<size_t>(opaque) * lower::triangle_word::stride),
                                raster::box_at(window.x, window.y, window.width, window.height),
                                visible, image.depth, is_drawn);
    if (!pass_.view.target.has_color) return true;

    for (size_t i = 0; i < visible.size(); ++i) {
      float* color = image.rgba.data() + 4 * i;
      if (visible[i] < 0) {
        std::ranges::copy(pass_.view.background, color);
        continue;
      }
      const int object = raster::triangle_at(triangles.data(), visible[i]).object();
      const size_t program = backends::pixel_program_of(frame, object);
      if (!pixels.contains(program) && !is_within_limits(*frame.programs[program], diagnostics)) return false;
      StageRunner& pixel =
          pixels.try_emplace(program, make_, *frame.programs[program], buffers_).first->second;
      const int x = window.x + static_cast<int>(i) % window.width;
      const int y = window.y + static_cast<int>(i) / window.width;
      std::array<uint32_t, 4> result;
      pixel.run({x, y, visible[i], object, frame.light_count}, result);
      std::ranges::transform(result, color, [](uint32_t bits) { return std::bit_cast<float>(bits); });
    }
    for (int i = opaque; i < count; ++i) {
      const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
      const size_t program = backends::pixel_program_of(frame, triangle.object());
      if (!pixels.contains(program) && !is_within_limits(*frame.programs[program], diagnostics)) return false;
      StageRunner& runner =
          pixels.try_emplace(program, make_, *frame.programs[program], buffers_).first->second;
      blend(window, triangle, i, runner, is_drawn, image);
    }
    return true;
  }

 private:
  /// Draws a triangle that is blended.
  void blend(const backends::Window& window, const raster::Triangle& triangle, int number, StageRunner& runner,
             const raster::IsDrawn& is_drawn, Image& image) const {
    const raster::Box area = raster::box_at(window.x, window.y, window.width, window.height);
    raster::for_each_covered(triangle.words, area, [&](int x, int y, float nearness) {
      const size_t place = static_cast<size_t>(y - window.y) * static_cast<size_t>(window.width) +
                           static_cast<size_t>(x - window.x);
      if (!triangle.over() && !(nearness > image.depth[place])) return;
      if (triangle.cutout() && !is_drawn(number, x, y)) return;
      float* color = image.rgba.data() + 4 * place;
      std::array<uint32_t, 4> backdrop;
      std::array<uint32_t, 5> result;  // color, depth
      for (size_t c = 0; c < 4; ++c) backdrop[c] = std::bit_cast<uint32_t>(color[c]);
      runner.run({x, y, number, triangle.object(), pass_.frame.light_count}, result, backdrop);
      for (size_t c = 0; c < 4; ++c) color[c] = std::bit_cast<float>(result[c]);
      if (!triangle.keeps_depth()) image.depth[place] = nearness;
    });
  }

  const MakeMachine& make_;
  const ViewPass pass_;
  Buffers buffers_;
};

class InterpreterBackend final : public backends::HostBackend {
 public:
  InterpreterBackend(std::string name, std::string description, MakeMachine make)
      : name_(std::move(name)), description_(std::move(description)), make_(std::move(make)) {}

  std::string_view name() const override { return name_; }
  std::string description() const override { return description_; }

  bool transform(const ViewPass& pass, support::Array<float>& clip, Diagnostics& diagnostics) override {
    const Frame& frame = pass.frame;
    Buffers buffers;
    buffers.bind(pass, {}, frame.vertices);
    clip.clear();
    for (const Draw& draw : pass.view.draws) {
      if (!is_within_limits(*frame.programs[draw.vertex_program], diagnostics)) return false;
      StageRunner vertex(make_, *frame.programs[draw.vertex_program], buffers);
      for (uint32_t i = 0; i < draw.vertex_count; ++i) {
        std::array<uint32_t, 4> position;
        vertex.run({static_cast<int>(draw.first_vertex + i), draw.object, draw.projected}, position);
        for (const uint32_t bits : position) clip.push_back(std::bit_cast<float>(bits));
      }
    }
    return true;
  }

  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override {
    if (!is_within_limits(program, diagnostics)) return false;
    Buffers buffers;
    buffers.bind(FrameBuffer::inputs, inputs);
    const size_t width = backends::word_count(program.results);
    outputs.resize(rows * width);
    StageRunner eval(make_, program, buffers);
    std::vector<uint32_t> results(width);
    for (size_t row = 0; row < rows; ++row) {
      eval.run({static_cast<int>(row)}, results);
      std::ranges::transform(results, outputs.begin() + static_cast<ptrdiff_t>(row * width),
                             [](uint32_t bits) { return std::bit_cast<int32_t>(bits); });
    }
    return true;
  }

 protected:
  std::unique_ptr<backends::ViewRenderer> begin(const ViewPass& pass, const Layers& layers,
                                                std::span<const float> vertices, Diagnostics&) override {
    return std::make_unique<InterpreterViewRenderer>(make_, pass, layers, vertices);
  }

  bool screen(const ScreenPass& pass, const Layers& layers, int first_row, int rows, std::vector<float>& rgba,
              Diagnostics& diagnostics) override {
    if (!is_within_limits(*pass.program, diagnostics)) return false;
    Buffers buffers;
    buffers.bind(pass, layers);
    StageRunner runner(make_, *pass.program, buffers);
    rgba.resize(size_t{4} * static_cast<size_t>(pass.width) * static_cast<size_t>(rows));
    size_t next = 0;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < pass.width; ++x) {
        std::array<uint32_t, 4> result;
        runner.run({x, first_row + y}, result);
        for (const uint32_t bits : result) rgba[next++] = std::bit_cast<float>(bits);
      }
    }
    return true;
  }

 private:
  std::string name_, description_;
  MakeMachine make_;
};

}  // namespace

std::unique_ptr<Machine> make_machine(const driver::Program& program) {
  return std::make_unique<InterpretingMachine>(program.module);
}

std::unique_ptr<backends::Backend> create(std::string name, std::string description, MakeMachine make) {
  return std::make_unique<InterpreterBackend>(std::move(name), std::move(description), std::move(make));
}

std::unique_ptr<backends::Backend> create() {
  return create("interpreter", "interpreter, 1 lane, 1 thread, native division", make_machine);
}

}  // namespace isoshade::interpreter
