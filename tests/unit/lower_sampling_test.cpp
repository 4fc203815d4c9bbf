// SPDX-License-Identifier: Apache-2.0
// What textures give, against plain code, for sizes and coordinates of all kinds.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "compiler/functions/library.h"
#include "compiler/ir/interpreter.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/sampling.h"
#include "compiler/lower/stages.h"

namespace isoshade {
namespace {

using nodes::AddressMode;
using nodes::Filter;

/// Two textures, of which the first is a decoy, and what sample() makes of the second: of floats, or of bytes.
class Picture {
 public:
  static constexpr int floats = -1;

  Picture(int width, int height, int table = floats) : width_(width), height_(height), table_(table) {
    std::mt19937 random(7);
    const size_t count = size_t{1} * width * height + 1;
    const int words = table == floats ? static_cast<int>(4 * count) : 2 * lower::byte_table::size;
    for (int i = 0; i < words; ++i) texels_.push_back(std::ldexp(static_cast<float>(random() >> 8), -24));
    bytes_.resize(table == floats ? 1 : count);
    for (uint32_t& word : bytes_) word = static_cast<uint32_t>(random());
    records_ = {0, 1, 1, 0, 1, table, table == floats ? 4 : 1, width, height, 0, 1, table};
  }

  float texel(int x, int y, int channel) const {
    const auto place = static_cast<size_t>(1 + y * width_ + x);
    if (table_ == floats) return texels_[4 * place + static_cast<size_t>(channel)];
    const uint32_t byte = bytes_[place] >> 8 * channel & 255;
    return texels_[(channel == 3 ? 0 : static_cast<size_t>(table_)) + byte];
  }

  /// `chosen`: the same by numbers that are known only when it runs.
  std::vector<float> sample(const lower::Sampling& sampling, float u, float v, bool chosen = false) const {
    ir::Module module = lower::frame_module();
    ir::Function& function = module.functions.emplace_back();
    function.name = "probe";
    function.parameters = {{"texture", ir::int_type, "", false}, {"texcoord", ir::vector_type(2), "", false}};
    for (const char* name : {"filter", "u_mode", "v_mode"})
      if (chosen) function.parameters.push_back({name, ir::int_type, "", false});
    function.results = {{"color", ir::vector_type(4)}};
    ir::Builder b(module, 0);
    interface::Interface interface;
    lower::Chosen numbers;
    if (chosen) numbers = {b.parameter(2), b.parameter(3), b.parameter(4), false};
    b.finish(std::array{lower::sample(b, interface, sampling, b.parameter(0), b.parameter(1), numbers)});
    lower::define_texture_reads(module, interface);
    functions::expand(module);
    ir::Interpreter interpreter(module);
    std::vector<uint32_t> texels, records(records_.begin(), records_.end());
    for (const float value : texels_) texels.push_back(std::bit_cast<uint32_t>(value));
    interpreter.bind(static_cast<uint32_t>(lower::FrameBuffer::texels), texels);
    interpreter.bind(static_cast<uint32_t>(lower::FrameBuffer::texel_bytes), bytes_);
    interpreter.bind(static_cast<uint32_t>(lower::FrameBuffer::textures), records);
    std::vector<uint32_t> arguments{1, std::bit_cast<uint32_t>(u), std::bit_cast<uint32_t>(v)};
    if (chosen)
      for (const uint32_t number : {static_cast<uint32_t>(sampling.filter), static_cast<uint32_t>(sampling.u),
                                    static_cast<uint32_t>(sampling.v)})
        arguments.push_back(number);
    std::array<uint32_t, 4> results{};
    interpreter.run(0, arguments, results);
    EXPECT_EQ(interpreter.breaches(), 0u) << u << " " << v;
    std::vector<float> color;
    for (const uint32_t bits : results) color.push_back(std::bit_cast<float>(bits));
    return color;
  }

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_, height_, table_;
  std::vector<float> texels_;
  std::vector<uint32_t> bytes_;
  std::vector<int32_t> records_;
};

constexpr AddressMode modes[] = {AddressMode::periodic, AddressMode::clamp, AddressMode::mirror};
constexpr auto tables = {Picture::floats, lower::byte_table::linear, lower::byte_table::srgb};

std::vector<std::pair<AddressMode, int>> each_with(std::initializer_list<int> tables) {
  std::vector<std::pair<AddressMode, int>> all;
  for (const AddressMode mode : modes)
    for (const int table : tables) all.emplace_back(mode, table);
  return all;
}

/// The place in [0, 1] that a coordinate means.
double place(AddressMode mode, float x) {
  if (!std::isfinite(x)) return mode == AddressMode::clamp && x > 0 ? 1 : 0;
  if (mode == AddressMode::clamp) return std::clamp<double>(x, 0, 1);
  if (mode == AddressMode::periodic) return double{x} - std::floor(double{x});
  const double in_two = std::fmod(std::abs(double{x}), 2.0);
  return in_two > 1 ? 2 - in_two : in_two;
}

/// The texel that lies at an index beyond the edges by at most one.
int around(AddressMode mode, int index, int size) {
  if (mode == AddressMode::periodic) return (index + size) % size;
  return std::clamp(index, 0, size - 1);
}

std::vector<float> coordinates() {
  const float inf = std::numeric_limits<float>::infinity();
  std::vector<float> all{
      0,       -0.0f, 1,     0.5f, -1,     2,     -2.5f, 0.999999940f, 1.00000012f,  1e-30f,
      -1e-30f, 7.3f,  -8.7f, 1e6f, -3e38f, 3e38f, inf,   -inf,         std::nanf("")};
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) all.push_back(std::ldexp(static_cast<float>(random() >> 8), -22) - 2.0f);
  return all;
}

TEST(Sampling, ClosestReturnsTheTexelAtTheCoordinate) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {5, 3}, {8, 4}, {33, 17}}) {
    for (const auto& [mode, table] : each_with(tables)) {
      const Picture picture(width, height, table);
      for (const float u : coordinates()) {
        const float v = 0.3f - u;
        const auto column = [](AddressMode m, float x, int size) {
          const float scaled = static_cast<float>(place(m, x)) * static_cast<float>(size);
          return std::min(static_cast<int>(scaled), size - 1);
        };
        const int x = column(mode, u, width), y = column(mode, v, height);
        const auto color = picture.sample({Filter::closest, mode, mode}, u, v);
        for (int c = 0; c < 4; ++c)
          ASSERT_EQ(color[c], picture.texel(x, y, c)) << width << "x" << height << " at " << u << ", " << v;
      }
    }
  }
}

TEST(Sampling, LinearInterpolatesTheNearestFourTexels) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {5, 3}, {8, 4}, {33, 17}}) {
    for (const auto& way : each_with({Picture::floats, lower::byte_table::srgb})) {
      const AddressMode mode = way.first;
      const Picture picture(width, height, way.second);
      for (const float u : coordinates()) {
        const float v = 0.3f - u;
        const double x = place(mode, u) * width - 0.5, y = place(mode, v) * height - 0.5;
        const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
        const double s = x - x0, t = y - y0;
        const auto texel = [&](int i, int k, int c) {
          return double{picture.texel(around(mode, x0 + i, picture.width()),
                                      around(mode, y0 + k, picture.height()), c)};
        };
        const auto color = picture.sample({Filter::linear, mode, mode}, u, v);
        // Places are rounded to 2^-24 of the picture, so that shares are wrong by that many of its texels.
        const double bound = 0x1p-23 * (width + height + 4);
        for (int c = 0; c < 4; ++c) {
          const double expected = (texel(0, 0, c) * (1 - s) + texel(1, 0, c) * s) * (1 - t) +
                                  (texel(0, 1, c) * (1 - s) + texel(1, 1, c) * s) * t;
          ASSERT_NEAR(color[c], expected, bound) << width << "x" << height << " at " << u << ", " << v;
        }
      }
    }
  }
}

TEST(Sampling, LinearIsExactAtTexelCentres) {
  for (const auto& [mode, table] : each_with(tables)) {
    const Picture picture(8, 4, table);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 8; ++x)
        EXPECT_EQ(picture.sample({Filter::linear, mode, mode}, (x + 0.5f) / 8, (y + 0.5f) / 4)[2],
                  picture.texel(x, y, 2));
  }
}

TEST(Sampling, ChoicesByNumberHaveTheBitsOfFixedOnes) {
  const Picture picture(5, 3);
  for (const Filter filter : {Filter::closest, Filter::linear})
    for (const AddressMode u_mode : {AddressMode::periodic, AddressMode::clamp, AddressMode::mirror, AddressMode::constant})
      for (const AddressMode v_mode : modes)
        for (const float u : coordinates()) {
          const lower::Sampling sampling{filter, u_mode, v_mode};
          const auto fixed = picture.sample(sampling, u, 0.3f - u), chosen = picture.sample(sampling, u, 0.3f - u, true);
          for (size_t c = 0; c < 4; ++c)
            ASSERT_EQ(std::bit_cast<uint32_t>(chosen[c]), std::bit_cast<uint32_t>(fixed[c])) << u;
        }
}

TEST(Sampling, AxesHaveIndependentAddressModes) {
  const Picture picture(4, 4);
  const auto color = picture.sample({Filter::closest, AddressMode::clamp, AddressMode::periodic}, 1.3f, 1.3f);
  EXPECT_EQ(color[0], picture.texel(3, 1, 0));
}

}  // namespace
}  // namespace isoshade
