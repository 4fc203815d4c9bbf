// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/words.h"

#include <algorithm>
#include <span>
#include <unordered_map>

namespace isoshade::emit {

namespace {

/// The scopes in which a word cannot be a name, as bits of Scope.
enum Where : uint8_t { global = 1, local = 2, field = 4, in_functions = global | local, anywhere = 7 };

/// What must follow a prefix.
enum class Rest : uint8_t {
  any,       ///< anything, or nothing
  capital,   ///< a capital or a digit, then anything
  capitals,  ///< capitals, digits and underscores alone
};

struct Words {
  Where where;
  std::string_view words;  ///< with spaces between them
};
struct Family {
  Where where;
  std::string_view prefix;
  Rest rest;
  std::string_view example;
};
struct Ending {
  Where where;
  std::string_view suffix;
  std::string_view example;
};

struct Table {
  std::span<const Words> words;
  std::span<const Family> families;
  std::span<const Ending> endings;
};

// Each table is read three times, for what the macro of each kind takes of it.
#define WORDS(where, words) {where, words},
#define FAMILY(where, prefix, rest, example)
#define ENDING(where, suffix, example)
constexpr Words glsl_words[] = {
#include "compiler/emit/glsl_words.def"
};
constexpr Words cpp_words[] = {
#include "compiler/emit/cpp_words.def"
};
constexpr Words own_words[] = {
#include "compiler/emit/own_words.def"
};
#undef WORDS
#undef FAMILY
#define WORDS(where, words)
#define FAMILY(where, prefix, rest, example) {where, prefix, Rest::rest, example},
constexpr Family glsl_families[] = {
#include "compiler/emit/glsl_words.def"
};
constexpr Family cpp_families[] = {
#include "compiler/emit/cpp_words.def"
};
constexpr Family own_families[] = {
#include "compiler/emit/own_words.def"
};
#undef FAMILY
#undef ENDING
#define FAMILY(where, prefix, rest, example)
#define ENDING(where, suffix, example) {where, suffix, example},
constexpr Ending glsl_endings[] = {
#include "compiler/emit/glsl_words.def"
};
constexpr Ending cpp_endings[] = {
#include "compiler/emit/cpp_words.def"
};
constexpr Ending own_endings[] = {
#include "compiler/emit/own_words.def"
};
#undef WORDS
#undef FAMILY
#undef ENDING

constexpr Table languages[] = {{glsl_words, glsl_families, glsl_endings},
                               {cpp_words, cpp_families, cpp_endings}};
constexpr Table own = {own_words, own_families, own_endings};

template <class Take>
void for_each_word(const Table& table, const Take& take) {
  for (const Words& row : table.words) {
    std::string_view rest = row.words;
    while (!rest.empty()) {
      const size_t end = std::min(rest.find(' '), rest.size());
      if (end > 0) take(rest.substr(0, end), row.where);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
}

/// By word, the scopes that languages forbid, and above them those that our own texts do.
const std::unordered_map<std::string_view, uint8_t>& listed() {
  static const auto all = [] {
    std::unordered_map<std::string_view, uint8_t> map;
    for (const Table& table : languages)
      for_each_word(table, [&](std::string_view word, Where where) { map[word] |= where; });
    for_each_word(own,
                  [&](std::string_view word, Where where) { map[word] |= static_cast<uint8_t>(where << 3); });
    return map;
  }();
  return all;
}

bool is_capital(char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

bool follows(std::string_view rest, Rest rule) {
  switch (rule) {
    case Rest::any: return true;
    case Rest::capital: return !rest.empty() && is_capital(rest.front());
    case Rest::capitals: break;
  }
  return !rest.empty() && std::ranges::all_of(rest, [](char c) { return is_capital(c) || c == '_'; });
}

bool is_of_family(std::string_view name, uint8_t scope, const Table& table) {
  if (name.empty()) return false;
  // Most names differ in their first or last letter already.
  for (const Family& family : table.families)
    if (family.prefix.front() == name.front() && (family.where & scope) != 0 && name.starts_with(family.prefix) &&
        follows(name.substr(family.prefix.size()), family.rest))
      return true;
  for (const Ending& ending : table.endings)
    if (ending.suffix.back() == name.back() && (ending.where & scope) != 0 && name.ends_with(ending.suffix))
      return true;
  return false;
}

}  // namespace

bool is_word(std::string_view name, Scope scope, Avoid avoid) {
  if (name.ends_with('_')) return false;
  const auto bit = static_cast<uint8_t>(scope);
  const bool avoids_own = avoid == Avoid::all;
  if (const auto found = listed().find(name); found != listed().end()) {
    if ((found->second & bit) != 0) return true;
    if (avoids_own && (found->second >> 3 & bit) != 0) return true;
  }
  for (const Table& table : languages)
    if (is_of_family(name, bit, table)) return true;
  return avoids_own && is_of_family(name, bit, own);
}

std::vector<std::string_view> all_words() {
  std::vector<std::string_view> words;
  for (const auto& [word, where] : listed()) words.push_back(word);
  for (const Table* table : {&languages[0], &languages[1], &own}) {
    for (const Family& family : table->families) words.push_back(family.example);
    for (const Ending& ending : table->endings) words.push_back(ending.example);
  }
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace isoshade::emit
