// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/words.h"

#include <algorithm>
#include <array>
#include <span>

#include "compiler/support/name_table.h"

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

/// A row of a table; `kind` says which of the three macros it was.
struct Row {
  enum class Kind : uint8_t { words, family, ending } kind;
  Where where;
  std::string_view text;  ///< words with spaces between them, a prefix or a suffix
  Rest rest = Rest::any;
  std::string_view example = {};  ///< of a family or an ending
};

#define WORDS(where, text) Row{Row::Kind::words, where, text},
#define FAMILY(where, text, rest, example) Row{Row::Kind::family, where, text, Rest::rest, example},
#define ENDING(where, text, example) Row{Row::Kind::ending, where, text, Rest::any, example},
constexpr Row own_rows[] = {
#include "compiler/emit/own_words.def"
};
constexpr Row language_rows[] = {
#include "compiler/targets/targets.def"
};

template <class Take>
void for_each_word(std::span<const Row> rows, const Take& take) {
  for (const Row& row : rows) {
    if (row.kind != Row::Kind::words) continue;
    std::string_view rest = row.text;
    while (!rest.empty()) {
      const size_t end = std::min(rest.find(' '), rest.size());
      if (end > 0) take(rest.substr(0, end), row.where);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
}

/// By word, the scopes that languages forbid, and above them those that our own texts do.
const support::NameTable& listed() {
  static const support::NameTable all = [] {
    support::NameTable table;
    for_each_word(language_rows,
                  [&](std::string_view word, Where where) { table.number(table.add(word).index) |= where; });
    for_each_word(own_rows,
                  [&](std::string_view word, Where where) { table.number(table.add(word).index) |= where << 3; });
    return table;
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

/// The families and endings of a table, by the first and by the last letter of the names that belong to them.
class Families {
 public:
  explicit Families(std::span<const Row> rows) {
    for (const Row& row : rows) {
      if (row.kind == Row::Kind::family) families_[letter(row.text.front())].push_back(row);
      if (row.kind == Row::Kind::ending) endings_[letter(row.text.back())].push_back(row);
    }
  }

  bool contain(std::string_view name, uint8_t scope) const {
    if (name.empty()) return false;
    const auto begins = [&](const Row& row) {
      return (row.where & scope) != 0 && name.starts_with(row.text) && follows(name.substr(row.text.size()), row.rest);
    };
    const auto ends = [&](const Row& row) { return (row.where & scope) != 0 && name.ends_with(row.text); };
    return std::ranges::any_of(families_[letter(name.front())], begins) ||
           std::ranges::any_of(endings_[letter(name.back())], ends);
  }

 private:
  static size_t letter(char c) { return static_cast<unsigned char>(c); }
  std::array<std::vector<Row>, 256> families_, endings_;
};

}  // namespace

bool is_word(std::string_view name, Scope scope, Avoid avoid) {
  return is_word(name, support::NameTable::hash(name), scope, avoid);
}

bool is_word(std::string_view name, uint32_t hash, Scope scope, Avoid avoid) {
  if (name.ends_with('_')) return false;
  const auto bit = static_cast<uint8_t>(scope);
  const bool avoids_own = avoid == Avoid::all;
  const support::NameTable& words = listed();
  if (const size_t found = words.find(name, hash); found != support::NameTable::npos) {
    if ((words.number(found) & bit) != 0) return true;
    if (avoids_own && (words.number(found) >> 3 & bit) != 0) return true;
  }
  static const Families of_languages(language_rows), our_own(own_rows);
  return of_languages.contain(name, bit) || (avoids_own && our_own.contain(name, bit));
}

std::vector<std::string_view> all_words() {
  std::vector<std::string_view> words;
  for (const std::span<const Row> rows : {std::span<const Row>(language_rows), std::span<const Row>(own_rows)}) {
    for_each_word(rows, [&](std::string_view word, Where) { words.push_back(word); });
    for (const Row& row : rows)
      if (row.kind != Row::Kind::words) words.push_back(row.example);
  }
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace isoshade::emit
