// SPDX-License-Identifier: Apache-2.0
// The passes over a program, and the programs that no document asks for.
#include "compiler/driver/finish.h"

#include <array>
#include <atomic>

#include "compiler/driver/dumps.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/setup.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"

namespace isoshade::driver {

void set_number(Program& program) {
  static std::atomic<uint64_t> last_number = 0;
  program.number = ++last_number;
}

std::optional<passes::DrawRate> draw_rate(Stage stage, uint32_t first) {
  using lower::FrameBuffer;
  const auto number = [](FrameBuffer buffer) { return static_cast<uint32_t>(buffer); };
  passes::DrawRate rate;
  rate.floats = number(FrameBuffer::objects);
  rate.integers = number(FrameBuffer::object_integers);
  rate.first = first;
  rate.buffers = {number(FrameBuffer::objects), number(FrameBuffer::textures), number(FrameBuffer::frame)};
  rate.late_words = {lower::object_word::first_light, lower::object_word::light_count};
  rate.parameter = lower::record_parameter(stage);
  switch (stage) {
    case Stage::vertex:
    case Stage::cutout:
    case Stage::pixel:
    case Stage::blend: break;
    case Stage::post:
      // Where the images lie is up to the backend.
      namespace word = lower::image_word;
      rate.buffers.push_back(number(FrameBuffer::view));
      rate.late_words.clear();
      rate.records = {number(FrameBuffer::layer_records), word::stride, {word::width, word::height}};
      break;
    case Stage::setup:
    case Stage::depth:
    case Stage::eval: return std::nullopt;
  }
  return rate;
}

void finish(Program& program, uint32_t kernel, const CompileOptions& options, support::Source source,
            std::optional<uint32_t> room) {
  set_number(program);
  program.entry = kernel;
  program.source = std::move(source);
  if (options.reference && !lower::decides_visibility(program.stage)) return passes::derivatives(program.module);
  passes::Entries entries{kernel};
  if (room) entries.draw_rate = draw_rate(program.stage, *room);
  const auto dump = [&](std::string_view pass, const ir::Module& after) {
    options.dump(pass, [&] { return dump_module(after); });
  };
  if (options.dump) dump("lower", program.module);
  passes::run(passes::optimisations(), program.module, entries, program.tier,
              options.dump ? passes::Dump(dump) : passes::Dump(), false, options.skips);
  program.entry = entries[0];
  if (entries.draw_values) program.draw = std::make_shared<const passes::DrawValues>(*std::move(entries.draw_values));
}

namespace {

template <class Add>
Program visibility_program(Stage stage, const Add& add) {
  Program made{stage, std::string(lower::name(stage)), "", lower::frame_module(), 0, {}, {}};
  finish(made, add(made.module), {});
  return made;
}

}  // namespace

const Program& plain_vertex_program() {
  static const Program program = [] {
    Program made{lower::Stage::vertex, "", "", lower::frame_module(), 0, {}, {}};
    finish(made, lower::add_vertex_kernel(made.module), {});
    return made;
  }();
  return program;
}

const Program& depth_program() {
  static const Program program = visibility_program(Stage::depth, lower::add_depth_kernel);
  return program;
}

const Program& setup_program() {
  static const Program program = visibility_program(Stage::setup, lower::add_setup_kernel);
  return program;
}

namespace {

/// A program that no document asks for, in both forms.
template <class Add>
std::array<Program, 2> both_forms(Stage stage, std::string_view name, const Add& add) {
  std::array<Program, 2> both;
  for (const bool reference : {false, true}) {
    Program& made = both[reference ? 1 : 0];
    made = {stage, std::string(name), "", lower::frame_module(), 0, {}, {}};
    CompileOptions options;
    options.reference = reference;
    finish(made, add(made.module), options);
  }
  return both;
}

}  // namespace

const Program& motion_program(bool reference) {
  static const std::array programs = both_forms(Stage::pixel, "motion", lower::add_motion_kernel);
  return programs[reference ? 1 : 0];
}

const Program& backdrop_motion_program(bool reference) {
  static const std::array programs = both_forms(Stage::post, "backdrop_motion", lower::add_backdrop_motion_kernel);
  return programs[reference ? 1 : 0];
}

}  // namespace isoshade::driver
