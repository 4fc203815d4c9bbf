// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::emit {

/// A set of names, each with a number. A text has a name on every line: no allocation for each.
class NameTable {
 public:
  explicit NameTable(size_t expected = 0) : slots_(slots_for(expected)) {
    names_.reserve(expected);
    text_.reserve(8 * expected);
  }

  bool contains(std::string_view name) const { return slots_[find(name, hash(name))] != 0; }

  /// The name's index, and whether it is new; a new one's number is 0.
  struct Added {
    size_t index;
    bool is_new;
  };
  Added add(std::string_view name);

  int& number(size_t index) { return names_[index].number; }

 private:
  struct Name {
    size_t begin, size;  ///< in text_
    uint32_t hash;
    int number;
  };

  /// A power of two; at most half of the slots are used.
  static size_t slots_for(size_t count);
  static uint32_t hash(std::string_view name);
  /// The slot where the name is, or would be.
  size_t find(std::string_view name, uint32_t hash) const;

  std::string text_;  ///< the names, one after another
  std::vector<Name> names_;
  std::vector<uint32_t> slots_;  ///< by hash: an index into names_ plus 1, or 0
};

}  // namespace isoshade::emit
