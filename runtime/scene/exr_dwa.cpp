// SPDX-License-Identifier: Apache-2.0
// The data of DWAA and DWAB: counters, rules for the compression of channels, then four streams: uncompressed samples,
// cosine coefficients of 8 x 8 blocks (AC, then DC), and run lengths. The library trusts the counters.
// Source: ImfDwaCompressor.cpp of OpenEXR 3.1.
#include <ImfHuf.h>
#include <algorithm>
#include <array>
#include <map>
#include <zlib.h>

#include "runtime/scene/exr_file.h"

namespace isoshade::scene::exr_file {
namespace {

/// The counters at the start of the data.
enum Counter : size_t {
  version,
  stored_size,
  packed_stored_size,
  packed_others_size,
  packed_means_size,
  packed_runs_size,
  runs_size,
  unpacked_runs_size,
  others_count,
  means_count,
  others_packing,
  counter_count
};
using Counters = std::array<uint64_t, counter_count>;

enum class Scheme : uint8_t { stored, cosines, runs };

/// How channels with a name and a type are compressed.
struct Rule {
  std::string name;
  PixelType type = PixelType::half;
  Scheme scheme = Scheme::stored;
  int color = -1;  ///< 0, 1, 2: three such channels are transformed as luminance and chroma
  bool any_case = false;
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// The rules of versions 0 and 1, whose files contain none.
std::vector<Rule> old_rules() {
  constexpr struct {
    const char* name;
    int color;
  } cosines[] = {{"r", 0},   {"red", 0},  {"g", 1},  {"grn", 1}, {"green", 1}, {"b", 2},
                 {"blu", 2}, {"blue", 2}, {"y", -1}, {"by", -1}, {"ry", -1}};
  std::vector<Rule> rules;
  for (const auto& [name, color] : cosines)
    for (const PixelType type : {PixelType::half, PixelType::single})
      rules.push_back({name, type, Scheme::cosines, color, true});
  for (const PixelType type : {PixelType::uint, PixelType::half, PixelType::single})
    rules.push_back({"a", type, Scheme::runs, -1, true});
  return rules;
}

/// Removes the rules from the front of the data.
std::optional<std::vector<Rule>> take_rules(std::string_view& data) {
  if (data.size() < 2) return std::nullopt;
  const auto byte = [](std::string_view text, size_t at) { return static_cast<unsigned char>(text[at]); };
  const size_t size = byte(data, 0) | size_t{byte(data, 1)} << 8;
  if (size < 2 || size > data.size()) return std::nullopt;
  std::string_view text = data.substr(2, size - 2);
  data.remove_prefix(size);
  std::vector<Rule> rules;
  while (!text.empty()) {
    const size_t end = text.find('\0');
    if (end == std::string_view::npos || end > 254 || text.size() - end < 3) return std::nullopt;
    const unsigned how = byte(text, end + 1), type = byte(text, end + 2);
    const unsigned scheme = how >> 2 & 3, color = how >> 4;
    if (scheme > 2 || color > 3 || type > 2) return std::nullopt;
    rules.push_back({std::string(text.substr(0, end)), static_cast<PixelType>(type),
                     static_cast<Scheme>(scheme), static_cast<int>(color) - 1, (how & 1) != 0});
    text.remove_prefix(end + 3);
  }
  return rules;
}

/// How much the channels need of each stream.
struct Needs {
  int64_t stored = 0, runs = 0;  ///< bytes
  int64_t blocks = 0;
};

std::optional<Needs> needs_of(const Part& part, const Window& pixels, const std::vector<Rule>& rules) {
  Needs needs;
  std::map<std::string, std::array<const Channel*, 3>> colors;  ///< by layer
  for (const Channel& channel : part.channels) {
    const size_t dot = channel.name.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : channel.name.substr(0, dot);
    const std::string name = dot == std::string::npos ? channel.name : channel.name.substr(dot + 1);
    auto& of_layer = colors[layer];
    Scheme scheme = Scheme::stored;
    for (const Rule& rule : rules) {
      if (rule.type != channel.type || (rule.any_case ? lower(name) : name) != rule.name) continue;
      scheme = rule.scheme;
      if (rule.color < 0) continue;
      // A channel that is listed twice would be decompressed twice.
      for (int i = 0; i < 3; ++i)
        if (i != rule.color && of_layer[static_cast<size_t>(i)] == &channel) return std::nullopt;
      of_layer[static_cast<size_t>(rule.color)] = &channel;
    }
    const int64_t width = samples(pixels.width(), channel.x_sampling),
                  height = sampled_rows(part, pixels, channel);
    const int64_t bytes = width * height * bytes_of(channel.type);
    if (scheme == Scheme::cosines) {
      if (channel.type == PixelType::uint) return std::nullopt;
      needs.blocks += ((width + 7) / 8) * ((height + 7) / 8);
    } else {
      (scheme == Scheme::runs ? needs.runs : needs.stored) += bytes;
    }
  }
  return needs;
}

/// Whether the coefficients fill this many blocks of 63. High byte 255: a run of zeros; 0xff00: end of block.
bool make_blocks(const std::vector<uint16_t>& coefficients, int64_t blocks) {
  auto next = coefficients.begin();
  for (int64_t block = 0; block < blocks; ++block) {
    for (int at = 1; at < 64; ++next) {
      if (next == coefficients.end()) return false;
      const int run = *next == 0xff00 ? 64 : *next >> 8 == 0xff ? *next & 255 : 1;
      at += run;
    }
  }
  return true;
}

bool others_fill(const Counters& counters, std::string_view data, int64_t blocks) {
  const auto count = static_cast<int64_t>(counters[others_count]);
  if (count > 63 * blocks || (blocks > 0 && data.empty())) return false;
  std::vector<uint16_t> coefficients(static_cast<size_t>(count));
  if (counters[others_packing] == 0) {
    try {
      Imf::hufUncompress(data.data(), static_cast<int>(data.size()), coefficients.data(),
                         static_cast<int>(count));
    } catch (const std::exception&) { return false; }
  } else {
    auto size = static_cast<uLongf>(2 * count);
    if (::uncompress(reinterpret_cast<Bytef*>(coefficients.data()), &size,
                     reinterpret_cast<const Bytef*>(data.data()), static_cast<uLong>(data.size())) != Z_OK ||
        size != static_cast<uLongf>(2 * count))
      return false;
  }
  return make_blocks(coefficients, blocks);
}

}  // namespace

bool dwa_fills(const Part& part, const Window& pixels, std::string_view data) {
  Counters counters{};
  if (data.size() < 8 * counter_count) return false;
  for (size_t i = 0; i < 8 * counter_count; ++i)
    counters[i / 8] |= uint64_t{static_cast<unsigned char>(data[i])} << (8 * (i % 8));
  data.remove_prefix(8 * counter_count);
  // Small enough not to overflow below or in the library.
  for (const uint64_t counter : counters)
    if (counter > static_cast<uint64_t>(2 * max_chunk_bytes)) return false;
  if (counters[version] > 2 || counters[others_packing] > 1) return false;
  const auto rules = counters[version] < 2 ? std::optional(old_rules()) : take_rules(data);
  const auto needs = rules ? needs_of(part, pixels, *rules) : std::nullopt;
  if (!needs) return false;
  const auto take = [&](Counter counter) {
    const std::string_view taken = data.substr(0, counters[counter]);
    data.remove_prefix(taken.size());
    return taken;
  };
  const std::string_view stored = take(packed_stored_size), others = take(packed_others_size),
                         means = take(packed_means_size), runs = take(packed_runs_size);
  const auto whole = [&](std::string_view stream, Counter counter) {
    return stream.size() == counters[counter];
  };
  if (!whole(stored, packed_stored_size) || !whole(others, packed_others_size) ||
      !whole(means, packed_means_size) || !whole(runs, packed_runs_size))
    return false;
  const auto is = [&](Counter counter, int64_t value) {
    return counters[counter] == static_cast<uint64_t>(value);
  };
  return is(stored_size, needs->stored) && is(unpacked_runs_size, needs->runs) &&
         is(means_count, needs->blocks) && (needs->stored == 0 || inflates_to(stored, needs->stored)) &&
         (needs->blocks == 0 ||
          (inflates_to(means, 2 * needs->blocks) && others_fill(counters, others, needs->blocks)));
}

}  // namespace isoshade::scene::exr_file
