// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::support {

/// A set of names, each with a number. Documents and texts have a name on every line: no allocation for each, and names that
/// were added one after another lie side by side.
class NameTable {
 public:
  static constexpr size_t npos = ~size_t{0};

  explicit NameTable(size_t expected = 0) : slots_(slots_for(expected)) { reserve_names(expected); }

  /// Makes room for this many names.
  void reserve(size_t expected);

  /// The name's index, in the order in which names were added; npos if it is not there.
  size_t find(std::string_view name) const { return find(name, hash(name)); }
  size_t find(std::string_view name, uint32_t hash) const {
    const uint32_t found = slots_[slot_of(name, hash)];
    return found == 0 ? npos : found - 1;
  }
  bool contains(std::string_view name) const { return find(name) != npos; }

  /// The name's index, and whether it is new; a new one's number is 0.
  struct Added {
    size_t index;
    bool is_new;
  };
  Added add(std::string_view name) { return add(name, hash(name)); }
  Added add(std::string_view name, uint32_t hash);

  size_t size() const { return names_.size(); }
  std::string_view name(size_t index) const {
    return std::string_view(text_).substr(names_[index].begin, names_[index].size);
  }
  uint32_t hash_of(size_t index) const { return names_[index].hash; }

  int& number(size_t index) { return names_[index].number; }
  int number(size_t index) const { return names_[index].number; }

  /// What the functions take that are given a hash: one is enough for several tables.
  static uint32_t hash(std::string_view name) {
    const uint64_t hash = std::hash<std::string_view>{}(name);
    return static_cast<uint32_t>(hash ^ hash >> 32);
  }

 private:
  struct Name {
    size_t begin;  ///< in text_
    uint32_t size, hash;
    int number;
  };

  /// A power of two; at most half of the slots are used.
  static size_t slots_for(size_t count);
  void reserve_names(size_t expected);
  void rehash(size_t slots);
  /// The slot where the name is, or would be.
  size_t slot_of(std::string_view name, uint32_t hash) const {
    for (size_t slot = hash & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot] == 0) return slot;
      const Name& other = names_[slots_[slot] - 1];
      if (other.hash == hash && std::string_view(text_).substr(other.begin, other.size) == name) return slot;
    }
  }

  std::string text_;  ///< the names, one after another
  std::vector<Name> names_;
  std::vector<uint32_t> slots_;  ///< by hash: an index into names_ plus 1, or 0
};

}  // namespace isoshade::support
