// SPDX-License-Identifier: Apache-2.0
// The probe's arithmetic: a table of operands, the shader that computes on it, and what it must give.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::vulkan {

/// What a word of the probe's results shows.
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

/// Of each result word; at most max_result_words.
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

/// What the contract asks for: a record of word_topics().size() words for each row, computed on the host.
std::vector<int32_t> expected_words(std::span<const Operands> rows);

/// Computes a row: a fragment shader of Target::words, or a vertex shader that stores row gl_VertexIndex at the
/// output binding.
std::string probe_fragment_glsl();
std::string probe_vertex_glsl();

}  // namespace isoshade::vulkan
