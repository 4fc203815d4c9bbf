// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/stages.h"

#include <array>

namespace isoshade::interpreter {

size_t stored_words(const driver::Program& program) {
  size_t all = 0;
  for (const ir::Result& result : program.module.functions[program.entry].results) all += result.type.width;
  switch (program.stage) {
    case driver::Stage::cutout: return 1;  // whether it is drawn; the rasteriser has the depth
    case driver::Stage::blend: return 4;   // the color, likewise
    case driver::Stage::vertex:
    case driver::Stage::setup:
    case driver::Stage::depth:
    case driver::Stage::pixel:
    case driver::Stage::eval:
    case driver::Stage::post: break;
  }
  return all;
}

Stages::Stages(const driver::Program& program, int lanes)
    : code_(program.module, program.entry, stored_words(program), lanes) {}

void Stages::vertex(const BufferView* buffers, int object, int projected, int first, int count, float* clip) const {
  const std::array arguments{Argument::from(first), Argument::uniform(object), Argument::uniform(projected)};
  code_.run(buffers, arguments, count, clip);
}

void Stages::pixel(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
                   const int* triangle, float* rgba) const {
  const std::array arguments{Argument::listed(x), Argument::listed(y), Argument::listed(triangle),
                             Argument::uniform(object), Argument::uniform(light_count)};
  code_.run(buffers, arguments, count, rgba);
}

void Stages::blend(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
                   const int* triangle, float* rgba) const {
  // What is behind each pixel comes in `rgba`, and what it then shows goes there.
  const std::array arguments{
      Argument::listed(x),           Argument::listed(y),           Argument::listed(triangle),
      Argument::uniform(object),     Argument::uniform(light_count), Argument::listed(rgba, 4),
      Argument::listed(rgba + 1, 4), Argument::listed(rgba + 2, 4), Argument::listed(rgba + 3, 4)};
  code_.run(buffers, arguments, count, rgba);
}

void Stages::cutout(const BufferView* buffers, int object, int count, const int* x, const int* y, const int* triangle,
                    int* drawn) const {
  const std::array arguments{Argument::listed(x), Argument::listed(y), Argument::listed(triangle),
                             Argument::uniform(object)};
  code_.run(buffers, arguments, count, drawn);
}

void Stages::post(const BufferView* buffers, int first, int y, int count, float* rgba) const {
  const std::array arguments{Argument::from(first), Argument::uniform(y)};
  code_.run(buffers, arguments, count, rgba);
}

void Stages::eval(const BufferView* buffers, int first, int count, int* results) const {
  const std::array arguments{Argument::from(first)};
  code_.run(buffers, arguments, count, results);
}

}  // namespace isoshade::interpreter
