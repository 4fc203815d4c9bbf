// SPDX-License-Identifier: Apache-2.0
// LZ77 with one candidate for each hash, as LZ4 searches, and dynamic Huffman codes.
#include "runtime/scene/deflate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <span>
#include <vector>
#include <zlib.h>

namespace isoshade::scene {
namespace {

// The format: RFC 1951.
constexpr size_t window = 32768, shortest_match = 3, longest_match = 258;
constexpr size_t literal_symbols = 286, distance_symbols = 30, length_symbols = 19;
constexpr int end_of_block = 256, longest_code = 15, longest_length_code = 7;
constexpr size_t most_stored = 65535;

/// A block of bytes has codes of its own, or is stored.
constexpr size_t block_bytes = most_stored;
/// Matches have at least this many bytes: those that are hashed.
constexpr size_t hashed_bytes = 4;
constexpr int hash_bits = 13;  // a table of 32 KiB, which the nearest cache holds

/// A code for a range of values: values - first are the extra bits.
struct Range {
  uint8_t symbol = 0, extra_bits = 0;
  uint16_t first = 0;
};

/// The symbols of match lengths, less 257, by length.
constexpr std::array<Range, longest_match + 1> length_ranges = [] {
  std::array<Range, longest_match + 1> ranges{};
  size_t length = shortest_match;
  for (uint8_t symbol = 0; symbol < 28; ++symbol) {
    const auto bits = static_cast<uint8_t>(symbol < 8 ? 0 : symbol / 4 - 1);
    const auto first = static_cast<uint16_t>(length);
    for (int i = 0; i < 1 << bits && length < longest_match; ++i) ranges[length++] = {symbol, bits, first};
  }
  ranges[longest_match] = {28, 0, longest_match};
  return ranges;
}();

/// The symbols of distances, by symbol.
constexpr std::array<Range, distance_symbols> distance_ranges = [] {
  std::array<Range, distance_symbols> ranges{};
  uint32_t first = 1;
  for (uint8_t symbol = 0; symbol < distance_symbols; ++symbol) {
    const auto bits = static_cast<uint8_t>(symbol < 4 ? 0 : symbol / 2 - 1);
    ranges[symbol] = {symbol, bits, static_cast<uint16_t>(first)};
    first += 1u << bits;
  }
  return ranges;
}();

size_t distance_symbol(uint32_t distance) {
  const uint32_t d = distance - 1;
  if (d < 4) return d;
  const auto bits = static_cast<uint32_t>(std::bit_width(d)) - 1;
  return 2 * bits + (d >> (bits - 1) & 1);
}

template <class T>
T load(const uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// How many bytes are equal; at most `most`.
size_t common_length(const uint8_t* a, const uint8_t* b, size_t most) {
  static_assert(std::endian::native == std::endian::little, "the first byte is the lowest");
  size_t length = 0;
  for (; length + 8 <= most; length += 8)
    if (const uint64_t difference = load<uint64_t>(a + length) ^ load<uint64_t>(b + length); difference != 0)
      return length + static_cast<size_t>(std::countr_zero(difference)) / 8;
  while (length < most && a[length] == b[length]) ++length;
  return length;
}

/// A code word, in the order in which its bits are written: from the lowest.
struct Word {
  uint32_t bits = 0;
  uint32_t count = 0;
};

/// A prefix code for `size` symbols.
template <size_t size>
struct Code {
  std::array<uint32_t, size> counts{};  ///< how often symbols occur
  std::array<uint8_t, size> lengths{};  ///< 0: the symbol does not occur
  std::array<Word, size> words{};

  /// Makes lengths, at most `limit`, and words from the counts.
  void make(int limit) {
    make_lengths(limit);
    std::array<uint32_t, longest_code + 2> next{};
    for (const uint8_t length : lengths) ++next[length + 1u];
    next[1] = 0;  // symbols without a word
    uint32_t first = 0;
    std::array<uint32_t, longest_code + 1> word{};
    for (size_t length = 1; length <= longest_code; ++length) {
      word[length] = first;
      first = (first + next[length + 1]) << 1;
    }
    for (size_t symbol = 0; symbol < size; ++symbol) {
      const uint32_t length = lengths[symbol];
      uint32_t bits = 0;  // the highest bit of a word is written first
      if (length != 0)
        for (uint32_t rest = word[length]++, i = 0; i < length; ++i, rest >>= 1) bits = bits << 1 | (rest & 1);
      words[symbol] = {bits, length};
    }
  }

  /// The bits of all symbols.
  size_t cost() const {
    size_t bits = 0;
    for (size_t symbol = 0; symbol < size; ++symbol) bits += size_t{counts[symbol]} * lengths[symbol];
    return bits;
  }

 private:
  /// Huffman's algorithm on sorted counts; words that are too long are shortened at the cost of the longest others.
  void make_lengths(int limit) {
    lengths.fill(0);
    std::array<uint64_t, size> leaves;  // the count, then the symbol: equal counts have one order
    size_t leaf_count = 0;
    for (size_t symbol = 0; symbol < size; ++symbol)
      if (counts[symbol] != 0) leaves[leaf_count++] = uint64_t{counts[symbol]} << 32 | symbol;
    if (leaf_count == 0) return;
    std::sort(leaves.begin(), leaves.begin() + leaf_count);
    const auto symbol_of = [&](size_t leaf) { return static_cast<size_t>(leaves[leaf] & 0xffffffff); };
    if (leaf_count == 1) {
      lengths[symbol_of(0)] = 1;
      return;
    }
    // Nodes: the leaves, then the inner nodes as they are made, whose weights ascend as well.
    std::array<uint64_t, 2 * size> weight;
    std::array<size_t, 2 * size> parent;
    for (size_t i = 0; i < leaf_count; ++i) weight[i] = leaves[i] >> 32;
    size_t leaf = 0, inner = leaf_count, made = leaf_count;
    const size_t root = 2 * leaf_count - 2;
    for (; made <= root; ++made) {
      weight[made] = 0;
      for (int child = 0; child < 2; ++child) {
        const bool take_leaf = leaf < leaf_count && (inner == made || weight[leaf] <= weight[inner]);
        const size_t taken = take_leaf ? leaf++ : inner++;
        weight[made] += weight[taken];
        parent[taken] = made;
      }
    }
    std::array<int, 2 * size> depth;
    depth[root] = 0;
    std::array<int, longest_code + 1> of_length{};
    const int deepest = limit;
    uint64_t used = 0;  // of 2^deepest words
    for (size_t node = root; node-- > 0;) {
      depth[node] = depth[parent[node]] + 1;
      if (node >= leaf_count) continue;
      const int length = std::min(depth[node], deepest);
      ++of_length[static_cast<size_t>(length)];
      used += uint64_t{1} << (deepest - length);
    }
    for (; used > uint64_t{1} << deepest; --used) {
      // A word becomes one bit longer; its sibling is one of the longest.
      int length = deepest - 1;
      while (of_length[static_cast<size_t>(length)] == 0) --length;
      --of_length[static_cast<size_t>(length)];
      of_length[static_cast<size_t>(length) + 1] += 2;
      --of_length[static_cast<size_t>(deepest)];
    }
    size_t rarest = 0;
    for (int length = deepest; length > 0; --length)
      for (int i = 0; i < of_length[static_cast<size_t>(length)]; ++i)
        lengths[symbol_of(rarest++)] = static_cast<uint8_t>(length);
  }
};

class BitWriter {
 public:
  /// There must be room for all that is written, and 8 bytes more.
  explicit BitWriter(char* to) : to_(to) {}

  /// Without a flush, 56 bits may be written.
  void put(uint64_t bits, uint32_t count) {
    held_ |= bits << held_count_;
    held_count_ += count;
  }
  void put(Word word) { put(word.bits, word.count); }
  void flush() {
    std::memcpy(to_, &held_, 8);
    const uint32_t bytes = held_count_ / 8;
    to_ += bytes;
    held_ >>= 8 * bytes;
    held_count_ %= 8;
  }
  void fill_byte() {
    held_count_ = (held_count_ + 7) / 8 * 8;
    flush();
  }
  void put_bytes(const uint8_t* bytes, size_t count) {
    to_ = std::copy_n(bytes, count, to_);
  }
  char* end() const { return to_; }

 private:
  char* to_;
  uint64_t held_ = 0;
  uint32_t held_count_ = 0;  ///< after flush less than 8
};

/// Bytes that are copied, then a match; without a match at the end of a block.
struct Sequence {
  uint16_t literals = 0, length = 0, distance = 0;
};

class Compressor {
 public:
  explicit Compressor(std::string_view bytes)
      : data_(reinterpret_cast<const uint8_t*>(bytes.data())), size_(bytes.size()) {}

  void append(bool is_last, std::string& to) {
    const size_t before = to.size(), blocks = size_ / block_bytes + 1;
    constexpr size_t around = 10;  // of a stored block, and of what ends the part
    to.resize(before + size_ + around * (blocks + 1) + 8);
    BitWriter writer(to.data() + before);
    for (size_t begin = 0; begin < size_; begin += block_bytes) {
      const size_t end = std::min(begin + block_bytes, size_);
      find_matches(begin, end);
      write_block(begin, end, is_last && end == size_, writer);
    }
    if (!is_last || size_ == 0) write_stored(0, 0, is_last, writer);  // also fills the last byte
    writer.fill_byte();
    to.resize(static_cast<size_t>(writer.end() - to.data()));
  }

 private:
  void find_matches(size_t begin, size_t end) {
    sequences_.clear();
    literals_.counts = {};
    distances_.counts = {};
    size_t first_literal = begin, at = begin, misses = 0;
    while (at + hashed_bytes <= end) {
      const uint32_t word = load<uint32_t>(data_ + at);
      uint32_t& place = place_of(word);
      size_t from = place;
      place = static_cast<uint32_t>(at);
      if (from >= at || at - from > window || load<uint32_t>(data_ + from) != word) {
        // The longer there is no match, the larger the steps: data without any are passed quickly.
        at += 1 + std::min<size_t>(misses++ >> 4, 31);
        continue;
      }
      misses = 0;
      while (at > first_literal && from > 0 && data_[at - 1] == data_[from - 1]) --at, --from;
      const size_t length = common_length(data_ + at, data_ + from, end - at);
      add(at - first_literal, length, at - from);
      at += length;
      first_literal = at;
      if (at + hashed_bytes <= end) place_of(load<uint32_t>(data_ + at - 2)) = static_cast<uint32_t>(at - 2);
    }
    sequences_.push_back({static_cast<uint16_t>(end - first_literal), 0, 0});
    count_literals(begin);
    ++literals_.counts[end_of_block];
  }

  uint32_t& place_of(uint32_t word) { return latest_[word * 0x9e3779b1u >> (32 - hash_bits)]; }

  void add(size_t literals, size_t length, size_t distance) {
    const size_t symbol = distance_symbol(static_cast<uint32_t>(distance));
    while (length > 0) {
      size_t part = std::min(length, longest_match);
      if (const size_t rest = length - part; rest > 0 && rest < shortest_match) part = length - shortest_match;
      sequences_.push_back({static_cast<uint16_t>(literals), static_cast<uint16_t>(part), static_cast<uint16_t>(distance)});
      ++literals_.counts[257u + length_ranges[part].symbol];
      ++distances_.counts[symbol];
      length -= part;
      literals = 0;
    }
  }

  void count_literals(size_t begin) {
    std::array<std::array<uint32_t, 256>, 4> counts{};  // several, for increments of one place wait for each other
    const uint8_t* at = data_ + begin;
    for (const Sequence& sequence : sequences_) {
      size_t i = 0;
      for (; i + 4 <= sequence.literals; i += 4)
        for (size_t k = 0; k < 4; ++k) ++counts[k][at[i + k]];
      for (; i < sequence.literals; ++i) ++counts[0][at[i]];
      at += size_t{sequence.literals} + sequence.length;
    }
    for (size_t byte = 0; byte < 256; ++byte)
      literals_.counts[byte] += counts[0][byte] + counts[1][byte] + counts[2][byte] + counts[3][byte];
  }

  void write_block(size_t begin, size_t end, bool is_last, BitWriter& writer) {
    literals_.make(longest_code);
    distances_.make(longest_code);
    describe_codes();
    size_t bits = 3 + 5 + 5 + 4 + 3 * length_code_count_ + lengths_.cost() + literals_.cost() + distances_.cost();
    for (const Length& length : described_) bits += length.extra_bits;
    for (size_t length = shortest_match; length <= longest_match; ++length)
      if (length_ranges[length].first == length)
        bits += size_t{literals_.counts[257u + length_ranges[length].symbol]} * length_ranges[length].extra_bits;
    for (const Range& range : distance_ranges) bits += size_t{distances_.counts[range.symbol]} * range.extra_bits;
    // Codes that gain next to nothing cost time for writer and reader.
    const size_t stored_bits = 8 * (end - begin);
    if (bits >= stored_bits - stored_bits / 64) return write_stored(begin, end, is_last, writer);
    writer.put(is_last ? 1 : 0, 1);
    writer.put(2, 2);
    write_codes(writer);
    write_sequences(data_ + begin, writer);
  }

  void write_stored(size_t begin, size_t end, bool is_last, BitWriter& writer) {
    writer.put(is_last ? 1 : 0, 3);
    writer.fill_byte();
    const auto count = static_cast<uint32_t>(end - begin);
    writer.put(count | uint64_t{~count & 0xffff} << 16, 32);
    writer.flush();
    writer.put_bytes(data_ + begin, count);
  }

  /// A symbol of the code that describes the lengths of the codes, and its extra bits.
  struct Length {
    uint8_t symbol = 0, extra = 0, extra_bits = 0;
  };

  void describe_codes() {
    literal_count_ = literal_symbols;
    while (literal_count_ > 257 && literals_.lengths[literal_count_ - 1] == 0) --literal_count_;
    distance_count_ = distance_symbols;
    while (distance_count_ > 1 && distances_.lengths[distance_count_ - 1] == 0) --distance_count_;
    std::array<uint8_t, literal_symbols + distance_symbols> all{};
    std::copy_n(literals_.lengths.begin(), literal_count_, all.begin());
    std::copy_n(distances_.lengths.begin(), distance_count_, all.begin() + static_cast<ptrdiff_t>(literal_count_));
    described_.clear();
    lengths_.counts = {};
    const auto add = [&](size_t symbol, size_t extra = 0, size_t bits = 0) {
      described_.push_back({static_cast<uint8_t>(symbol), static_cast<uint8_t>(extra), static_cast<uint8_t>(bits)});
      ++lengths_.counts[symbol];
    };
    const size_t count = literal_count_ + distance_count_;
    for (size_t at = 0; at < count;) {
      size_t run = 1;
      while (at + run < count && all[at + run] == all[at]) ++run;
      if (all[at] == 0 && run >= 3) {
        run = std::min<size_t>(run, 138);
        run < 11 ? add(17, run - 3, 3) : add(18, run - 11, 7);
      } else if (run >= 4) {
        run = std::min<size_t>(run, 7);
        add(all[at]);
        add(16, run - 4, 2);
      } else {
        run = 1;
        add(all[at]);
      }
      at += run;
    }
    lengths_.make(longest_length_code);
    length_code_count_ = length_symbols;
    while (length_code_count_ > 4 && lengths_.lengths[length_order[length_code_count_ - 1]] == 0) --length_code_count_;
  }

  void write_codes(BitWriter& writer) const {
    writer.put(literal_count_ - 257, 5);
    writer.put(distance_count_ - 1, 5);
    writer.put(length_code_count_ - 4, 4);
    writer.flush();
    for (size_t i = 0; i < length_code_count_; ++i) {
      writer.put(lengths_.lengths[length_order[i]], 3);
      writer.flush();
    }
    for (const auto& [symbol, extra, bits] : described_) {
      writer.put(lengths_.words[symbol]);
      writer.put(extra, bits);
      writer.flush();
    }
  }

  void write_sequences(const uint8_t* at, BitWriter& to) const {
    BitWriter writer = to;  // a copy may stay in registers
    for (const Sequence& sequence : sequences_) {
      const uint8_t* const end = at + sequence.literals;
      for (; end - at >= 3; at += 3) {
        for (int i = 0; i < 3; ++i) writer.put(literals_.words[at[i]]);
        writer.flush();
      }
      for (; at < end; ++at) writer.put(literals_.words[*at]);
      writer.flush();
      if (sequence.length == 0) break;
      const Range& length = length_ranges[sequence.length];
      writer.put(literals_.words[257u + length.symbol]);
      writer.put(sequence.length - uint32_t{length.first}, length.extra_bits);
      const Range& distance = distance_ranges[distance_symbol(sequence.distance)];
      writer.put(distances_.words[distance.symbol]);
      writer.flush();
      writer.put(sequence.distance - uint32_t{distance.first}, distance.extra_bits);
      writer.flush();
      at += sequence.length;
    }
    writer.put(literals_.words[end_of_block]);
    writer.flush();
    to = writer;
  }

  /// The order in which the lengths of the code for lengths are written.
  static constexpr std::array<uint8_t, length_symbols> length_order = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                                        11, 4,  12, 3, 13, 2, 14, 1, 15};

  const uint8_t* data_;
  size_t size_;
  std::array<uint32_t, size_t{1} << hash_bits> latest_{};  ///< by hash: the last position where such bytes were found
  std::vector<Sequence> sequences_;
  Code<literal_symbols> literals_;
  Code<distance_symbols> distances_;
  Code<length_symbols> lengths_;
  std::vector<Length> described_;
  size_t literal_count_ = 0, distance_count_ = 0, length_code_count_ = 0;
};

}  // namespace

void append_deflated(std::string_view bytes, bool is_last, std::string& to) {
  std::make_unique<Compressor>(bytes)->append(is_last, to);  // too large for the stack of a thread
}

void append_big_endian(std::string& to, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(value >> shift & 255);
}

std::string zlib_stream(std::string_view bytes) {
  std::string stream(zlib_head);
  append_deflated(bytes, true, stream);
  append_big_endian(stream, static_cast<uint32_t>(adler32_z(1, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size())));
  return stream;
}

}  // namespace isoshade::scene
