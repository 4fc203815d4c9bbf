// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/document_runs.h"

#include <bit>
#include <cmath>
#include <random>

#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/sampling.h"
#include "compiler/lower/stages.h"
#include "compiler/nodes/row.h"

namespace isoshade::accuracy {
namespace {

using lower::FrameBuffer;
using lower::Int;
using lower::Kernel;

constexpr int light_words = 6;  // direction, colour
constexpr int lights = 1024, pixels = 64;

constexpr std::array<std::array<int, 2>, Surroundings::textures> sizes{
    {{1, 1}, {2, 3}, {16, 16}, {5, 7}, {8192, 1}, {1, 8192}}};

class Numbers {
 public:
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  uint32_t in(double most) {
    constexpr double special[] = {0, 1, 1, 0.5};
    const uint64_t way = random_() % 8;
    const double value = way < 4   ? most * special[way]
                         : way < 6 ? most * unit()
                                   : most * std::exp2(-30 * unit());
    return std::bit_cast<uint32_t>(static_cast<float>(value));
  }

 private:
  std::mt19937_64 random_{11};
};

}  // namespace

Surroundings::Surroundings() {
  Numbers numbers;
  const auto buffer = [&](FrameBuffer which) -> std::vector<uint32_t>& {
    return buffers_[static_cast<size_t>(which)];
  };
  for (int i = 0; i < lights; ++i) {
    std::array<double, 3> v{2 * numbers.unit() - 1, 2 * numbers.unit() - 1, 2 * numbers.unit() - 1};
    if (i % 3 == 0) v = {0, i % 2 == 0 ? 1.0 : -1.0, 0};
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (const double c : v)
      buffer(FrameBuffer::lights).push_back(std::bit_cast<uint32_t>(static_cast<float>(c / length)));
    for (int c = 0; c < 3; ++c) buffer(FrameBuffer::lights).push_back(numbers.in(1e6));
  }
  for (const auto& [width, height] : sizes) {
    const auto first = static_cast<uint32_t>(buffer(FrameBuffer::texels).size());
    for (int i = 0; i < 4 * width * height; ++i) buffer(FrameBuffer::texels).push_back(numbers.in(1000));
    for (const uint32_t word : {first, static_cast<uint32_t>(width), static_cast<uint32_t>(height), 0u, 1u, ~0u})
      buffer(FrameBuffer::textures).push_back(word);
  }
  buffer(FrameBuffer::texel_bytes).push_back(0);
  for (int i = 0; i < 4 * pixels; ++i) buffer(FrameBuffer::layers).push_back(numbers.in(1e6));
  for (int i = 0; i < 4 * pixels; ++i)  // motions, of both signs
    buffer(FrameBuffer::layers).push_back(numbers.in(lower::farthest_motion) | (i % 3 == 0 ? 0x80000000u : 0u));
  for (int i = 0; i < pixels; ++i) buffer(FrameBuffer::objects).push_back(numbers.in(1));  // depths
}

void Surroundings::define(ir::Module& module, const interface::Interface& interface) {
  module.buffers = lower::frame_module().buffers;
  lower::define_texture_reads(module, interface);
  for (const interface::HostFunction& function : interface.host) {
    if (!module.functions[function.function].is_declaration()) continue;
    Kernel k(module, function.function);
    if (function.host == interface::Host::light) {
      const Int record = k.integer(0) * Int(light_words);
      k.b.finish(std::array{k.load3(FrameBuffer::lights, record, 0).value,
                            k.load3(FrameBuffer::lights, record, 3).value});
      continue;
    }
    if (function.host == interface::Host::environment || function.host == interface::Host::irradiance) {
      k.b.finish(std::array{k.load3(FrameBuffer::layers, k.constant(0), 0).value});
      continue;
    }
    const Int pixel = (k.integer(0) * Int(7) + k.integer(1) * Int(13)) & Int(pixels - 1);
    if (function.host == interface::Host::depth)
      k.b.finish(std::array{k.load(FrameBuffer::objects, pixel).value});
    else {
      const bool is_motion = module.functions[function.function].name.find("motion") != std::string::npos;
      k.b.finish(std::array{k.load4(FrameBuffer::layers, pixel * Int(4), is_motion ? 4 * pixels : 0).value});
    }
  }
}

DocumentRuns::DocumentRuns(ir::Module floats, ir::Module exact, const interface::Interface& interface)
    : floats_module_((Surroundings::define(floats, interface), std::move(floats))),
      exact_module_((Surroundings::define(exact, interface), std::move(exact))),
      entry_(interface.entry),
      interpreter_(floats_module_, ir::Preconditions::report),
      evaluator_(exact_module_) {
  surroundings_.bind(interpreter_);
  surroundings_.bind(evaluator_);
  size_t words = 0;
  for (const ir::Result& result : exact_module_.functions[entry_].results) words += result.type.width;
  floats_.resize(words);
  exact_.resize(words);
}

bool DocumentRuns::run_floats(std::span<const uint32_t> arguments) {
  interpreter_.limit_steps(1'000'000);
  return interpreter_.run(entry_, arguments, floats_);
}

void DocumentRuns::run_exact(std::span<const uint32_t> arguments) {
  std::vector<reference::Cell> cells;
  size_t next = 0;
  for (const ir::Parameter& parameter : parameters())
    for (uint32_t i = 0; i < parameter.type.width; ++i, ++next)
      cells.push_back({parameter.type.is_float() ? reference::Real(std::bit_cast<float>(arguments[next]))
                                                 : reference::Real(),
                       arguments[next]});
  evaluator_.run(entry_, cells, exact_);
}

}  // namespace isoshade::accuracy
