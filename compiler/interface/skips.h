// SPDX-License-Identifier: Apache-2.0
// The skips that are switched on. All are unless a user says otherwise; with none, a frame has the same bits.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace isoshade::interface {

enum class Skip : uint8_t {
#define SKIP(name, doc) name,
#include "compiler/interface/skips.def"
};
#define SKIP(name, doc) +1
inline constexpr size_t skip_count = 0
#include "compiler/interface/skips.def"
    ;

struct SkipRow {
  std::string_view name, doc;
};
inline constexpr SkipRow skip_rows[] = {
#define SKIP(name, doc) {#name, doc},
#include "compiler/interface/skips.def"
};

constexpr std::string_view name(Skip skip) { return skip_rows[static_cast<size_t>(skip)].name; }
/// The skip with this name.
constexpr std::optional<Skip> find_skip(std::string_view name) {
  for (size_t i = 0; i < skip_count; ++i)
    if (skip_rows[i].name == name) return static_cast<Skip>(i);
  return std::nullopt;
}

class Skips {
 public:
  static Skips none() {
    Skips skips;
    skips.on_.reset();
    return skips;
  }
  bool has(Skip skip) const { return on_[static_cast<size_t>(skip)]; }
  void set(Skip skip, bool on) { on_[static_cast<size_t>(skip)] = on; }
  bool operator==(const Skips&) const = default;

 private:
  std::bitset<skip_count> on_ = std::bitset<skip_count>().set();
};

}  // namespace isoshade::interface
