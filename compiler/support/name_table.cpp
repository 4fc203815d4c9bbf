// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/name_table.h"

#include <bit>

namespace isoshade::support {

size_t NameTable::slots_for(size_t count) { return std::bit_ceil(2 * count + 8); }

void NameTable::reserve_names(size_t expected) {
  names_.reserve(expected);
  text_.reserve(8 * expected);
}

void NameTable::reserve(size_t expected) {
  reserve_names(expected);
  if (slots_for(expected) > slots_.size()) rehash(slots_for(expected));
}

void NameTable::rehash(size_t slots) {
  slots_.assign(slots, 0);
  for (uint32_t i = 0; i < names_.size(); ++i) {
    size_t free = names_[i].hash & (slots_.size() - 1);
    while (slots_[free] != 0) free = (free + 1) & (slots_.size() - 1);
    slots_[free] = i + 1;
  }
}

NameTable::Added NameTable::add(std::string_view name, uint32_t hash) {
  const size_t slot = slot_of(name, hash);
  if (slots_[slot] != 0) return {slots_[slot] - 1, false};
  names_.push_back({text_.size(), static_cast<uint32_t>(name.size()), hash, 0});
  text_ += name;
  slots_[slot] = static_cast<uint32_t>(names_.size());
  if (2 * names_.size() > slots_.size()) rehash(slots_for(names_.size()));
  return {names_.size() - 1, true};
}

}  // namespace isoshade::support
