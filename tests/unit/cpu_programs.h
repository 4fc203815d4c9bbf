// SPDX-License-Identifier: Apache-2.0
// Programs written by hand as the emitter writes them: what a CPU backend needs to be tested by itself.
#pragma once

#include <string>

#include "compiler/driver/program.h"

namespace isoshade::cpu {

inline const std::string program_head = R"(
#include "isoshade/lanes/lanes.h"
namespace program {
using namespace isoshade::lanes;
#if ISOSHADE_LANES == 1
using F = float;
#else
using F = Float<ISOSHADE_LANES, ISOSHADE_REGISTERS>;
#endif
using I = int_of<F>;
constexpr int batch = lane_count<F>;
}
struct BufferView { const void* data; int size; };
#define EXPORT extern "C" __attribute__((visibility("default")))
)";

/// Positions times the first word of the object's record; w is 1.
inline const std::string vertex_text = program_head + R"(
EXPORT void isoshade_vertex(const BufferView* buffers, int object, int, int first, int count, float* clip) {
  using namespace program;
  const FloatBuffer vertices{static_cast<const float*>(buffers[0].data), buffers[0].size};
  const FloatBuffer objects{static_cast<const float*>(buffers[2].data), buffers[2].size};
  for (int begin = 0; begin < count; begin += batch) {
    const I record = (lane_index<I>() + (first + begin)) * 24;  // lower::vertex_word::stride
    const float scale = load(objects, object);
    float words[4][batch];
    store_lanes(words[0], load(vertices, record) * F(scale));
    store_lanes(words[1], load(vertices, record + 1) * F(scale));
    store_lanes(words[2], load(vertices, record + 2));
    store_lanes(words[3], F(1.0f));
    for (int lane = 0; lane < batch && begin + lane < count; ++lane)
      for (int word = 0; word < 4; ++word) clip[4 * (begin + lane) + word] = words[word][lane];
  }
}
)";

/// The colour is (x, y, triangle, first word of the object's record times the number of lights); NaN in a
/// corner.
inline const std::string pixel_text = program_head + R"(
EXPORT void isoshade_pixel(const BufferView* buffers, int object, int light_count, int count, const int* x,
                           const int* y, const int* triangle, float* rgba) {
  using namespace program;
  const FloatBuffer objects{static_cast<const float*>(buffers[2].data), buffers[2].size};
  for (int begin = 0; begin < count; begin += batch) {
    int in[3][batch];
    for (int lane = 0; lane < batch; ++lane) {
      const int i = begin + lane < count ? begin + lane : count - 1;
      in[0][lane] = x[i], in[1][lane] = y[i], in[2][lane] = triangle[i];
    }
    const F fx = to_float(load_lanes<I>(in[0])), fy = to_float(load_lanes<I>(in[1]));
    const F zero = (fx + fy) * 0.0f;
    float words[4][batch];
    store_lanes(words[0], fx);
    store_lanes(words[1], select(fx + fy == F(0.0f), negate(zero / zero), fy));
    store_lanes(words[2], to_float(load_lanes<I>(in[2])));
    store_lanes(words[3], F(load(objects, object)) * F(to_float(light_count)));
    for (int lane = 0; lane < batch && begin + lane < count; ++lane)
      for (int word = 0; word < 4; ++word) rgba[4 * (begin + lane) + word] = words[word][lane];
  }
}
)";

/// Of two input words as floats: their product, and the row.
inline const std::string eval_text = program_head + R"(
EXPORT void isoshade_eval(const BufferView* buffers, int first, int count, int* results) {
  using namespace program;
  const IntBuffer inputs{static_cast<const int*>(buffers[6].data), buffers[6].size};
  for (int begin = 0; begin < count; begin += batch) {
    const I row = lane_index<I>() + (first + begin);
    const F a = from_bits(load(inputs, row * 2)), b = from_bits(load(inputs, row * 2 + 1));
    int words[2][batch];
    store_lanes(words[0], bits(a * b));
    store_lanes(words[1], row);
    for (int lane = 0; lane < batch && begin + lane < count; ++lane)
      for (int word = 0; word < 2; ++word) results[2 * (begin + lane) + word] = words[word][lane];
  }
}
)";

/// A program that stands for one of the texts, or for the text that its name is.
inline driver::Program program_of(driver::Stage stage, std::string name = "") {
  driver::Program program;
  program.stage = stage;
  program.name = std::move(name);
  program.results = {{"product", "float", 1, {}, {}, {}}, {"row", "integer", 1, {}, {}, {}}};
  return program;
}

inline std::string text_of(const driver::Program& program) {
  switch (program.stage) {
    case driver::Stage::vertex: return vertex_text;
    case driver::Stage::pixel: return pixel_text;
    default: return program.name.empty() ? eval_text : program.name;
  }
}

}  // namespace isoshade::cpu
