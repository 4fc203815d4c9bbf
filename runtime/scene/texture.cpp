// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/texture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include "compiler/functions/color.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"
#include "runtime/threads/workers.h"

namespace isoshade::scene {
namespace {

constexpr size_t channels = 4;

float finite(float x) {
  constexpr float most = std::numeric_limits<float>::max();
  if (!(x == x)) return 0.0f;
  return canonical(std::clamp(x, -most, most));
}

/// The texels that a texel of the next level covers along an axis: `first` and those after it.
struct Cover {
  size_t first;
  size_t count;
  std::array<float, 3> weights;
};

/// From n texels to max(1, n / 2).
std::vector<Cover> covers(int n) {
  const int m = std::max(1, n / 2);
  std::vector<Cover> all;
  for (int i = 0; i < m; ++i) {
    const auto first = static_cast<size_t>(2 * i);
    const auto share = [&](int part) { return static_cast<float>(part) / static_cast<float>(n); };
    if (n == 1) {
      all.push_back({0, 1, {1, 0, 0}});
    } else if (n % 2 == 0) {
      all.push_back({first, 2, {0.5f, 0.5f, 0}});
    } else {
      all.push_back({first, 3, {share(m - i), share(m), share(i + 1)}});
    }
  }
  return all;
}

float weighted(const Cover& cover, const float* from, size_t step) {
  float sum = cover.weights[0] * from[0];
  for (size_t i = 1; i < cover.count; ++i) sum = sum + cover.weights[i] * from[i * step];
  return finite(sum);
}

/// half_size of a level whose row y is row(y, room), which may write to room, a row of floats.
template <class Row>
TextureLevel halved(int width, int height, threads::Workers* workers, const Row& row) {
  const lanes::FpGuard guard;
  const std::vector<Cover> across = covers(width), down = covers(height);
  const size_t values = channels * across.size();
  TextureLevel half{static_cast<int>(across.size()), static_cast<int>(down.size()), {}};
  half.texels.resize(values * down.size());
  const auto make_rows = [&](size_t begin, size_t end) {
    std::vector<float> narrow(3 * values), room(channels * static_cast<size_t>(width));
    for (size_t y = begin; y < end; ++y) {
      const Cover& rows = down[y];
      for (size_t i = 0; i < rows.count; ++i) {
        const float* from = row(rows.first + i, room.data());
        for (size_t x = 0; x < across.size(); ++x)
          for (size_t c = 0; c < channels; ++c)
            narrow[i * values + x * channels + c] =
                weighted(across[x], from + across[x].first * channels + c, channels);
      }
      for (size_t i = 0; i < values; ++i) half.texels[y * values + i] = weighted(rows, &narrow[i], values);
    }
  };
  constexpr size_t rows_of_task = 32;
  if (workers == nullptr || down.size() <= rows_of_task) {
    make_rows(0, down.size());
  } else {
    workers->for_each((down.size() + rows_of_task - 1) / rows_of_task, [&](size_t task) {
      make_rows(task * rows_of_task, std::min(down.size(), (task + 1) * rows_of_task));
    });
  }
  return half;
}

/// The byte whose float is nearest to a value in [0, 1] or slightly above; of two equally near ones the lower. The
/// midpoints are exact in double.
class NearestByte {
 public:
  explicit NearestByte(const ByteTable& table) {
    for (size_t i = 0; i + 1 < table.size(); ++i) ends_[i] = (double{table[i]} + double{table[i + 1]}) / 2;
    ends_.back() = std::numeric_limits<double>::infinity();
    for (size_t cell = 0; cell < first_.size(); ++cell) {
      const auto end = std::ranges::lower_bound(ends_, static_cast<double>(cell) / cells);
      first_[cell] = static_cast<uint32_t>(end - ends_.begin());
    }
  }
  uint32_t operator()(float value) const {
    uint32_t byte = first_[std::min(static_cast<size_t>(value * cells), first_.size() - 1)];
    while (ends_[byte] < double{value}) ++byte;
    return byte;
  }

 private:
  static constexpr int cells = 1024;
  std::array<double, 256> ends_;             ///< the greatest value of each byte
  std::array<uint32_t, cells + 1> first_{};  ///< the byte of each multiple of 1 / cells
};

/// The floats of words, four per word.
void decode(std::span<const uint32_t> words, const ByteTable& colors, float* to) {
  const ByteTable& alphas = byte_table(false);
  for (const uint32_t word : words) {
    for (int shift = 0; shift < 24; shift += 8) *to++ = colors[word >> shift & 255];
    *to++ = alphas[word >> 24];
  }
}

}  // namespace

const ByteTable& byte_table(bool srgb) {
  const auto made = [](bool decoded) {
    const lanes::FpGuard guard;
    ByteTable table;
    for (size_t byte = 0; byte < table.size(); ++byte) {
      const float encoded = static_cast<float>(byte) / 255.0f;
      table[byte] = decoded ? functions::srgb_decode(encoded) : encoded;
    }
    return table;
  };
  static const ByteTable tables[] = {made(false), made(true)};
  return tables[srgb ? 1 : 0];
}

TextureLevel linear_level(FileImage image, bool srgb) {
  if (image.has_bytes())
    return linear_level(ByteLevel{image.width, image.height, std::move(image.bytes)}, srgb);
  const lanes::FpGuard guard;
  TextureLevel level{image.width, image.height, std::move(image.rgba)};
  for (size_t i = 0; i < level.texels.size(); ++i) {
    float& value = level.texels[i];
    value = finite(value);
    if (srgb && i % channels != 3) value = finite(functions::srgb_decode(value));
  }
  return level;
}

TextureLevel linear_level(const ByteLevel& level, bool srgb) {
  TextureLevel linear{level.width, level.height, std::vector<float>(channels * level.texels.size())};
  decode(level.texels, byte_table(srgb), linear.texels.data());
  return linear;
}

ByteLevel byte_level(const TextureLevel& level, bool srgb) {
  const NearestByte color(byte_table(srgb)), alpha(byte_table(false));
  ByteLevel bytes{level.width, level.height, {}};
  bytes.texels.reserve(level.texels.size() / channels);
  for (size_t i = 0; i < level.texels.size(); i += channels) {
    const float* texel = &level.texels[i];
    bytes.texels.push_back(color(texel[0]) | color(texel[1]) << 8 | color(texel[2]) << 16 |
                           alpha(texel[3]) << 24);
  }
  return bytes;
}

TextureLevel half_size(const TextureLevel& level, threads::Workers* workers) {
  const size_t row = channels * static_cast<size_t>(level.width);
  return halved(level.width, level.height, workers, [&](size_t y, float*) { return &level.texels[y * row]; });
}

TextureLevel half_size(const ByteLevel& level, bool srgb, threads::Workers* workers) {
  const auto width = static_cast<size_t>(level.width);
  return halved(level.width, level.height, workers, [&](size_t y, float* row) {
    decode(std::span(level.texels).subspan(y * width, width), byte_table(srgb), row);
    return row;
  });
}

}  // namespace isoshade::scene
