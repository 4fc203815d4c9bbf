// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/backend.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

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
using driver::Program;
using lower::FrameBuffer;
using support::Diagnostics;
namespace word = lower::triangle_word;

/// The arrays of a call as words.
class Buffers {
 public:
  template <class T>
  void bind(FrameBuffer buffer, std::span<const T> values) {
    std::vector<uint32_t>& words = words_[static_cast<size_t>(buffer)];
    words.resize(values.size());
    std::ranges::transform(values, words.begin(), [](T value) { return std::bit_cast<uint32_t>(value); });
  }
  void bind_frame(const Frame& frame, std::span<const float> vertices) {
    bind(FrameBuffer::vertices, vertices);
    bind<float>(FrameBuffer::objects, frame.objects);
    bind<float>(FrameBuffer::lights, frame.lights);
    bind<float>(FrameBuffer::frame, frame.frame);
    bind<float>(FrameBuffer::view, frame.view);
    bind<float>(FrameBuffer::texels, frame.texels);
    bind<uint32_t>(FrameBuffer::texel_bytes, frame.texel_bytes);
    bind<int32_t>(FrameBuffer::textures, frame.textures);
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

bool bears(const Program& program, Diagnostics& diagnostics) {
  return driver::within_limits(program, driver::Target::interpreter, driver::Division::native, diagnostics);
}

/// A program that is ready to run.
class StageRunner {
 public:
  StageRunner(const MakeMachine& make, const Program& program, const Buffers& buffers)
      : machine_(make(program)), entry_(program.entry) {
    for (uint32_t i = 0; i < program.module.buffers.size(); ++i) machine_->bind(i, buffers[i]);
  }
  void run(std::initializer_list<int> arguments, std::span<uint32_t> results) {
    std::array<uint32_t, 5> words;
    std::ranges::transform(arguments, words.begin(), [](int a) { return static_cast<uint32_t>(a); });
    machine_->run(entry_, std::span(words).first(arguments.size()), results);
  }

 private:
  std::unique_ptr<Machine> machine_;
  uint32_t entry_;
};

class InterpreterDrawing final : public backends::Drawing {
 public:
  InterpreterDrawing(const MakeMachine& make, const Frame& frame, std::span<const float> vertices)
      : make_(make), frame_(frame) {
    buffers_.bind_frame(frame, vertices);
  }

  bool draw(const backends::Window& window, std::span<const int32_t> triangles, Image& image,
            Diagnostics& diagnostics) override {
    buffers_.bind(FrameBuffer::triangles, triangles);
    image.resize(window.width, window.height);
    std::vector<int32_t> visible(image.depth.size());
    raster::rasterize_reference(triangles, raster::box_at(window.x, window.y, window.width, window.height),
                                visible, image.depth);

    std::map<size_t, StageRunner> pixels;
    for (size_t i = 0; i < visible.size(); ++i) {
      float* color = image.rgba.data() + 4 * i;
      if (visible[i] < 0) {
        std::ranges::copy(frame_.background, color);
        continue;
      }
      const int object = raster::triangle_at(triangles.data(), visible[i]).object();
      const auto program =
          static_cast<size_t>(frame_.objects[static_cast<size_t>(object) + lower::object_word::program]);
      support::assert_that(program < frame_.programs.size(), "an object has a program that the frame lacks");
      if (!pixels.contains(program) && !bears(*frame_.programs[program], diagnostics)) return false;
      StageRunner& pixel = pixels.try_emplace(program, make_, *frame_.programs[program], buffers_).first->second;
      const int x = window.x + static_cast<int>(i) % window.width;
      const int y = window.y + static_cast<int>(i) / window.width;
      std::array<uint32_t, 4> result;
      pixel.run({x, y, visible[i], object, frame_.light_count}, result);
      std::ranges::transform(result, color, [](uint32_t bits) { return std::bit_cast<float>(bits); });
    }
    return true;
  }

 private:
  const MakeMachine& make_;
  const Frame& frame_;
  Buffers buffers_;
};

class InterpreterBackend final : public backends::Backend {
 public:
  InterpreterBackend(std::string name, std::string description, MakeMachine make)
      : name_(std::move(name)), description_(std::move(description)), make_(std::move(make)) {}

  std::string_view name() const override { return name_; }
  std::string description() const override { return description_; }

  bool transform(const Frame& frame, std::vector<std::vector<float>>& clip,
                 Diagnostics& diagnostics) override {
    Buffers buffers;
    buffers.bind_frame(frame, frame.vertices);
    clip.resize(frame.draws.size());
    for (size_t d = 0; d < frame.draws.size(); ++d) {
      const Draw& draw = frame.draws[d];
      if (!bears(*frame.programs[draw.vertex_program], diagnostics)) return false;
      StageRunner vertex(make_, *frame.programs[draw.vertex_program], buffers);
      clip[d].resize(4 * static_cast<size_t>(draw.vertex_count));
      for (uint32_t i = 0; i < draw.vertex_count; ++i) {
        std::array<uint32_t, 4> position;
        vertex.run({static_cast<int>(draw.first_vertex + i), draw.object, draw.projected}, position);
        for (size_t k = 0; k < 4; ++k) clip[d][4 * i + k] = std::bit_cast<float>(position[k]);
      }
    }
    return true;
  }

  std::unique_ptr<backends::Drawing> begin(const Frame& frame, std::span<const float> vertices,
                                           Diagnostics&) override {
    return std::make_unique<InterpreterDrawing>(make_, frame, vertices);
  }

  bool post(const backends::ScreenPass& pass, std::vector<float>& rgba, Diagnostics& diagnostics) override {
    if (!bears(*pass.program, diagnostics)) return false;
    Buffers buffers;
    buffers.bind(FrameBuffer::frame, pass.frame);
    buffers.bind(FrameBuffer::view, pass.view);
    buffers.bind(FrameBuffer::objects, pass.record);
    buffers.bind(FrameBuffer::layers, pass.images);
    buffers.bind(FrameBuffer::layer_records, pass.image_records);
    StageRunner runner(make_, *pass.program, buffers);
    rgba.resize(size_t{4} * static_cast<size_t>(pass.width) * static_cast<size_t>(pass.height));
    size_t next = 0;
    for (int y = 0; y < pass.height; ++y) {
      for (int x = 0; x < pass.width; ++x) {
        std::array<uint32_t, 4> result;
        runner.run({x, y}, result);
        for (const uint32_t bits : result) rgba[next++] = std::bit_cast<float>(bits);
      }
    }
    return true;
  }

  bool evaluate(const Program& program, std::span<const int32_t> inputs, size_t rows,
                std::vector<int32_t>& outputs, Diagnostics& diagnostics) override {
    if (!bears(program, diagnostics)) return false;
    Buffers buffers;
    buffers.bind(FrameBuffer::inputs, inputs);
    size_t width = 0;
    for (const driver::Field& field : program.results) width += static_cast<size_t>(field.words);
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
