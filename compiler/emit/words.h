// SPDX-License-Identifier: Apache-2.0
// The words that names in emitted text must not be. Each language has a table of its own
// (targets/*/words.def); own_words.def has what our texts say themselves. The texts of all languages have the same names, so
// a name avoids the words of all.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace isoshade::emit {

/// Where a name stands: a function or type; a parameter or variable of a function; a field of a struct.
enum class Scope : uint8_t { global = 1, local = 2, field = 4 };

/// Whose words a name avoids. Functions of our own are called by own words.
enum class Avoid : uint8_t { languages, all };

/// Whether a name, as Names cleans it, may not stand in `scope`. No word ends in '_'.
bool is_word(std::string_view name, Scope scope, Avoid avoid = Avoid::all);
/// The same where the name's hash of support::NameTable is known.
bool is_word(std::string_view name, uint32_t hash, Scope scope, Avoid avoid);

/// Every word that the tables list, and a few of each family: what tests try.
std::vector<std::string_view> all_words();

}  // namespace isoshade::emit
