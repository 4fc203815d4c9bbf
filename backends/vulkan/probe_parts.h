// SPDX-License-Identifier: Apache-2.0
// The two parts of the probe: arithmetic, a table of operands, the shader that computes on it and the expected results;
// and coverage, triangles in many small cells, each with a few triangles of its own, so that the coverage of nearly
// every triangle is seen and not only what ends on top.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/vulkan/device.h"

namespace isoshade::vulkan {

/// Random numbers that are the same on every machine (splitmix64, Steele et al. 2014).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint32_t bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<uint32_t>((z ^ (z >> 31)) >> 32);
  }
  /// From first to last, both included.
  int between(int first, int last) {
    return first + static_cast<int>(bits() % static_cast<uint32_t>(last - first + 1));
  }

 private:
  uint64_t state_;
};

/// What a word of the results tests.
enum class Topic : uint8_t {
  arithmetic,
  fusing,
  division,
  selection,
  comparisons,
  rounding,
  bits,
  conversions,
  integers,
};
inline constexpr int topic_count = 9;
std::string_view name(Topic topic);

/// The topic of each result word; at most max_result_words.
std::span<const Topic> word_topics();
/// "quotient"
std::string_view word_name(size_t word);

/// A row: three operands as bits. They are read as floats, denormals flushed, and as ints.
struct Operands {
  int32_t a = 0;
  int32_t b = 0;
  int32_t c = 0;
};

/// The same rows on every machine: special values in pairs, results around the smallest normal number, sums
/// that show a fused multiply-add, quotients and roots as near to the middle between two floats as there are,
/// and random bits.
std::vector<Operands> probe_operands();

/// The words that the contract requires: a record of word_topics().size() words for each row, computed on the host.
std::vector<int32_t> expected_words(std::span<const Operands> rows);

/// Computes a row: a fragment shader of Output::words, or a vertex shader that stores row gl_VertexIndex at the
/// output binding.
std::string probe_fragment_glsl();
std::string probe_vertex_glsl();
/// The same as a compute shader.
std::string probe_compute_glsl();

/// A cell, and the triangles that are drawn with its area as scissor.
struct Cell {
  Window area;
  uint32_t first = 0;  ///< triangle
  uint32_t count = 0;
};

inline constexpr int cell_size = 16;  ///< pixels each way

struct CoverageScene {
  int width = 0;
  int height = 0;
  std::vector<Cell> cells;
  std::vector<int32_t> triangles;  ///< records of frame_layout.h of which only the positions are set
  std::vector<int32_t> values;     ///< for each triangle, as bits: its depth (constant), its color
};
inline constexpr int value_stride = 5;

/// A frame of `length` pixels along x or along y, at most to the end of the guard band. The same on every
/// machine.
CoverageScene coverage_scene(int length, bool along_y);

/// The image that the scene must give over a background, computed with exact edge functions.
backends::Image expected_image(const CoverageScene& scene, const float (&background)[4]);

/// Fragment shaders. The first writes depth, and an id made of the triangle and of gl_FragCoord; the second shows the
/// triangle's color, or (-1, -1, -1, -1) if the id holds another pixel.
std::string coverage_visibility_glsl();
std::string coverage_color_glsl();

}  // namespace isoshade::vulkan
