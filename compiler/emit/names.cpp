// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/names.h"

#include <algorithm>
#include <array>

namespace isoshade::emit {

namespace {

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// By character: whether names may have it anywhere but at their beginning, '_' aside.
constexpr std::array<bool, 256> is_plain = [] {
  std::array<bool, 256> plain{};
  for (size_t c = 0; c < plain.size(); ++c) plain[c] = is_letter(static_cast<char>(c)) || is_digit(static_cast<char>(c));
  return plain;
}();

/// What GLSL keeps for itself in every scope. A word with an underscore behind it would still begin so.
bool has_taken_prefix(std::string_view name) {
  if (name.find('_') == std::string_view::npos) return false;
  for (const std::string_view prefix : {"gl_", "GL_", "ISOSHADE_", "spirv_", "webgl_"})
    if (name.starts_with(prefix)) return true;
  return false;
}

bool is_clean(std::string_view name) {
  if (name.empty() || name.size() > 100 || !is_letter(name.front()) || name.back() == '_') return false;
  for (size_t i = 0; i < name.size(); ++i)
    if (!is_plain[static_cast<unsigned char>(name[i])] && (name[i] != '_' || name[i - 1] == '_')) return false;
  return !has_taken_prefix(name);
}

std::string clean(std::string_view wanted) {
  if (is_clean(wanted)) return std::string(wanted);
  std::string name;
  for (char c : wanted) {
    const char kept = is_letter(c) || is_digit(c) ? c : '_';
    if (kept == '_' && !name.empty() && name.back() == '_') continue;  // both languages reserve "__"
    name += kept;
  }
  if (name.size() > 100) name.resize(100);
  while (!name.empty() && name.front() == '_') name.erase(0, 1);  // C++ reserves "_A" and, globally, "_a"
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || is_digit(name.front()) || has_taken_prefix(name)) name = "n_" + name;
  if (name.back() == '_') name.pop_back();
  return name;
}

}  // namespace

bool Names::taken(std::string_view name, uint32_t hash) const {
  for (const Names* scope = this; scope != nullptr; scope = scope->outer_)
    if (scope->used_.find(name, hash) != support::NameTable::npos) return true;
  return false;
}

bool Names::outer_has(std::string_view name, uint32_t hash) {
  const bool has = outer_ != nullptr && outer_->taken(name, hash);
  if (has) avoided_.emplace_back(name);
  return has;
}

// What is returned has just been added to the names of this scope and is in none around it, so no two are alike.
std::string Names::take(std::string_view wanted, Avoid avoid) {
  std::string name = clean(wanted);
  const uint32_t hash = support::NameTable::hash(name);
  const auto [index, is_new] = used_.add(name, hash);
  if (is_new) {
    const bool forbidden = is_word(name, hash, scope_, avoid);
    if (!forbidden && !outer_has(name, hash)) return name;
    if (forbidden) {
      const std::string other = name + "_";
      const uint32_t hash_of_other = support::NameTable::hash(other);
      if (!outer_has(other, hash_of_other) && used_.add(other, hash_of_other).is_new) return other;
    }
  }
  const std::string stem =
      has_taken_prefix(name + "_") ? "n_" + name : name;  // "gl" is no such name, "gl_1" is
  std::string numbered;
  uint32_t hash_of_numbered;
  do {
    numbered = stem + "_" + std::to_string(++used_.number(index));
    if (is_word(numbered, scope_, avoid)) numbered += "_";
    hash_of_numbered = support::NameTable::hash(numbered);
  } while (outer_has(numbered, hash_of_numbered) || !used_.add(numbered, hash_of_numbered).is_new);
  return numbered;
}

std::string prefix_of(std::string_view wanted) {
  const std::string name = Names(Scope::global).take(wanted);
  const std::string beginning = name.ends_with('_') ? name : name + "_";
  const auto begins = [&](std::string_view word) { return beginning.starts_with(word); };
  if (!has_taken_prefix(beginning) && !begins("iso_") && !begins("ISO_") && !begins("isoshade_")) return name;
  return "n_" + name.substr(0, name.find_last_not_of('_') + 1);
}

namespace {

std::string harmless(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c < ' ' || c > '~' || c == '\\' || c == '?' || c == '*') c = '_';
  return out;
}

}  // namespace

std::string comment_text(std::string_view text) { return harmless(text.substr(0, 200)); }

void comment_lines(std::string& out, std::string_view text, size_t indent) {
  constexpr size_t columns = 100, longest = 1000;
  const std::string words = harmless(text.substr(0, longest));
  const size_t wide = columns - std::min(columns / 2, indent + 3);
  for (std::string_view rest = words; !rest.empty();) {
    size_t end = rest.size();
    if (end > wide) {
      end = rest.rfind(' ', wide);
      if (end == std::string_view::npos || end == 0) end = std::min(rest.find(' ', wide), rest.size());
    }
    out.append(indent, ' ').append("// ").append(rest.substr(0, end)).append("\n");
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
}

}  // namespace isoshade::emit
