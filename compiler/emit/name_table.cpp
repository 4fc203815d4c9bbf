// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/name_table.h"

#include <bit>

namespace isoshade::emit {

size_t NameTable::slots_for(size_t count) { return std::bit_ceil(2 * count + 8); }

// FNV-1a.
uint32_t NameTable::hash(std::string_view name) {
  uint32_t hash = 2166136261u;
  for (const char c : name) hash = (hash ^ static_cast<uint8_t>(c)) * 16777619u;
  return hash ^ hash >> 15;
}

size_t NameTable::find(std::string_view name, uint32_t hash) const {
  for (size_t slot = hash & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
    if (slots_[slot] == 0) return slot;
    const Name& other = names_[slots_[slot] - 1];
    if (other.hash == hash && std::string_view(text_).substr(other.begin, other.size) == name) return slot;
  }
}

NameTable::Added NameTable::add(std::string_view name) {
  const uint32_t hash = NameTable::hash(name);
  const size_t slot = find(name, hash);
  if (slots_[slot] != 0) return {slots_[slot] - 1, false};
  names_.push_back({text_.size(), name.size(), hash, 0});
  text_ += name;
  slots_[slot] = static_cast<uint32_t>(names_.size());
  if (2 * names_.size() > slots_.size()) {
    slots_.assign(slots_for(names_.size()), 0);
    for (uint32_t i = 0; i < names_.size(); ++i) {
      size_t free = names_[i].hash & (slots_.size() - 1);
      while (slots_[free] != 0) free = (free + 1) & (slots_.size() - 1);
      slots_[free] = i + 1;
    }
  }
  return {names_.size() - 1, true};
}

}  // namespace isoshade::emit
