// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/shaders.h"

#include "backends/vulkan/limits.h"
#include "compiler/emit/glsl.h"

namespace isoshade::vulkan {

const std::string& full_screen_vertex() {
  // Half of clip space is the frame (see limits.h): from pixel 0 to the edge of the guard band.
  static const std::string text = emit::glsl_head() + R"(
void main() {
  vec2 corner = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";
  return text;
}

const std::string& triangle_vertex() {
  static_assert(guard_band * 256 == 2097152);
  using namespace lower;
  static const std::string text = emit::glsl_head() + "layout(std430, set = 0, binding = " +
                                  std::to_string(static_cast<int>(FrameBuffer::triangles)) +
                                  ") readonly buffer triangles_block { int triangles[]; };" + R"(
layout(location = 0) flat out int triangle;

void main() {
  triangle = gl_VertexIndex / 3;
  int corner = gl_VertexIndex - 3 * triangle;
  int word = triangle * )" + std::to_string(triangle_word::stride) +
                                  " + " + std::to_string(triangle_word::position) + R"( + 2 * corner;
  vec2 position = vec2(float(triangles[word]), float(triangles[word + 1]));
  gl_Position = vec4(position * (1.0 / 2097152.0), 0.0, 1.0);
}
)";
  return text;
}

}  // namespace isoshade::vulkan
